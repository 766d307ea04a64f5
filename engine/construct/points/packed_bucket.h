// SPDX-License-Identifier: GPL-3.0-or-later
//
// The points of one bucket in few bytes: what they differ by within it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "engine/geometry/box.h"
#include "engine/geometry/point.h"

namespace ptin {

/// A point before its height is encoded.
struct PlacedHeight {
  GridPoint position;
  double height = 0.0;
  friend bool operator==(const PlacedHeight&, const PlacedHeight&) = default;
};

/// Packs points, in their order: coordinates from the corner of their box in as many bits as its
/// sides have, heights from the smallest, likewise; as whole numbers where all of them are, else by
/// the bits of floats or doubles. Nothing is lost, the sign of a zero included.
/// @param box   Of the points.
/// @param to    Overwritten.
/// At most kMostPackedBytes a point and 10 more.
void pack_bucket(std::span<const PlacedHeight> points, const GridBox& box,
                 std::vector<std::byte>& to);
inline constexpr std::uint64_t kMostPackedBytes = 16;

/// @param bytes   As packed, with kUnpackSlack bytes of any value behind.
/// @param points  Its size is that of the bucket; overwritten. No byte behind `bytes` is read, even
///                if these are not what was packed.
void unpack_bucket(std::span<const std::byte> bytes, const GridBox& box,
                   std::span<PlacedHeight> points);
inline constexpr std::size_t kUnpackSlack = 8;

}  // namespace ptin
