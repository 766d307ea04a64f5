// SPDX-License-Identifier: GPL-3.0-or-later
#include <cstdint>
#include <limits>

#include "tools/ask/questions.h"
#include "tools/facts/answers.h"

namespace ptin::ask {

namespace {

Fields<HeightAt> vertex_fields() {
  Fields<HeightAt> fields;
  fields.add("x", "number", kMapUnit, "Place of the vertex, or the point.",
             [](const HeightAt& v) { return v.position.x; });
  fields.add("y", "number", kMapUnit, "Place of the vertex, or the point.",
             [](const HeightAt& v) { return v.position.y; });
  fields.add("height", "number", kHeightUnit, "Height of the vertex, or the point.",
             &HeightAt::height);
  return fields;
}

/// What is told of the point beside its place.
Fields<HighestResult> point_fields() {
  Fields<HighestResult> fields;
  fields.add("height_min", "number or null", kHeightUnit, "The source's highest is no lower.",
             &HighestResult::height_min);
  fields.add("height_max", "number or null", kHeightUnit, "The source's highest is no higher.",
             &HighestResult::height_max);
  return fields;
}

}  // namespace

void add_question(Parameters& rows, HighestQuestion& question) {
  HighestRequest& request = question.request;
  add_region(rows, question.region, Door::kBoth);
  rows.add("lowest", &request.lowest, "", "The lowest point instead").like("true");
  rows.add("listed", &request.listed, "K", "How many of the highest vertices to list")
      .spelled("-k")
      .within({.least = 1, .most = 1e6})
      // The service has a limit of its own.
      .within_over_http({.least = 1, .most = std::numeric_limits<std::uint32_t>::max()})
      .with_default()
      .like("10");
  add_detail(rows, request.detail, "; the height comes with an interval",
             "The highest of the TIN of the terrain's N most important vertices, instead of an "
             "error; its height comes with an interval");
  add_crs(rows);
}

Fields<HighestResult> highest_fields(bool lowest) {
  using Row = HighestResult;
  Fields<Row> point;
  point.add_parts("", vertex_fields(), &Row::point);
  point.add_parts("", point_fields(), [](const Row& r) { return &r; });
  point.add("at_vertex", "boolean", "", "False: on the region's border.", &Row::at_vertex);
  Fields<Row> fields;
  fields.add("state", "string", "",
             "Unless it is `surface` there is no point: the region lies outside of the hull, or "
             "holds nothing but voids.",
             [](const Row& r) { return tools::name_of(r.state); });
  fields.next = Told::kProgram;
  fields.add("lowest", "boolean", "",
             "The lowest point was asked for; \"highest\" below then means that.",
             [lowest](const Row&) { return lowest; });
  fields.add_object(
      "point", "object or null",
      "The highest point of the surface in the region: one of several, where there are several.",
      point, [](const Row& r) { return r.state == PointState::kSurface ? &r : nullptr; });
  fields.add_array("vertices",
                   "The highest vertices in the region that touch the surface, falling, equal ones "
                   "from south to north and west to east; at most as many as `-k` says.",
                   vertex_fields(), &Row::vertices);
  return fields;
}

Fields<HighestPlace> highest_place_fields() {
  Fields<HighestPlace> fields;
  fields.add("rank", "integer", "", "1: the point; then the vertices.", &HighestPlace::rank);
  fields.add("at_vertex", "boolean", "", "False: on the region's border.",
             &HighestPlace::at_vertex);
  fields.add_parts("", point_fields(), &HighestPlace::result);
  fields.add("height", "number", kHeightUnit, "Height of the place.",
             [](const HighestPlace& p) { return p.at.height; });
  return fields;
}

std::vector<HighestPlace> places_of(const HighestResult& result) {
  std::vector<HighestPlace> places;
  if (result.state != PointState::kSurface) return places;
  places.push_back({result.point, 1, result.at_vertex, &result});
  for (std::size_t i = result.at_vertex ? 1 : 0; i < result.vertices.size(); ++i) {
    places.push_back({result.vertices[i], places.size() + 1});
  }
  return places;
}

}  // namespace ptin::ask
