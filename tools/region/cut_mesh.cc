// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/region/cut_mesh.h"

#include <algorithm>
#include <cmath>

#include "engine/check.h"

namespace ptin::tools {

namespace {

/// > 0 when `p` lies ahead of `a` on the way a -> b.
Int128 dot(Spot a, Spot b, Spot p) noexcept {
  return Int128{b.x - a.x} * (p.x - a.x) + Int128{b.y - a.y} * (p.y - a.y);
}

bool comes_first(Spot a, Spot b) noexcept { return a.y != b.y ? a.y < b.y : a.x < b.x; }

}  // namespace

CutMesh::CutPlace CutMesh::place_in(TriangleId t, Spot p) const noexcept {
  const CutTriangle& triangle = triangles[t];
  CutPlace place;
  for (int i = 0; i < 3; ++i) {
    const Int128 o = side(at(triangle.v[next_corner(i)]), at(triangle.v[previous_corner(i)]), p);
    if (o < 0) return {};
    if (o == 0) {
      // On two edges at once: at the corner that they share.
      if (place.edge >= 0) place.corner = 3 - place.edge - i;
      place.edge = i;
    }
  }
  place.triangle = t;
  return place;
}

CutMesh::CutPlace CutMesh::locate(Spot p) {
  TriangleId t = hint_;
  for (std::size_t step = 0; step <= triangles.size(); ++step) {
    const CutTriangle& triangle = triangles[t];
    TriangleId next = t;
    for (int i = 0; i < 3 && next == t; ++i) {
      // Each step begins with another edge, so that walks do not go in circles in practice.
      const int edge = static_cast<int>((static_cast<std::size_t>(i) + step) % 3);
      if (side(at(triangle.v[next_corner(edge)]), at(triangle.v[previous_corner(edge)]), p) < 0) {
        next = triangle.n[edge];
      }
    }
    if (next == t) {
      hint_ = t;
      return place_in(t, p);
    }
    if (next == kNone) break;
    t = next;
  }
  // The walk left the mesh. The point lies outside, or behind a concave part of the outline.
  for (t = 0; t < triangles.size(); ++t) {
    const CutPlace place = place_in(t, p);
    if (place.triangle != kNone) {
      hint_ = t;
      return place;
    }
  }
  return {};
}

std::vector<TriangleId> CutMesh::star(std::uint32_t v) const {
  std::vector<TriangleId> around;
  const TriangleId first = nodes[v].triangle;
  const auto corner = [&](TriangleId t) {
    const auto& c = triangles[t].v;
    return c[0] == v ? 0 : (c[1] == v ? 1 : 2);
  };
  TriangleId t = first;
  do {
    around.push_back(t);
    t = triangles[t].n[next_corner(corner(t))];
  } while (t != kNone && t != first);
  if (t == kNone) {
    for (t = triangles[first].n[previous_corner(corner(first))]; t != kNone;
         t = triangles[t].n[previous_corner(corner(t))]) {
      around.push_back(t);
    }
  }
  return around;
}

std::uint32_t CutMesh::insert_point(const BorderCorner& corner) {
  const Spot p = corner.at;
  const CutPlace place = locate(p);
  if (place.triangle == kNone) return kNone;
  if (place.corner >= 0) return triangles[place.triangle].v[place.corner];
  const auto corners = triangles[place.triangle].v;
  CutNode node;
  node.at = p;
  node.map = {corner.map.x, corner.map.y, 0.0};
  node.has_height = true;
  double total = 0.0;
  for (int i = 0; i < 3; ++i) {
    const auto weight =
        static_cast<double>(side(at(corners[next_corner(i)]), at(corners[previous_corner(i)]), p));
    node.map[2] += weight == 0.0 ? 0.0 : weight * nodes[corners[i]].map[2];
    node.has_height = node.has_height && (weight == 0.0 || nodes[corners[i]].has_height);
    total += weight;
  }
  node.map[2] /= total;
  const auto id = static_cast<std::uint32_t>(nodes.size());
  nodes.push_back(node);
  place.edge >= 0 ? split_edge(place.triangle, place.edge, id) : split_triangle(place.triangle, id);
  return id;
}

void CutMesh::split_triangle(TriangleId t, std::uint32_t node) {
  const CutTriangle old = triangles[t];
  const auto base = static_cast<TriangleId>(triangles.size());
  const TriangleId ids[3] = {t, base, base + 1};
  triangles.resize(triangles.size() + 2);
  for (int i = 0; i < 3; ++i) {
    // The triangle on the edge opposite to corner i: (next, previous, node).
    const auto a = old.v[next_corner(i)];
    const auto b = old.v[previous_corner(i)];
    CutTriangle& made = triangles[ids[i]];
    made.v = {a, b, node};
    made.n = {ids[next_corner(i)], ids[previous_corner(i)], old.n[i]};
    made.border = {false, false, old.border[i]};
    made.cls = old.cls;
    nodes[a].triangle = nodes[b].triangle = ids[i];
    if (old.n[i] != kNone) {
      auto& back = triangles[old.n[i]].n;
      *std::find(back.begin(), back.end(), t) = ids[i];
    }
  }
  nodes[node].triangle = t;
}

bool CutMesh::can_split_edge(TriangleId t, int i, Spot p) const noexcept {
  // Rounding moves the place off the edge: all four triangles must stay counter-clockwise, strictly.
  const auto fits = [&](TriangleId id, int apex) {
    const auto& v = triangles[id].v;
    return side(at(v[apex]), at(v[next_corner(apex)]), p) > 0 &&
           side(at(v[previous_corner(apex)]), at(v[apex]), p) > 0;
  };
  if (!fits(t, i)) return false;
  const TriangleId other = triangles[t].n[i];
  if (other == kNone) return true;
  const auto& n = triangles[other].n;
  return fits(other, static_cast<int>(std::find(n.begin(), n.end(), t) - n.begin()));
}

void CutMesh::split_edge(TriangleId t, int edge, std::uint32_t node) {
  const TriangleId other = triangles[t].n[edge];
  const TriangleId ids[2] = {t, other};
  TriangleId halves[2] = {kNone, kNone};  // of each side: the part at the second end of the edge
  for (int k = 0; k < 2; ++k) {
    if (ids[k] == kNone) continue;
    const CutTriangle old = triangles[ids[k]];
    const int i =
        k == 0 ? edge : static_cast<int>(std::find(old.n.begin(), old.n.end(), t) - old.n.begin());
    const int next = next_corner(i);
    const int previous = previous_corner(i);
    // (apex, p, q) becomes (apex, p, node) and (apex, node, q); neighbours across the edge are set
    // below.
    halves[k] = static_cast<TriangleId>(triangles.size());
    triangles[ids[k]] = {{old.v[i], old.v[next], node},
                         {kNone, halves[k], old.n[previous]},
                         {old.border[i], false, old.border[previous]},
                         old.cls};
    triangles.push_back({{old.v[i], node, old.v[previous]},
                         {kNone, old.n[next], ids[k]},
                         {old.border[i], old.border[next], false},
                         old.cls});
    if (old.n[next] != kNone) {
      auto& back = triangles[old.n[next]].n;
      *std::find(back.begin(), back.end(), ids[k]) = halves[k];
    }
    nodes[old.v[i]].triangle = nodes[old.v[next]].triangle = ids[k];
    nodes[old.v[previous]].triangle = halves[k];
  }
  if (other != kNone) {
    triangles[t].n[0] = halves[1];
    triangles[halves[1]].n[0] = t;
    triangles[halves[0]].n[0] = other;
    triangles[other].n[0] = halves[0];
  }
  nodes[node].triangle = t;
}

void CutMesh::toggle_border(std::uint32_t a, std::uint32_t b) {
  for (const TriangleId t : star(a)) {
    for (int i = 0; i < 3; ++i) {
      const auto p = triangles[t].v[next_corner(i)];
      const auto q = triangles[t].v[previous_corner(i)];
      if ((p == a && q == b) || (p == b && q == a))
        triangles[t].border[i] = !triangles[t].border[i];
    }
  }
}

void CutMesh::insert_segment(const BorderSegment& segment, std::uint32_t from, std::uint32_t to) {
  if (from != kNone) {
    trace(from, segment.to.at, to, segment);
  } else if (to != kNone) {
    trace(to, segment.from.at, kNone, segment);
  } else {
    const std::uint32_t entry = entry_of(segment);
    if (entry != kNone) trace(entry, segment.to.at, kNone, segment);
  }
}

void CutMesh::trace(std::uint32_t from, Spot target, std::uint32_t to,
                    const BorderSegment& segment) {
  std::uint32_t v = from;
  for (std::size_t step = 0; v != to; ++step) {
    PTIN_CHECK(step < 8 * triangles.size() + 64);
    const std::uint32_t next = next_on_the_way(v, target, to, segment);
    if (next == kNone) return;
    toggle_border(v, next);
    v = next;
  }
}

std::uint32_t CutMesh::next_on_the_way(std::uint32_t v, Spot target, std::uint32_t to,
                                       const BorderSegment& segment) {
  if (at(v) == target) return kNone;
  const std::vector<TriangleId> around = star(v);
  for (const TriangleId t : around) {
    for (const std::uint32_t corner : triangles[t].v) {
      if (corner != v && corner == to) return to;
    }
  }
  for (const TriangleId t : around) {
    const auto& corners = triangles[t].v;
    const int i = corners[0] == v ? 0 : (corners[1] == v ? 1 : 2);
    const std::uint32_t a = corners[next_corner(i)];
    const std::uint32_t b = corners[previous_corner(i)];
    const Int128 left = side(at(v), at(a), target);
    const Int128 right = side(at(v), at(b), target);
    if (left == 0 && dot(at(v), target, at(a)) > 0) return a;
    if (right == 0 && dot(at(v), target, at(b)) > 0) return b;
    if (left > 0 && right < 0 && side(at(a), at(b), target) < 0) {
      return cross_edge(t, i, at(v), target, segment);
    }
  }
  return kNone;
}

std::uint32_t CutMesh::cross_edge(TriangleId t, int i, Spot v, Spot target,
                                  const BorderSegment& segment) {
  const std::uint32_t a = triangles[t].v[next_corner(i)];
  const std::uint32_t b = triangles[t].v[previous_corner(i)];
  const CutNode node = crossing(a, b, v, target, segment);
  if (!can_split_edge(t, i, node.at)) {
    // The crossing is closer to an end of the edge than spots can tell: the way goes through that
    // end.
    const auto away = [&](std::uint32_t end) {
      const Int128 area = side(v, target, at(end));
      return area < 0 ? -area : area;
    };
    return away(a) <= away(b) ? a : b;
  }
  const auto id = static_cast<std::uint32_t>(nodes.size());
  nodes.push_back(node);
  split_edge(t, i, id);
  return id;
}

CutNode CutMesh::crossing(std::uint32_t a, std::uint32_t b, Spot v, Spot target,
                          const BorderSegment& segment) const {
  const auto& [from, to] = segment;
  CutNode node;
  std::uint32_t low = a;
  std::uint32_t high = b;
  // Where the edge is a piece of an edge of the TIN, the crossing is computed from the ends of the
  // whole edge, as every other cut of it.
  const CutNode& cut = nodes[a].edge_low != kNone ? nodes[a] : nodes[b];
  const auto on_edge = [&](std::uint32_t id) {
    return id == cut.edge_low || id == cut.edge_high ||
           (nodes[id].edge_low == cut.edge_low && nodes[id].edge_high == cut.edge_high);
  };
  bool is_tin_edge = nodes[a].is_tin_vertex && nodes[b].is_tin_vertex;
  if (!is_tin_edge && cut.edge_low != kNone && on_edge(a) && on_edge(b)) {
    low = cut.edge_low;
    high = cut.edge_high;
    is_tin_edge = true;
  }
  // One order of the ends, whichever of the two triangles the way comes from: both get the same bits.
  if (comes_first(at(high), at(low))) std::swap(low, high);
  if (is_tin_edge) {
    node.edge_low = low;
    node.edge_high = high;
  }
  // Along an axis the share is that of the side's own coordinate: it depends on the edge and the side
  // alone, so windows that share a side agree on it, wherever their corners are. A slanted side goes
  // on from the node before, which was rounded: so the chain never turns back, and two polygons that
  // share a slanted side agree to a spot, not to the bit.
  const bool vertical = from.at.x == to.at.x;
  const bool horizontal = from.at.y == to.at.y;
  double share = 0.0;
  if (vertical) {
    share =
        static_cast<double>(from.at.x - at(low).x) / static_cast<double>(at(high).x - at(low).x);
  } else if (horizontal) {
    share =
        static_cast<double>(from.at.y - at(low).y) / static_cast<double>(at(high).y - at(low).y);
  } else {
    const auto from_low = static_cast<double>(side(v, target, at(low)));
    const auto from_high = static_cast<double>(side(v, target, at(high)));
    share = from_low / (from_low - from_high);
  }
  const auto between = [&](std::int64_t p, std::int64_t q) {
    return p + std::llround(share * static_cast<double>(q - p));
  };
  node.at.x = vertical ? from.at.x : between(at(low).x, at(high).x);
  node.at.y = horizontal ? from.at.y : between(at(low).y, at(high).y);
  for (std::size_t i = 0; i < 3; ++i) {
    node.map[i] = nodes[low].map[i] + share * (nodes[high].map[i] - nodes[low].map[i]);
  }
  if (vertical) node.map[0] = from.map.x;
  if (horizontal) node.map[1] = from.map.y;
  node.has_height = nodes[low].has_height && nodes[high].has_height;
  return node;
}

std::uint32_t CutMesh::entry_of(const BorderSegment& segment) {
  const Spot p = segment.from.at;
  const Spot q = segment.to.at;
  const auto way = [&](Spot x) { return dot(p, q, x); };
  std::uint32_t entry = kNone;
  Int128 nearest = way(q) + 1;
  for (TriangleId t = 0; t < triangles.size(); ++t) {
    for (int i = 0; i < 3; ++i) {
      if (triangles[t].n[i] != kNone) continue;
      const std::uint32_t a = triangles[t].v[next_corner(i)];
      const std::uint32_t b = triangles[t].v[previous_corner(i)];
      const Int128 side_a = side(p, q, at(a));
      const Int128 side_b = side(p, q, at(b));
      if (side_a == 0 && way(at(a)) > 0 && way(at(a)) < nearest) {
        nearest = way(at(a));
        entry = a;
      }
      if (side_a > 0 && side_b < 0 && side(at(a), at(b), p) < 0 && side(at(a), at(b), q) > 0) {
        return cross_edge(t, i, p, q, segment);
      }
    }
  }
  return entry;
}

}  // namespace ptin::tools
