// SPDX-License-Identifier: GPL-3.0-or-later
//
// The triangulated irregular network: triangles with neighbours over grid vertices.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "engine/geometry/height.h"
#include "engine/geometry/point.h"

namespace ptin {

/// Indices into the arrays of one Tin. 32 bits: one mesh in memory has fewer than 2^32 - 1
/// triangles; terrains have no such limit, since a tile or a refinement holds a part of one.
using VertexId = std::uint32_t;
using TriangleId = std::uint32_t;
inline constexpr std::uint32_t kNone = UINT32_MAX;

/// Surface triangles carry the terrain; void triangles cover the part of the domain without
/// heights.
enum class TriangleClass : std::uint8_t { kSurface = 0, kVoid = 1 };

/// A vertex. `triangle` is one triangle around it. On the border it is the first of the
/// counter-clockwise walk, whose clockwise neighbour around the vertex is missing (invariant I6 of
/// mesh/validate.h). A removed vertex has kNone.
struct Vertex {
  GridPoint position;
  HeightBits height = 0;
  TriangleId triangle = kNone;
};

/// A triangle: corners counter-clockwise; neighbour n[i] lies across the edge opposite to corner
/// v[i] (from v[i+1] to v[i+2]) and is kNone at the border. A removed triangle has v[0] == kNone.
struct Triangle {
  VertexId v[3];
  TriangleId n[3];
};

/// A triangulation of a convex domain: every point of it is covered once, with no crack, no overlap
/// and no T-junction. Plain arrays: functions in mesh/collapse.h and mesh/split.h change them,
/// mesh/star.h walks them, mesh/validate.h numbers their invariants. A vertex without a height
/// stands in void triangles only.
struct Tin {
  std::vector<Vertex> vertices;
  std::vector<std::uint8_t> has_height;  ///< 1 for each of `vertices` that carries a height.
  std::vector<Triangle> triangles;
  std::vector<TriangleClass> classes;  ///< One for each of `triangles`.

  [[nodiscard]] GridPoint position(VertexId v) const noexcept { return vertices[v].position; }
  [[nodiscard]] bool is_alive(TriangleId t) const noexcept { return triangles[t].v[0] != kNone; }
  /// Number of vertices and triangles that are not removed. Cost: linear.
  [[nodiscard]] std::size_t alive_vertices() const noexcept;
  [[nodiscard]] std::size_t alive_triangles() const noexcept;
};

/// Place of vertex `v` (0, 1, 2) in triangle `t`. REQUIRES: `v` is a corner of `t`.
[[nodiscard]] inline int corner_of(const Triangle& t, VertexId v) noexcept {
  // Without branches: the place cannot be predicted, and walks do little else than ask for it.
  const int first_two = static_cast<int>(t.v[1] == v);
  return t.v[2] == v ? 2 : first_two;
}

/// Place of neighbour `n` (0, 1, 2) in triangle `t`. REQUIRES: `n` is a neighbour of `t`.
[[nodiscard]] inline int side_of(const Triangle& t, TriangleId n) noexcept {
  const bool beyond_first = t.n[0] != n;
  return static_cast<int>(beyond_first) + static_cast<int>(beyond_first & (t.n[1] != n));
}

/// Puts `now` in the place of neighbour `was` of triangle `t`. Does nothing where `t` is kNone,
/// which is what lies beyond the border. REQUIRES: `was` is a neighbour of `t`.
inline void replace_neighbour(Tin& tin, TriangleId t, TriangleId was, TriangleId now) noexcept {
  if (t != kNone) {
    Triangle& triangle = tin.triangles[t];
    triangle.n[side_of(triangle, was)] = now;
  }
}

/// Points each vertex at one of its triangles: a border vertex at the first of the
/// counter-clockwise walk (invariant I6 of mesh/validate.h), a vertex of no triangle at kNone.
/// REQUIRES: no removed triangle. Cost: linear.
void point_vertices(Tin& tin);

[[nodiscard]] inline constexpr int next_corner(int i) noexcept { return i == 2 ? 0 : i + 1; }
[[nodiscard]] inline constexpr int previous_corner(int i) noexcept { return i == 0 ? 2 : i - 1; }

}  // namespace ptin
