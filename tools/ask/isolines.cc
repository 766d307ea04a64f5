// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/ask/questions.h"

namespace ptin::ask {

namespace {

constexpr std::string_view kOfLevels = "Ascending, each once.";

}  // namespace

void add_question(Parameters& rows, IsolineQuestion& question) {
  IsolineRequest& request = question.request;
  add_levels(rows, question.levels, "Heights of the lines, instead of an interval",
             "Every multiple of D, from the base", Door::kBoth);
  add_region(rows, question.region, Door::kBoth);
  add_detail(
      rows, request.detail, "",
      "The isolines of the TIN of the terrain's N most important vertices, instead of an error");
  rows.add("max-lines", &request.most_lines, "N",
           "Refuse, before anything is written, when there are more lines, or polygons")
      .with_default()
      .at(Door::kProgram);
  add_crs(rows);
}

Fields<IsolineRow> isoline_row_fields() {
  const auto of_step = [](auto member) {
    return [member](const IsolineRow& r) { return r.step ? Json(r.step->*member) : kLeftOut; };
  };
  Fields<IsolineRow> fields;
  fields.add("ID", "integer", "", "From 0.", Told::kProgram, &IsolineRow::id);
  fields.add("elev", "number", kHeightUnit, "Level of the line.", &IsolineRow::elevation);
  fields.add("ring", "boolean", "", "The line is closed.", Told::kService, &IsolineRow::ring);
  fields.next = Told::kProgram;
  fields.add("step", "integer", "", "From 0.", of_step(&IsolineStep::step));
  // Splits may exceed 32 bits, and integers of a shapefile do not.
  fields.add("splits", "number", "", "By then.", of_step(&IsolineStep::splits));
  fields.add("error", "number", kHeightUnit, "Certified by then.",
             of_step(&IsolineStep::certified_error));
  return fields;
}

Fields<IsolineRow> band_row_fields() {
  Fields<IsolineRow> fields;
  fields.add("ID", "integer", "", "From 0.", &IsolineRow::id);
  fields.add("elev_min", "number", kHeightUnit, "Lower level of the band.", &IsolineRow::elevation);
  fields.add("elev_max", "number", kHeightUnit, "Upper level of the band.", &IsolineRow::upper);
  return fields;
}

Fields<IsolineAnswer> isoline_fields() {
  Fields<TraceCounts> crossed;
  crossed.add("triangles", "integer", "", "Crossed by one level at least.",
              &TraceCounts::triangles);
  crossed.add("vertices", "integer", "", "Corners of those triangles.", &TraceCounts::vertices);
  crossed.add("segments", "integer", "", "One a triangle and level.", &TraceCounts::segments);
  Fields<IsolineAnswer> fields;
  fields.add("levels", "array of numbers", kHeightUnit, kOfLevels,
             [](const IsolineAnswer& a) { return a.isolines->levels(); });
  fields.add("lines", "integer", "", "Written.", &IsolineAnswer::lines);
  fields.add("rings", "integer", "", "Closed ones among these.", &IsolineAnswer::rings);
  fields.add("points", "integer", "", "Points of all lines.", &IsolineAnswer::points);
  fields.add_object("crossed", "object", "What the levels cross.", crossed,
                    [](const IsolineAnswer& a) { return &a.isolines->crossed; });
  fields.add("tiles", "integer", "", "In which the terrain was processed.",
             [](const IsolineAnswer& a) { return a.isolines->tiles; });
  return fields;
}

Fields<BandAnswer> band_fields() {
  Fields<BandAnswer> fields;
  fields.add("levels", "array of numbers", kHeightUnit, kOfLevels, &BandAnswer::levels);
  fields.add("features", "integer", "", "Bands that have an area, one feature each.",
             &BandAnswer::features);
  fields.add("polygons", "integer", "", "Polygons of all bands.", &BandAnswer::polygons);
  return fields;
}

}  // namespace ptin::ask
