// SPDX-License-Identifier: GPL-3.0-or-later
//
// A file of triangles with pockets and holes.
#pragma once

#include <cstdint>
#include <string>

#include "tests/construct/point_sets.h"
#include "tests/construct/test_terrain.h"

namespace ptin::test {

/// A Delaunay triangulation without the triangles in some squares of the plane, in a binary PLY.
inline std::string holed_ply(PointKind kind, std::uint64_t n, std::uint64_t seed,
                             int holes_of_ten) {
  const oracle::TestTerrain terrain =
      oracle::make_points({"", points_of(kind, n, seed), [](GridPoint p) {
                             return static_cast<double>(key_of(p) * 0x9e3779b97f4a7c15U >> 54);
                           }});
  const Tin& tin = terrain.full;
  GridBox box;
  for (const Vertex& v : tin.vertices) {
    box = united(box, v.position);
  }
  const auto is_kept = [&](const Triangle& t) {
    const GridPoint a = tin.position(t.v[0]);
    const std::uint64_t cell =
        std::uint64_t(8.0 * (a.x - box.min_x) / (1.0 + box.max_x - box.min_x)) +
        8 * std::uint64_t(8.0 * (a.y - box.min_y) / (1.0 + box.max_y - box.min_y));
    return static_cast<int>(((cell + seed + 3) * 0x9e3779b97f4a7c15U >> 40) % 10) >= holes_of_ten;
  };
  std::string faces, vertices;
  const auto put = [](std::string& to, auto value) {
    to.append(reinterpret_cast<const char*>(&value), sizeof value);
  };
  std::uint64_t count = 0;
  for (const Triangle& t : tin.triangles) {
    if (is_kept(t) || &t == &tin.triangles.front()) {
      put(faces, std::uint8_t{3});
      for (const VertexId v : t.v) put(faces, static_cast<std::int32_t>(v));
      ++count;
    }
  }
  for (const Vertex& v : tin.vertices) {
    put(vertices, static_cast<double>(v.position.x));
    put(vertices, static_cast<double>(v.position.y));
    put(vertices, static_cast<float>(terrain.tile.units.heights.code(v.height)));
  }
  return "ply\nformat binary_little_endian 1.0\nelement vertex " +
         std::to_string(tin.vertices.size()) +
         "\nproperty double x\nproperty double y\nproperty float z\nelement face " +
         std::to_string(count) + "\nproperty list uchar int vertex_indices\nend_header\n" +
         vertices + faces;
}

}  // namespace ptin::test
