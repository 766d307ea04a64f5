// SPDX-License-Identifier: GPL-3.0-or-later
//
// The samples of a raster as tiles: one tile as bytes, and back. storage/FORMAT.md, "Heights of a raster",
// has the bits.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace ptin {

/// A height as an unsigned number, in the order of heights: what tiles hold, and what their bounds are
/// compared by.
using OrderedHeight = std::uint32_t;

/// The samples of one tile, row by row. A tile of side s has s cells and s + 1 samples along each side,
/// fewer at the end of the raster; the last row and the last column are those that the next tiles begin
/// with, so that each cell lies in one tile.
struct FloorTile {
  /// A sample with a height that touches no triangle: void in `is_void`.
  struct Lone {
    std::uint16_t place;  ///< Row by row from 0.
    OrderedHeight height;
    friend bool operator==(const Lone&, const Lone&) = default;
  };

  std::uint32_t width = 0, height = 0;  ///< Samples, from 1 to kMostFloorSide + 1.
  std::vector<OrderedHeight> heights;   ///< Those of void samples are of no account.
  std::vector<std::uint8_t> is_void;    ///< Empty: none is.
  std::vector<Lone> lone;               ///< By their places.

  [[nodiscard]] std::size_t samples() const noexcept { return std::size_t{width} * height; }
};

/// Cells along a side of a tile, at most.
inline constexpr std::uint32_t kMostFloorSide = 64;
/// Bytes behind a tile's own that have to be readable.
inline constexpr std::size_t kFloorTileTail = 8;

/// Appends a tile's bytes. The same samples give the same bytes, whatever stands in void ones.
/// REQUIRES: sizes within their limits, and as many heights and voids as samples.
/// Cost: about 7 ns a sample.
void append_floor_tile(const FloorTile& tile, std::vector<std::byte>& to);

/// The tile of some bytes, whose void samples have the heights that packing gives them.
/// @param from           kFloorTileTail bytes behind its end are readable.
/// @param width, height  Samples, as the place of the tile says.
/// @param tile           Receives it; its memory is used again.
/// @return What is wrong with the bytes, as a sentence; null where nothing is. Whether they are those
///         that append_floor_tile() makes is told by packing them again.
/// Cost: about 1 ns a sample.
[[nodiscard]] const char* read_floor_tile(std::span<const std::byte> from, std::uint32_t width,
                                          std::uint32_t height, FloorTile& tile);

}  // namespace ptin
