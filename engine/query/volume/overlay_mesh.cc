// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/query/volume/overlay_mesh.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "engine/geometry/hilbert.h"
#include "engine/query/volume/grid_box.h"

namespace ptin {

namespace {

/// Along the Hilbert curve by the middle of the box.
std::uint64_t position_along(const GridBox& box) noexcept {
  const auto middle = [](std::int32_t low, std::int32_t high) {
    return static_cast<std::uint32_t>(
        std::clamp<std::int64_t>((std::int64_t{low} + high) / 2, 0, kGridMax));
  };
  return hilbert_position(middle(box.min_x, box.max_x), middle(box.min_y, box.max_y));
}

}  // namespace

GridToGrid::GridToGrid(const AffineMap& from, const AffineMap& to)
    : origin_{(from.origin_x - to.origin_x) / to.step_x, (from.origin_y - to.origin_y) / to.step_y},
      step_{from.step_x / to.step_x, from.step_y / to.step_y} {}

GridBox GridToGrid::box_around(const GridBox& box, const GridBox& bounds) const noexcept {
  const MapPoint corners[] = {at(box.min_x, box.min_y), at(box.max_x, box.max_y)};
  const GridBox around = ptin::box_around(corners);
  return {std::max(around.min_x, bounds.min_x), std::max(around.min_y, bounds.min_y),
          std::min(around.max_x, bounds.max_x), std::min(around.max_y, bounds.max_y)};
}

double GridToGrid::rounding(const GridBox& box) const noexcept {
  if (origin_ == MapPoint{0, 0} && step_ == MapPoint{1, 1}) return 0.0;
  const MapPoint low = at(box.min_x, box.min_y), high = at(box.max_x, box.max_y);
  const double farthest = std::max({std::abs(origin_.x), std::abs(origin_.y), std::abs(low.x),
                                    std::abs(low.y), std::abs(high.x), std::abs(high.y)});
  return 8 * std::numeric_limits<double>::epsilon() * farthest;
}

void OverlayMesh::take(const Tin& tin, const GridBox& near) {
  positions_.clear();
  for (const Vertex& v : tin.vertices) positions_.push_back(map_.at(v.position.x, v.position.y));
  std::vector<std::pair<std::uint64_t, TriangleId>> along;
  const auto box_of_triangle = [&](TriangleId t) {
    const Triangle& triangle = tin.triangles[t];
    const MapPoint corners[] = {positions_[triangle.v[0]], positions_[triangle.v[1]],
                                positions_[triangle.v[2]]};
    return box_around(corners);
  };
  for (TriangleId t = 0; t < tin.triangles.size(); ++t) {
    const GridBox box = box_of_triangle(t);
    if (meets(box, near)) along.emplace_back(position_along(box), t);
  }
  std::sort(along.begin(), along.end());
  triangles_.clear();
  std::vector<GridBox> boxes;
  boxes.reserve(along.size());
  for (const auto& [place, t] : along) {
    triangles_.push_back(t);
    boxes.push_back(box_of_triangle(t));
  }
  boxes_ = PackedBoxes(std::move(boxes));
}

}  // namespace ptin
