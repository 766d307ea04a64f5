// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/ask/questions.h"

namespace ptin::ask {

void add_question(Parameters& rows, ViewshedQuestion& question) {
  add_coords(rows, "The observer's position as WKT, POINT", "POINT(-118.3 34.34)");
  ViewshedRequest& request = question.request;
  rows.add("x", &question.x, "", "The observer's position")
      .spelled("X")
      .in(Unit::kMap)
      .required_at(Door::kBoth)
      .at(Door::kProgram);
  rows.add("y", &question.y, "", "The observer's position")
      .spelled("Y")
      .in(Unit::kMap)
      .required_at(Door::kBoth)
      .at(Door::kProgram);
  rows.add("height", &request.eye_height, "", "The observer's height above the surface")
      .spelled("H")
      .in(Unit::kHeight)
      .required_at(Door::kProgram)
      .like("2");
  rows.add("radius", &question.radius, "R", "How far to look")
      .in(Unit::kGround)
      .within(NumberRange::kPositive)
      .required_at(Door::kBoth)
      .at(Door::kProgram);
  rows.add("radius", &question.radius, "", "How far to look, over ground")
      .in(Unit::kHeight)
      .within(NumberRange::kPositive)
      .required_at(Door::kBoth)
      .at(Door::kService)
      .like("5000");
  rows.add("absolute", &request.absolute, "",
           "The observer's height is one of itself, not above the surface")
      .like("false");
  rows.add("target", &request.target_height, "T",
           "Height of targets above the surface; 0 without it")
      .spelled("--target-height")
      .in(Unit::kHeight)
      .like("0");
  add_curvature(rows, request.curvature.coefficient);
  add_detail(rows, request.detail,
             " at the radius, less towards the observer; where the full TIN may answer otherwise, "
             "a target is undecided (192 seems visible, 64 hidden; `certain` is 0)",
             "The TIN of the terrain's N most important vertices, and more towards the observer, "
             "instead of an error; undecided targets as with an error");
  add_crs(rows);
}

void set_ground(ViewshedRequest& request, const Ground& ground) {
  const MapPoint per_unit = ground.per_map_unit(request.eye);
  request.ground_per_map_x = per_unit.x;
  request.ground_per_map_y = per_unit.y;
  request.curvature.earth_diameter = ground.earth_diameter;
}

Fields<Viewshed> viewshed_fields() {
  using Row = Viewshed;
  using Count = std::uint64_t Row::*;
  const auto counts_of = [](Count visible, Count hidden, Count undecided) {
    Fields<Row> counts;
    counts.add("visible", "integer", "", "For certain.", visible);
    counts.add("hidden", "integer", "", "For certain.", hidden);
    counts.add("undecided", "integer", "", "At a level of detail.", undecided);
    return counts;
  };
  const Fields<Row> pixels =
      counts_of(&Row::visible_pixels, &Row::hidden_pixels, &Row::undecided_pixels);
  const Fields<Row> vertices =
      counts_of(&Row::visible_vertices, &Row::hidden_vertices, &Row::undecided_vertices);
  Fields<Row> fields;
  fields.next = Told::kService;
  fields.add_parts("", vertices, [](const Row& r) { return &r; });
  fields.next = Told::kAll;
  fields.add("eye_height", "number", kHeightUnit, "Height of the observer's eye, absolute.",
             &Row::eye_height);
  fields.next = Told::kProgram;
  constexpr std::string_view kOfRaster = "Size of the raster; 0 where the output is a layer.";
  fields.add("width", "integer", "pixels", kOfRaster, &Row::width);
  fields.add("height", "integer", "pixels", kOfRaster, &Row::height);
  fields.add_object("pixels", "object or null",
                    "Pixels that are targets; null where the output is a layer.", pixels,
                    [](const Row& r) { return r.width > 0 ? &r : nullptr; });
  fields.add_object("vertices", "object or null",
                    "Vertices that are targets; null where the output is a raster.", vertices,
                    [](const Row& r) { return r.width > 0 ? nullptr : &r; });
  return fields;
}

Fields<Viewshed::Target> target_fields() {
  using Row = Viewshed::Target;
  constexpr std::string_view kCertain = "The full TIN of the source says the same.";
  Fields<Row> fields;
  fields.add("height", "number", kHeightUnit, "Height of the vertex.", &Row::height);
  fields.add("visible", "flag", "", "1: it is.", Told::kProgram, &Row::visible);
  fields.add("certain", "flag", "", kCertain, Told::kProgram, &Row::certain);
  fields.add("visible", "boolean", "", "It is.", Told::kService, &Row::visible);
  fields.add("certain", "boolean", "", kCertain, Told::kService, &Row::certain);
  return fields;
}

}  // namespace ptin::ask
