// SPDX-License-Identifier: GPL-3.0-or-later
#include "storage/verify_t0.h"

#include <algorithm>
#include <cstdint>
#include <unordered_map>

#include "engine/geometry/orient.h"

namespace ptin {

namespace {

// Sums of at most 2^32 areas below 2^62 each.
__extension__ using WideArea = __int128;

using Edge = std::uint64_t;  // The ids of its ends: from the upper half to the lower.

Edge edge(std::uint32_t from, std::uint32_t to) { return Edge{from} << 32 | to; }
Edge reversed(Edge e) { return e << 32 | e >> 32; }

std::vector<Edge> sorted_edges(const CoarsestTin& t0) {
  std::vector<Edge> edges;
  edges.reserve(3 * t0.triangles.size());
  for (const CoarsestTin::T& t : t0.triangles) {
    for (int i = 0; i < 3; ++i) {
      edges.push_back(edge(t.v[i], t.v[i == 2 ? 0 : i + 1]));
    }
  }
  std::sort(edges.begin(), edges.end());
  return edges;
}

// The border in order, as vertices; empty when it is not one closed line.
std::vector<std::uint32_t> border_of(const std::vector<Edge>& edges) {
  std::unordered_map<std::uint32_t, std::uint32_t> next;
  for (const Edge e : edges) {
    if (!std::binary_search(edges.begin(), edges.end(), reversed(e)) &&
        !next.emplace(static_cast<std::uint32_t>(e >> 32), static_cast<std::uint32_t>(e)).second) {
      return {};
    }
  }
  std::vector<std::uint32_t> border;
  if (next.empty()) {
    return border;
  }
  const std::uint32_t first = next.begin()->first;
  std::uint32_t v = first;
  do {
    border.push_back(v);
    const auto found = next.find(v);
    if (found == next.end() || border.size() > next.size()) {
      return {};
    }
    v = found->second;
  } while (v != first);
  return border.size() == next.size() ? border : std::vector<std::uint32_t>{};
}

// True when the edge goes up, or level and to the right.
bool is_rising(GridPoint from, GridPoint to) {
  return to.y > from.y || (to.y == from.y && to.x > from.x);
}

// True when the border never turns right, and goes around once: a five-pointed star never turns
// right either, and goes around twice.
bool is_convex(const CoarsestTin& t0, const std::vector<std::uint32_t>& border) {
  const std::size_t n = border.size();
  int rounds = 0;
  for (std::size_t i = 0; i < n; ++i) {
    const GridPoint a = t0.vertices[border[i]].position;
    const GridPoint b = t0.vertices[border[(i + 1) % n]].position;
    const GridPoint c = t0.vertices[border[(i + 2) % n]].position;
    if (orient(a, b, c) < 0) {
      return false;
    }
    rounds += !is_rising(a, b) && is_rising(b, c) ? 1 : 0;
  }
  return rounds == 1;
}

WideArea area_inside(const CoarsestTin& t0, const std::vector<std::uint32_t>& border) {
  WideArea sum = 0;
  for (std::size_t i = 0; i < border.size(); ++i) {
    sum += orient(t0.vertices[border[0]].position, t0.vertices[border[i]].position,
                  t0.vertices[border[(i + 1) % border.size()]].position);
  }
  return sum;
}

}  // namespace

std::vector<std::string> faults_of_cover(const CoarsestTin& t0, const GridBox& bounds) {
  std::vector<std::string> faults;
  if (t0.triangles.empty()) {
    return {"T0 has no triangle"};
  }
  WideArea sum = 0;
  GridBox box;
  std::vector<bool> used(t0.vertices.size());
  for (std::size_t i = 0; i < t0.triangles.size(); ++i) {
    const auto& v = t0.triangles[i].v;
    const std::int64_t area =
        orient(t0.vertices[v[0]].position, t0.vertices[v[1]].position, t0.vertices[v[2]].position);
    if (area <= 0) {
      faults.push_back("triangle " + std::to_string(i) + " is not counter-clockwise");
      return faults;
    }
    sum += area;
    for (const std::uint32_t corner : v) {
      used[corner] = true;
      box = united(box, t0.vertices[corner].position);
    }
  }
  if (std::find(used.begin(), used.end(), false) != used.end()) {
    faults.emplace_back("a vertex stands in no triangle");
  }
  if (!(box == bounds)) {
    faults.emplace_back("the box of the triangles is not the bounds of the header");
  }
  const std::vector<Edge> edges = sorted_edges(t0);
  if (std::adjacent_find(edges.begin(), edges.end()) != edges.end()) {
    faults.emplace_back("two triangles have the same edge in the same direction");
    return faults;
  }
  const std::vector<std::uint32_t> border = border_of(edges);
  if (border.empty() || !is_convex(t0, border)) {
    faults.emplace_back("the border is not one closed convex line");
  } else if (area_inside(t0, border) != sum) {
    faults.emplace_back(
        "the areas of the triangles do not add up to the area inside of the border");
  }
  return faults;
}

}  // namespace ptin
