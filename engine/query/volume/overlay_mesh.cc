// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/query/volume/overlay_mesh.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "engine/query/shape/grid_cell.h"
#include "engine/query/volume/grid_box.h"

namespace ptin {

namespace {

/// Bytes of a triangle while the array of them grows, or while they are put in order.
constexpr std::uint64_t kBytesATriangle = 2 * sizeof(LivingTriangle) + 72;

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

std::array<MapPoint, 3> OverlayMesh::corners(const LivingTriangle& t) const noexcept {
  const auto at = [&](std::size_t i) {
    return map_.at(t.corner[i].position.x, t.corner[i].position.y);
  };
  return {at(0), at(1), at(2)};
}

bool OverlayMesh::gather(const LivingPlace& place, const GridBox& near, std::uint64_t most_bytes,
                         QueryContext& context) {
  near_ = near;
  most_bytes_ = most_bytes;
  triangles_.clear();
  if (!reader_.read(place, context, *this)) return false;
  std::vector<std::pair<std::uint64_t, std::uint32_t>> along;
  along.reserve(triangles_.size());
  for (const LivingTriangle& t : triangles_) {
    along.emplace_back(position_along(box_around(corners(t))),
                       static_cast<std::uint32_t>(along.size()));
  }
  std::sort(along.begin(), along.end());
  order_.clear();
  std::vector<GridBox> boxes;
  boxes.reserve(along.size());
  for (const auto& [position, i] : along) {
    order_.push_back(i);
    boxes.push_back(box_around(corners(triangles_[i])));
  }
  boxes_ = PackedBoxes(std::move(boxes));
  return true;
}

bool OverlayMesh::expect(std::uint64_t records) {
  bytes_wanted_ = 2 * records * kBytesATriangle;  // a full TIN has two triangles a record
  return bytes_wanted_ <= most_bytes_;
}

bool OverlayMesh::begin(std::size_t most_triangles) {
  bytes_wanted_ = (triangles_.size() + most_triangles) * kBytesATriangle;
  return bytes_wanted_ <= most_bytes_;
}

void OverlayMesh::take(const LivingTriangle& t) {
  if (meets(box_around(corners(t)), near_)) triangles_.push_back(begun_with_least(t));
}

}  // namespace ptin
