// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/query/coarsest.h"

#include <algorithm>
#include <cstdint>
#include <vector>

#include "engine/error.h"
#include "engine/mesh/validate.h"

namespace ptin {

namespace {

[[noreturn]] void throw_invalid(const std::string& fault, const std::string& file) {
  throw Error(ErrorCode::corruption,
              "T0 is not a valid TIN: " + fault + "; run verify, and build the file again", file);
}

void copy_corners(const CoarsestTin& t0, const std::string& file, Tin& tin) {
  for (const CoarsestTin::V& v : t0.vertices) {
    tin.vertices.push_back({v.position, v.height, kNone});
    tin.has_height.push_back(v.has_height != 0 ? 1 : 0);
  }
  for (const CoarsestTin::T& t : t0.triangles) {
    for (const std::uint32_t v : t.v) {
      if (v >= t0.vertices.size()) {
        throw_invalid("a triangle names vertex " + std::to_string(v) + " of " +
                          std::to_string(t0.vertices.size()),
                      file);
      }
    }
    tin.triangles.push_back({{t.v[0], t.v[1], t.v[2]}, {kNone, kNone, kNone}});
    tin.classes.push_back(t.is_void != 0 ? TriangleClass::kVoid : TriangleClass::kSurface);
  }
}

/// A side of a triangle under the key of its edge.
struct Side {
  std::uint64_t edge;
  TriangleId triangle;
  int side;
};

/// Joins the two sides of each edge. validate() finds edges that are not joined as they should be.
void join_neighbours(Tin& tin) {
  std::vector<Side> sides;
  for (TriangleId t = 0; t < tin.triangles.size(); ++t) {
    for (int i = 0; i < 3; ++i) {
      const auto [low, high] =
          std::minmax(tin.triangles[t].v[next_corner(i)], tin.triangles[t].v[previous_corner(i)]);
      sides.push_back({(std::uint64_t{low} << 32) | high, t, i});
    }
  }
  std::sort(sides.begin(), sides.end(), [](const Side& a, const Side& b) {
    return a.edge != b.edge ? a.edge < b.edge : a.triangle < b.triangle;
  });
  for (std::size_t i = 0; i + 1 < sides.size(); ++i) {
    const Side& a = sides[i];
    const Side& b = sides[i + 1];
    if (a.edge == b.edge) {
      tin.triangles[a.triangle].n[a.side] = b.triangle;
      tin.triangles[b.triangle].n[b.side] = a.triangle;
      ++i;
    }
  }
}

}  // namespace

Tin mesh_of(const CoarsestTin& t0, const std::string& file) {
  Tin tin;
  copy_corners(t0, file, tin);
  join_neighbours(tin);
  point_vertices(tin);
  for (const Vertex& v : tin.vertices) {
    if (v.triangle == kNone) {
      throw_invalid("a vertex is in no triangle", file);
    }
  }
  if (const std::string fault = validate(tin); !fault.empty()) {
    throw_invalid(fault, file);
  }
  return tin;
}

}  // namespace ptin
