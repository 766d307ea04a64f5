// SPDX-License-Identifier: GPL-3.0-or-later
//
// Squares of samples with a plane and a bound beside it: one look at a square shows whether a
// sample in it can be farther from a triangle than what is known.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "engine/construct/measure/fan_measure.h"
#include "engine/construct/tile/tile.h"
#include "engine/geometry/box.h"

namespace ptin {

/// The samples of a leaf over a raster without voids, and a pyramid of planes over its squares.
/// Memory: about 11 bytes a sample.
class PlaneBlocks {
 public:
  /// @param box  REQUIRES: its samples fill leaf.tin.vertices row by row, and all have heights.
  /// Cost: linear; each sample is looked at eight times.
  PlaneBlocks(const Tile& leaf, const GridBox& box);

  /// The centre of a star.
  struct Centre {
    GridPoint position;
    double code;
    bool closed;  ///< As Star::closed.
  };
  /// The largest residual of the samples in a fan, in height codes, where it is more than `known`;
  /// else `known`. Samples on edges that were there before the collapse, which are those of the
  /// link, do not count: a triangle of the star carries the record that made the edge, so
  /// saturation covers them, as it does gaps.
  /// REQUIRES: the star is narrow (StarSamples::is_wide()). Rounding: see residual_bound().
  /// Cost: a few squares for each triangle, and the samples of those that `known` does not bound.
  [[nodiscard]] double largest_residual(const FanFrame& fan, const Centre& u, double known) const;

  /// At least the difference of the codes of u and of any sample of the leaf.
  [[nodiscard]] double largest_z(const Centre& u) const noexcept;

 private:
  /// A square of 2^log by 2^log samples, by the column and row of its south-western one: multiples
  /// of its side. It may reach beyond the leaf.
  struct Block {
    std::int32_t x, y, log;
    [[nodiscard]] std::int32_t side() const noexcept { return std::int32_t{1} << log; }
  };
  /// The plane of a block, by the code in its middle; no sample is farther from it than `reach`.
  struct Node {
    float slope_x, slope_y;
    double code, reach;
  };
  /// A function of the position that is linear, by its value at column 0, row 0.
  struct Linear {
    double at, x, y;
    [[nodiscard]] double operator()(double column, double row) const noexcept {
      return at + (x * column + y * row);
    }
  };
  struct Side;
  /// Smaller blocks have no node; larger ones are not asked for.
  static constexpr std::int32_t kLowestLog = 2, kHighestLog = 7;

  [[nodiscard]] const double* row(std::int32_t x, std::int32_t y) const noexcept {
    return &codes_[static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) +
                   static_cast<std::size_t>(x)];
  }
  [[nodiscard]] Node make_node(const Block& block) const;
  [[nodiscard]] Side side_of(const FanFrame& fan, std::size_t i, const Centre& u) const noexcept;
  [[nodiscard]] bool is_bounded(const Side& side, const Block& block, double worst) const noexcept;
  void raise(const Side& side, const Block& block, double& worst) const;
  void raise_by_samples(const Side& side, const Block& block, double& worst) const noexcept;

  GridPoint origin_;
  std::int32_t width_, height_;
  std::vector<double> codes_;
  double least_, greatest_;
  std::array<std::vector<Node>, kHighestLog + 1> nodes_;  ///< By log; row by row.
};

}  // namespace ptin
