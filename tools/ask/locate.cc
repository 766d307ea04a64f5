// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/ask/questions.h"
#include "tools/facts/answers.h"

namespace ptin::ask {

namespace {

Json triangle_json(const LocatedRow& row) {
  if (row.point.state == PointState::kOutside) return nullptr;
  Json triangle = Json::array();
  for (std::size_t c = 0; c < row.corners.size(); ++c) {
    triangle.push_back({row.corners[c].x, row.corners[c].y, row.point.triangle[c].height});
  }
  return triangle;
}

}  // namespace

void add_question(Parameters& rows, LocateRequest& request) {
  add_coords(rows, "Positions as WKT, POINT or MULTIPOINT", "POINT(-118.3 34.34)");
  add_detail(rows, request.detail, "; heights come with intervals",
             "The TIN of the terrain's N most important vertices, instead of an error; heights "
             "come with intervals");
  add_crs(rows);
}

LocatedRow::LocatedRow(const MapPoint& position, const LocatedPoint& located, const AffineMap& map)
    : at(position), point(located) {
  for (std::size_t c = 0; c < corners.size(); ++c) {
    const GridPoint corner = located.triangle[c].position;
    corners[c] = map.to_map(corner.x, corner.y);
  }
}

Fields<LocatedRow> located_fields() {
  using Row = LocatedRow;
  Fields<Row> fields;
  fields.add("x", "number", kMapUnit, "As asked.", Told::kNoFeature,
             [](const Row& r) { return r.at.x; });
  fields.add("y", "number", kMapUnit, "As asked.", Told::kNoFeature,
             [](const Row& r) { return r.at.y; });
  fields.add("state", "string", "", "What is there.",
             [](const Row& r) { return tools::name_of(r.point.state); });
  fields.add("height", "number or null", kHeightUnit,
             "Height of the TIN that was asked; null where it has no surface.",
             [](const Row& r) { return r.point.height; });
  fields.add("height_min", "number or null", kHeightUnit,
             "The exact height is no lower, if the exact TIN is surface there.",
             [](const Row& r) { return r.point.height_min; });
  fields.add("height_max", "number or null", kHeightUnit,
             "The exact height is no higher, if the exact TIN is surface there.",
             [](const Row& r) { return r.point.height_max; });
  fields.add("id", "string", "",
             "Its column or attribute (`--id`); left out where the input has none.", Told::kProgram,
             &Row::id);
  fields.add(
      "triangle", "array or null", "",
      "Its corners, counter-clockwise from the southernmost, as `[x, y, height]`; no height: null.",
      Told::kObject, triangle_json);
  return fields;
}

}  // namespace ptin::ask
