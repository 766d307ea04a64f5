// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/ask/volume.h"

namespace ptin::ask {

namespace {

void add_volume_of(Fields<VolumeResult>& fields, const std::string& name, std::string_view meaning,
                   CertifiedVolume VolumeResult::*volume) {
  Fields<CertifiedVolume> parts;
  parts.add("volume", "number", "", "Of the TIN that was asked.", &CertifiedVolume::value,
            As::kObject);
  parts.add("low", "number", "", "The source's is no less.", &CertifiedVolume::low);
  parts.add("high", "number", "", "The source's is no more.", &CertifiedVolume::high);
  fields.add(
      name, "number", "", meaning, [volume](const VolumeResult& r) { return (r.*volume).value; },
      As::kTableRow);
  fields.add_object(name, "object", meaning, parts, volume);
}

void add_area(Fields<VolumeResult>& fields, const std::string& name, std::string_view meaning,
              double VolumeResult::*area, Told told = {}) {
  fields.add("area." + name, "number", "", meaning, area, told).facts.heading = name + "_area";
}

Fields<VolumeResult> result_fields() {
  Fields<VolumeResult> fields;
  add_volume_of(fields, "cut", "What lies above the level, or above the other terrain.",
                &VolumeResult::cut);
  add_volume_of(fields, "fill", "What is missing below.", &VolumeResult::fill);
  add_volume_of(fields, "net", "Cut less fill.", &VolumeResult::net);
  fields.add("rounding", "number", "",
             "How far rounding can have changed cut, fill or net; it is in the bounds.",
             &VolumeResult::rounding, As::kObject);
  fields.add("mean_difference", "number or null", kHeightUnit, "Net volume by surface area.",
             &VolumeResult::mean_difference, As::kObject);
  fields.add(
      "area", "object", "", "Areas of the plane.",
      [](const VolumeResult&) { return Json(Json::object()); }, As::kObject);
  add_area(fields, "surface",
           "Where the difference is known: FILE is surface, and so is the other.",
           &VolumeResult::surface_area);
  add_area(fields, "cut", "Where it is above 0.", &VolumeResult::cut_area);
  add_area(fields, "fill", "Where it is below 0.", &VolumeResult::fill_area);
  add_area(fields, "void",
           "Within the hull of FILE (and of the other), and void there (in either).",
           &VolumeResult::void_area);
  add_area(fields, "only_file",
           "Where FILE is surface and the other is void or has ended; 0 without another.",
           &VolumeResult::only_here_area, As::kObject);
  add_area(fields, "only_against", "The other way round.", &VolumeResult::only_other_area,
           As::kObject);
  return fields;
}

Fields<VolumeAnswer::Against> against_fields() {
  using Row = VolumeAnswer::Against;
  constexpr std::string_view kOfFile = "height's unit of that file";
  Fields<Row> fields;
  fields.add("file", "string", "", "As asked.", &Row::file);
  fields.add("certified_error", "number or null", kOfFile, "As below, of the other TIN.",
             &Row::certified_error);
  fields.add("certified_deviation", "number or null", kOfFile, "As below, of the other TIN.",
             &Row::certified_deviation);
  fields.add("border_moved_at_most", "number or null", "ground units",
             "As below, of the other TIN.", &Row::border_moved_at_most);
  return fields;
}

}  // namespace

void add_volume(Parameters& rows, VolumeQuestion& question) {
  add_levels(rows, question.levels, "Heights; of several the answer is a table",
             "Every multiple of D, from the base", Door::kProgram);
  rows.add("against", &question.against, "OTHER",
           "A second .ptin file, on any grid, in the same CRS; cut is where FILE is above it")
      .excluding("level interval");
  add_region(rows, question.region, RegionKinds::kWithInside, Door::kProgram);
  add_detail(rows, question.detail, ", of either file; volumes come with intervals",
             "Measure the TINs of the N most important vertices; volumes come with intervals");
}

Fields<VolumeRow> volume_row_fields() {
  Fields<VolumeRow> fields;
  fields.add("level", "number or null", kHeightUnit,
             "As asked; null against another terrain. Of several levels this and the next ones, "
             "down to `area`, stand in `levels`.",
             [](const VolumeRow& r) { return r.level ? Json(*r.level) : Json(); });
  fields.add_parts("", result_fields(), &VolumeRow::result);
  return fields;
}

Fields<VolumeAnswer> volume_fields() {
  using Row = VolumeAnswer;
  Fields<Row> fields;
  fields.add_parts("", volume_row_fields().told(Door::kProgram, As::kObject),
                   [](const Row& a) { return a.rows.size() == 1 ? &a.rows[0] : nullptr; });
  fields.add_array("levels", "Of several levels: one each, in the order of the question.",
                   volume_row_fields().told(Door::kProgram, As::kObject),
                   [](const Row& a) { return a.rows.size() == 1 ? nullptr : &a.rows; });
  fields.add_object("against", "object or null", "The other terrain.", against_fields(),
                    &Row::against);
  fields.add("units.ground", "string", "",
             "The unit whose squares and cubes areas and volumes are.", &Row::ground_unit);
  return fields;
}

}  // namespace ptin::ask
