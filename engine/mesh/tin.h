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

/// A vertex. `triangle` is one triangle around it; on the border it is the first of the
/// counter-clockwise walk, the one whose clockwise neighbour around the vertex is missing (I6). A
/// removed vertex has kNone.
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

/// A triangulation of a simply connected domain: every point of it covered once, no crack, no
/// overlap, no T-junction. Plain arrays; functions beside it (star.h, collapse.h, split.h) change
/// it, validate.h states its invariants. A vertex whose bit `has_height` is 0 stands in void
/// triangles only.
struct Tin {
  std::vector<Vertex> vertices;
  std::vector<std::uint8_t> has_height;  ///< Beside `vertices`: 1 when the vertex carries a height.
  std::vector<Triangle> triangles;
  std::vector<TriangleClass> classes;  ///< Beside `triangles`.

  [[nodiscard]] GridPoint position(VertexId v) const noexcept { return vertices[v].position; }
  [[nodiscard]] bool is_alive(TriangleId t) const noexcept { return triangles[t].v[0] != kNone; }
  /// Number of vertices and triangles that are not removed. Cost: linear.
  [[nodiscard]] std::size_t alive_vertices() const noexcept;
  [[nodiscard]] std::size_t alive_triangles() const noexcept;
};

/// Place of vertex `v` (0, 1, 2) in triangle `t`. REQUIRES: it is a corner.
[[nodiscard]] inline int corner_of(const Triangle& t, VertexId v) noexcept {
  // Without branches: which one it is cannot be predicted, and walks do little else.
  const int first_two = static_cast<int>(t.v[1] == v);
  return t.v[2] == v ? 2 : first_two;
}

/// Place of neighbour `n` in triangle `t`. REQUIRES: it is a neighbour.
[[nodiscard]] inline int side_of(const Triangle& t, TriangleId n) noexcept {
  const bool beyond_first = t.n[0] != n;
  return static_cast<int>(beyond_first) + static_cast<int>(beyond_first & (t.n[1] != n));
}

/// Neighbour `was` of triangle `t` becomes `now`. Does nothing where `t` is kNone, beyond the
/// border. REQUIRES: `was` is a neighbour.
inline void replace_neighbour(Tin& tin, TriangleId t, TriangleId was, TriangleId now) noexcept {
  if (t != kNone) {
    Triangle& triangle = tin.triangles[t];
    triangle.n[side_of(triangle, was)] = now;
  }
}

/// Points each vertex at one of its triangles: on the border at the first of the counter-clockwise
/// walk (invariant I6). Vertices of no triangle point at kNone. REQUIRES: no removed triangle.
/// Cost: linear.
void point_vertices(Tin& tin);

[[nodiscard]] inline constexpr int next_corner(int i) noexcept { return i == 2 ? 0 : i + 1; }
[[nodiscard]] inline constexpr int previous_corner(int i) noexcept { return i == 0 ? 2 : i - 1; }

}  // namespace ptin
