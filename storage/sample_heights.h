// SPDX-License-Identifier: GPL-3.0-or-later
//
// Heights of single samples of a raster, for pages of records that leave those of their vertices to it.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "engine/geometry/box.h"
#include "storage/file/io_counters.h"
#include "storage/floor.h"
#include "storage/floor_tile.h"

namespace ptin {

/// Keeps the tiles that were read lately, so that neighbours of a vertex, and neighbouring pages, cost a
/// load each: those of any window of kSide x kSide tiles at once. Levels of pages each go over the whole
/// window, so one that forgets what it read longest ago would read all anew for each level.
/// A value of its caller's, which stays where it is; a query has one. Threads: one owner.
/// Memory: at most kSide x kSide tiles, of 4.3 KB each where they have 32 cells a side, and Floor::Recent.
class SampleHeights {
 public:
  SampleHeights() = default;
  SampleHeights(const SampleHeights&) = delete;
  SampleHeights& operator=(const SampleHeights&) = delete;

  /// Goes on with the heights of a file. Those of another one are forgotten.
  /// @param counters  Count what at() reads; borrowed, as the floor, until the next call.
  void use(const Floor& floor, IoCounters& counters);

  /// Has the tiles that hold the samples of some boxes come with what is read next, where the file lies
  /// elsewhere. REQUIRES: use() was called; the boxes are not empty, and within the raster.
  /// @throws Error corruption, io_error
  void announce(std::span<const GridBox> boxes);
  /// Announces as Floor::announce_known() does.
  void announce_known(std::span<const GridBox> boxes);

  /// The ordered height of a sample as the file's vertices have it; 0, which no vertex has, of a void
  /// one or beside the raster.
  /// REQUIRES: use() was called.
  /// @throws Error corruption, io_error
  /// Cost: a load; 4 us where its tile was not read lately and the system has it.
  [[nodiscard]] OrderedHeight at(std::int64_t x, std::int64_t y) {
    if (x < 0 || y < 0 || x >= width_ || y >= height_) [[unlikely]] {
      return 0;
    }
    // A raster's last samples may lie on the end of its last tile, which has them.
    const auto column = std::min(static_cast<std::uint32_t>(x >> side_log2_), last_column_);
    const auto row = std::min(static_cast<std::uint32_t>(y >> side_log2_), last_row_);
    const Slot& slot = slots_[place(column, row)];
    if (slot.column != column || slot.row != row) read(column, row);
    const std::int64_t tile_x = x - (std::int64_t{column} << side_log2_);
    const std::int64_t tile_y = y - (std::int64_t{row} << side_log2_);
    return slot.heights[tile_y * slot.width + tile_x];
  }

  static constexpr std::uint32_t kSide = 16;

 private:
  static constexpr std::uint32_t kNone = UINT32_MAX;
  /// The last tile that was read of those with the same place modulo kSide.
  struct Slot {
    std::uint32_t column = kNone, row = kNone;
    std::uint32_t width = 0;  ///< Samples of a row.
    std::uint32_t tile = kNone;
    const OrderedHeight* heights = nullptr;  ///< Those of `tile`.
  };
  [[nodiscard]] static constexpr std::size_t place(std::uint32_t column,
                                                   std::uint32_t row) noexcept {
    return std::size_t{row % kSide} * kSide + column % kSide;
  }
  void read(std::uint32_t column, std::uint32_t row);
  [[nodiscard]] std::vector<std::uint64_t> keys_of(std::span<const GridBox> boxes) const;

  const Floor* floor_ = nullptr;
  IoCounters* counters_ = nullptr;
  std::int64_t width_ = 0, height_ = 0;  ///< Samples of the raster.
  std::uint32_t side_log2_ = 0, last_column_ = 0, last_row_ = 0;
  std::vector<Slot> slots_;  ///< kSide x kSide, once there is a floor.
  std::vector<std::vector<OrderedHeight>> tiles_;
  Floor::Recent recent_;
  FloorTile read_tile_;
};

}  // namespace ptin
