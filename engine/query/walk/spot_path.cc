// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/query/walk/spot_path.h"

#include <algorithm>
#include <array>
#include <bit>
#include <limits>
#include <utility>

#include "engine/check.h"

namespace ptin {

namespace {

std::vector<SpotSegment> segments_of(std::span<const Spot> spots) {
  std::vector<SpotSegment> segments;
  for (std::size_t i = 1; i < spots.size(); ++i) {
    segments.push_back({spots[i - 1], spots[i]});
  }
  return segments;
}

}  // namespace

SpotPath::SpotPath(std::span<const Spot> spots, double tolerance)
    : SpotPath(segments_of(spots), tolerance) {}

SpotPath::SpotPath(std::vector<SpotSegment> given, double tolerance)
    : tolerance_(tolerance), segments_(std::move(given)) {
  PTIN_CHECK(!segments_.empty());
  const std::size_t segments = segments_.size();
  const std::size_t leaves = std::bit_ceil(segments);
  first_leaf_ = leaves - 1;
  constexpr std::int64_t kLeast = std::numeric_limits<std::int64_t>::min();
  constexpr std::int64_t kMost = std::numeric_limits<std::int64_t>::max();
  around_.assign(first_leaf_ + segments, {kMost, kMost, kLeast, kLeast});
  for (std::size_t i = 0; i < segments; ++i) {
    const auto& [a, b] = segments_[i];
    around_[first_leaf_ + i] = {std::min(a.x, b.x), std::min(a.y, b.y), std::max(a.x, b.x),
                                std::max(a.y, b.y)};
  }
  for (std::size_t i = around_.size(); i-- > 1;) {
    const SpotBox& child = around_[i];
    SpotBox& parent = around_[(i - 1) / 2];
    parent = {std::min(parent.min_x, child.min_x), std::min(parent.min_y, child.min_y),
              std::max(parent.max_x, child.max_x), std::max(parent.max_y, child.max_y)};
  }
}

bool SpotPath::meets(const GridBox& grid) const noexcept {
  const Spot low = spot_of(GridPoint{grid.min_x, grid.min_y});
  const Spot high = spot_of(GridPoint{grid.max_x, grid.max_y});
  const SpotBox box{low.x, low.y, high.x, high.y};
  std::array<std::size_t, 128> waiting;  // At most two nodes of a level wait.
  std::size_t count = 0;
  waiting[count++] = 0;
  while (count != 0) {
    const std::size_t i = waiting[--count];
    const SpotBox& b = around_[i];
    if (b.max_x < box.min_x || box.max_x < b.min_x || b.max_y < box.min_y || box.max_y < b.min_y) {
      continue;  // ends here for a node without segments too: its box is inverted
    }
    if (box.min_x <= b.min_x && b.max_x <= box.max_x && box.min_y <= b.min_y &&
        b.max_y <= box.max_y) {
      return true;
    }
    if (i >= first_leaf_) {
      if (segment_meets(i - first_leaf_, box, grid)) return true;
      continue;
    }
    for (const std::size_t child : {2 * i + 2, 2 * i + 1}) {
      if (child < around_.size()) waiting[count++] = child;
    }
  }
  return false;
}

/// Whether a segment meets the box, which is given in spot units and in grid units. REQUIRES: the
/// box meets the bounding box of the segment. Then box and segment share a point unless the corners
/// of the box all lie strictly on one side of the line.
bool SpotPath::segment_meets(std::size_t segment, const SpotBox& box,
                             const GridBox& grid) const noexcept {
  const auto& [p, q] = segments_[segment];
  if (box.min_x <= p.x && p.x <= box.max_x && box.min_y <= p.y && p.y <= box.max_y) return true;
  return line_meets(p, q, grid);
}

}  // namespace ptin
