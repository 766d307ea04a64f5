// SPDX-License-Identifier: GPL-3.0-or-later
//
// The full surface of a raster window, from its samples alone.
#pragma once

#include <memory>
#include <utility>
#include <vector>

#include "engine/construct/tile/full_surface.h"
#include "engine/construct/tile/part_surface.h"
#include "engine/mesh/raster_tin.h"

namespace ptin {

/// The full surface over a window. Edges that are asked about may lead out of the window; only
/// their crossings inside of it count.
class RasterSurface final : public FullSurface {
 public:
  /// Keeps the samples, which are laid out as those of make_raster_tin().
  RasterSurface(std::vector<HeightBits> heights, std::vector<std::uint8_t> valid,
                const SampleRange& window, const HeightEncoding& encoding);

  [[nodiscard]] double largest_gap(const EdgeEnd& a, const EdgeEnd& b) const override;
  /// Without set_border(): infinite where the edge leads through the window of a raster with voids,
  /// which then has no border in reach; 0 in a raster without voids.
  [[nodiscard]] double border_move(GridPoint a, GridPoint b) const override;
  /// Says that the raster has voids, but the window no border in reach.
  void set_far_from_border() noexcept { far_from_border_ = true; }
  /// Gives the surface the triangles of the window, where surface and void meet in it.
  void set_border(std::unique_ptr<const PartSurface> border) { border_ = std::move(border); }

 private:
  struct Line;
  [[nodiscard]] std::size_t at(std::int64_t x, std::int64_t y) const noexcept {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) +
           static_cast<std::size_t>(x);
  }
  [[nodiscard]] double code(std::size_t i) const noexcept { return encoding_.code(heights_[i]); }
  [[nodiscard]] bool holds(std::int64_t x, std::int64_t y) const noexcept {
    return x >= 0 && y >= 0 && x < width_ && y < height_;
  }
  void mark_rising();
  [[nodiscard]] bool rises(std::int64_t x, std::int64_t y) const noexcept {
    return (flags_[at(x, y)] & kRises) != 0;
  }
  [[nodiscard]] Line line_of(const EdgeEnd& a, const EdgeEnd& b) const noexcept;
  void cross_columns(const Line& line, GapMaximum& gap) const;
  void cross_rows(const Line& line, GapMaximum& gap) const;
  void cross_rising(const Line& line, GapMaximum& gap) const;
  void cross_falling(const Line& line, GapMaximum& gap) const;
  /// Adds the gap where an edge crosses the segment between the samples p and q, unless one of them
  /// is void.
  /// @param fraction  Where on the segment, from p (0) to q (1).
  /// @param edge      The edge's height there, above its first end.
  void add(std::size_t p, std::size_t q, double fraction, double edge, GapMaximum& gap) const {
    if ((flags_[p] & flags_[q] & kValid) != 0) {
      gap.add(code(p), code(q), fraction, edge);
    }
  }

  std::vector<HeightBits> heights_;
  static constexpr std::uint8_t kValid = 1;  ///< The sample has a height.
  /// The cell that has this sample as its lower left corner is cut along its rising diagonal.
  static constexpr std::uint8_t kRises = 2;
  std::vector<std::uint8_t> flags_;
  std::int32_t width_;
  std::int32_t height_;
  HeightEncoding encoding_;
  GridPoint origin_;
  std::unique_ptr<const PartSurface> border_;
  bool far_from_border_ = false;
};

}  // namespace ptin
