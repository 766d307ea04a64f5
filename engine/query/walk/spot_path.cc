// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/query/walk/spot_path.h"

#include <algorithm>
#include <array>
#include <bit>
#include <limits>
#include <utility>

#include "engine/check.h"

namespace ptin {

SpotPath::SpotPath(std::vector<SpotSegment> given) : segments_(std::move(given)) {
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

bool SpotPath::meets(const GridBox& box) const noexcept {
  return descend(
      box, [](const SpotBox&) { return true; }, [](std::size_t) { return true; });
}

GridBox SpotPath::bounds() const noexcept {
  const auto grid = [](std::int64_t v) {  // spots reach farther than the grid
    return static_cast<std::int32_t>(
        std::clamp<std::int64_t>(v >> kSpotBits, -1, std::int64_t{kGridMax} + 1));
  };
  const SpotBox& all = around_.front();
  return {grid(all.min_x), grid(all.min_y), grid(all.max_x + (std::int64_t{1} << kSpotBits) - 1),
          grid(all.max_y + (std::int64_t{1} << kSpotBits) - 1)};
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
