// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/query/clip.h"

#include <cstddef>

namespace ptin {

namespace {

/// New number of each triangle, kNone for those that go.
std::vector<TriangleId> number_meeting(const Tin& tin, const GridRegion& region,
                                       const QueryContext& context) {
  std::vector<TriangleId> number(tin.triangles.size(), kNone);
  TriangleId next = 0;
  for (TriangleId t = 0; t < tin.triangles.size(); ++t) {
    if (t % kStopInterval == 0) {
      context.check_stop();
    }
    const Triangle& triangle = tin.triangles[t];
    if (tin.is_alive(t) && region.meets(tin.position(triangle.v[0]), tin.position(triangle.v[1]),
                                        tin.position(triangle.v[2]))) {
      number[t] = next++;
    }
  }
  return number;
}

/// Moves the triangles that stay to the front. Their corners keep the old numbers.
void keep_triangles(Tin& tin, const std::vector<TriangleId>& number,
                    std::vector<std::uint32_t>& pages) {
  std::size_t kept = 0;
  for (TriangleId t = 0; t < number.size(); ++t) {
    if (number[t] == kNone) {
      continue;
    }
    Triangle triangle = tin.triangles[t];
    for (TriangleId& n : triangle.n) {
      n = n == kNone ? kNone : number[n];
    }
    tin.triangles[kept] = triangle;
    tin.classes[kept] = tin.classes[t];
    if (!pages.empty()) {
      pages[kept] = pages[t];
    }
    ++kept;
  }
  tin.triangles.resize(kept);
  tin.classes.resize(kept);
  if (!pages.empty()) {
    pages.resize(kept);
  }
}

void keep_vertices(Tin& tin) {
  std::vector<VertexId> number(tin.vertices.size(), kNone);
  VertexId kept = 0;
  for (VertexId v = 0; v < number.size(); ++v) {
    if (tin.vertices[v].triangle != kNone) {
      number[v] = kept;
      tin.vertices[kept] = tin.vertices[v];
      tin.has_height[kept] = tin.has_height[v];
      ++kept;
    }
  }
  tin.vertices.resize(kept);
  tin.has_height.resize(kept);
  for (Triangle& triangle : tin.triangles) {
    for (VertexId& v : triangle.v) {
      v = number[v];
    }
  }
}

}  // namespace

void keep_meeting(Tin& tin, const GridRegion& region, std::vector<std::uint32_t>& pages,
                  const QueryContext& context) {
  keep_triangles(tin, number_meeting(tin, region, context), pages);
  point_vertices(tin);
  keep_vertices(tin);
}

}  // namespace ptin
