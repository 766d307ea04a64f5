// SPDX-License-Identifier: GPL-3.0-or-later
//
// The border between surface and void as a set of lines, and distances to it; for verification.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "engine/crs/ground.h"
#include "engine/geometry/affine.h"
#include "engine/mesh/tin.h"
#include "tools/verify/source_samples.h"

namespace ptin::tools {

/// The lengths of a grid step on the ground: in metres, at one row, where the CRS is in angles;
/// else in map units.
struct GroundSteps {
  double x = 1.0;
  double y = 1.0;
};
[[nodiscard]] GroundSteps ground_steps(const AffineMap& map, const Ground& ground, double grid_y);

/// A piece of the border, from grid point to grid point.
using BorderLine = std::array<GridPoint, 2>;

/// The border that the mask of a raster's window defines. A cell with four heights is surface, one
/// with three is half of each, cut beside the corner without a height, any other one is void. Sides
/// of the window are no border.
/// REQUIRES: window.is_grid; lone samples are void (drop_lone_samples()).
[[nodiscard]] std::vector<BorderLine> border_of_mask(const SampleWindow& window);
/// The sides that a surface and a void triangle share.
[[nodiscard]] std::vector<BorderLine> border_of_tin(const Tin& tin);

/// Lines in buckets of a square grid.
class BorderLines {
 public:
  /// @param steps  Distances are measured with these on the ground.
  BorderLines(std::vector<BorderLine> lines, const GroundSteps& steps);
  [[nodiscard]] const std::vector<BorderLine>& lines() const noexcept { return lines_; }
  /// The distance on the ground from a point in grid steps to the nearest line; +infinity when there
  /// is none within `limit`. Cost: the buckets within that distance.
  [[nodiscard]] double distance(double x, double y, double limit) const;

 private:
  [[nodiscard]] double distance_to(const BorderLine& line, double x, double y) const;
  std::vector<BorderLine> lines_;
  GroundSteps steps_;
  double low_x_ = 0.0, low_y_ = 0.0, side_ = 1.0;
  std::int64_t columns_ = 0, rows_ = 0;
  std::vector<std::vector<std::uint32_t>> buckets_;
};

/// Makes samples void that have a height but touch no surface triangle: none of the cells around
/// them has three corners with heights. Samples on the border of `window` are judged by the cells
/// inside of it.
void drop_lone_samples(SampleWindow& window);

}  // namespace ptin::tools
