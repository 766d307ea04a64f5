// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/ask/locate.h"

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

void add_locate(Parameters& rows, LocateRequest& request) {
  add_detail(
      rows, request.detail, "; heights come with intervals",
      "The TIN of the terrain's N most important vertices, instead of an error; heights come "
      "with intervals");
}

LocatedRow::LocatedRow(const MapPoint& position, const LocatedPoint& located, const AffineMap& map)
    : at(position), point(located) {
  for (std::size_t c = 0; c < corners.size(); ++c) {
    const GridPoint corner = located.triangle[c].position;
    corners[c] = map.to_map(corner.x, corner.y);
  }
}

const Fields<LocatedRow>& located_fields() {
  static const Fields<LocatedRow> fields = {
      {{"x", "number", "map unit", "As asked.", Door::kBoth, As::kNoFeature},
       [](const LocatedRow& r) -> Json { return r.at.x; }},
      {{"y", "number", "map unit", "As asked.", Door::kBoth, As::kNoFeature},
       [](const LocatedRow& r) -> Json { return r.at.y; }},
      {{"state", "string", "", "What is there."},
       [](const LocatedRow& r) -> Json { return tools::name_of(r.point.state); }},
      {{"height", "number or null", "height's unit",
        "Of the TIN that was asked; null where it has no surface."},
       [](const LocatedRow& r) -> Json { return r.point.height; }},
      {{"height_min", "number or null", "height's unit",
        "The exact height is no lower, if the exact TIN is surface there."},
       [](const LocatedRow& r) -> Json { return r.point.height_min; }},
      {{"height_max", "number or null", "height's unit",
        "The exact height is no higher, if the exact TIN is surface there."},
       [](const LocatedRow& r) -> Json { return r.point.height_max; }},
      {{"id", "string", "", "Its column or attribute (`--id`); left out where the input has none.",
        Door::kProgram},
       [](const LocatedRow& r) -> Json { return r.id == nullptr ? kLeftOut : Json(*r.id); }},
      {{"triangle", "array or null", "",
        "Its corners, counter-clockwise from the southernmost, as `[x, y, height]`; no height: "
        "null.",
        Door::kBoth, As::kObject},
       triangle_json}};
  return fields;
}

}  // namespace ptin::ask
