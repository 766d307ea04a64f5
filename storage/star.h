// SPDX-License-Identifier: GPL-3.0-or-later
//
// Stars with lifetimes: the triangles that a record's split makes, and the error at which each of
// them goes (engine/DESIGN.md, section 2.10).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "engine/geometry/height.h"
#include "engine/geometry/point.h"
#include "storage/record.h"

namespace ptin {

/// The death of a triangle that no record replaces: it is one of the file's finest TIN.
inline constexpr float kLivesOn = -std::numeric_limits<float>::infinity();

/// A vertex l_i of the ring around u, and triangle (u, l_i, l_i+1). The last corner of an open
/// ring has no triangle: `death` is kLivesOn and kVoid is not set.
struct RingCorner {
  enum Flag : std::uint8_t {
    kVoid = 1,      ///< The triangle is void.
    kNoHeight = 2,  ///< The vertex has no height; `height` is 0.
  };
  GridPoint position;
  HeightBits height = 0;
  float death = kLivesOn;  ///< Error of the record whose fan the triangle belongs to.
  std::uint8_t flags = 0;
  std::array<std::uint8_t, 3>
      unused{};  ///< In the place of padding: builds write corners as they are.
  [[nodiscard]] bool has_height() const noexcept { return (flags & kNoHeight) == 0; }
  [[nodiscard]] bool is_void() const noexcept { return (flags & kVoid) != 0; }  ///< The triangle.
  friend bool operator==(const RingCorner&, const RingCorner&) = default;
};

/// Records, and the star of each. Corners of a ring come counter-clockwise around u. A closed ring
/// begins at w, so it is w, vl, ..., vr. An open one runs from the next vertex along the border to
/// the previous one: it is w, vl, ..., vr with kNoRight, and vl, ..., vr, w with kNoLeft. So w, vl,
/// vr and the classes of (u, w, vl) and (u, vr, w) are there twice, and agree.
struct StarredRecords {
  std::vector<VertexSplit> splits;
  std::vector<RingCorner> corners;      ///< Ring after ring.
  std::vector<std::uint32_t> ring_end;  ///< Ends of rings, in `corners`.

  [[nodiscard]] std::size_t size() const noexcept { return splits.size(); }
  [[nodiscard]] bool empty() const noexcept { return splits.empty(); }
  [[nodiscard]] std::span<RingCorner> ring(std::size_t i) noexcept {
    const std::size_t begin = i == 0 ? 0 : ring_end[i - 1];
    return std::span(corners).subspan(begin, ring_end[i] - begin);
  }
  [[nodiscard]] std::span<const RingCorner> ring(std::size_t i) const noexcept {
    const std::size_t begin = i == 0 ? 0 : ring_end[i - 1];
    return std::span(corners).subspan(begin, ring_end[i] - begin);
  }
  /// Keeps the first `count` records.
  void resize(std::size_t count) {
    splits.resize(count);
    ring_end.resize(count);
    corners.resize(count == 0 ? 0 : ring_end.back());
  }
  void clear() noexcept {
    splits.clear();
    corners.clear();
    ring_end.clear();
  }
};

/// True when the star of a record is all around u: it has as many triangles as corners. Else u is
/// on the border, and there is one triangle less.
[[nodiscard]] constexpr bool has_closed_ring(const VertexSplit& r) noexcept {
  return (r.flags & (VertexSplit::kNoLeft | VertexSplit::kNoRight)) == 0;
}

/// Whether the triangles around u can be a star of the record: the roi holds the corners, the
/// interval of heights those of the corners, triangles are counter-clockwise and go around u
/// once (at most a half turn where the ring is open), none dies above the error, a surface triangle
/// has three heights, and of the last corner of an open ring there is no triangle. w, vl and vr are
/// not looked at.
/// REQUIRES: the roi lies on the grid and holds u; `ring` is not empty.
[[nodiscard]] bool is_star(const VertexSplit& r, std::span<const RingCorner> ring,
                           const HeightEncoding& heights) noexcept;

}  // namespace ptin
