// SPDX-License-Identifier: GPL-3.0-or-later
//
// The points of one bucket in few bytes: by how much they differ from its corner and its lowest.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "engine/construct/grid/grid_vertex.h"
#include "engine/geometry/box.h"
#include "engine/geometry/point.h"

namespace ptin {

/// Packs points, in their order. Coordinates are stored relative to the corner of `box`, in as many
/// bits as its sides need. A height is stored as a number, relative to the least of these numbers,
/// in as many bits as their range needs: the height itself where all heights are whole, else the
/// bits of its float where all are floats, else the bits of its double. Nothing is lost, not even
/// the sign of a zero.
/// @param box   The box of the points.
/// @param to    Overwritten. Its size is at most 10 bytes and kMostPackedBytes a point.
void pack_bucket(std::span<const GridVertex> points, const GridBox& box,
                 std::vector<std::byte>& to);
inline constexpr std::uint64_t kMostPackedBytes = 16;

/// Unpacks the first points of a bucket.
/// @param bytes   As packed. kUnpackSlack bytes of any value must lie behind them in memory; no
///                byte behind these is read, even where `bytes` are not what was packed.
/// @param box     As packed.
/// @param points  As many as are wanted, at most those of the bucket. Overwritten; left as they are
///                where `bytes` are too few for so many.
void unpack_bucket(std::span<const std::byte> bytes, const GridBox& box,
                   std::span<GridVertex> points);
inline constexpr std::size_t kUnpackSlack = 8;

}  // namespace ptin
