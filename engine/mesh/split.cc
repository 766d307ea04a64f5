// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/mesh/split.h"

#include "engine/geometry/orient.h"

namespace ptin {

namespace {

/// The fan of a split: triangles of w from vl counter-clockwise round to vr.
struct Fan {
  TriangleId first = kNone, last = kNone;
  TriangleId outer_left = kNone, outer_right = kNone;  ///< Beyond the edges (w, vl) and (vr, w).
  bool holds_triangle_of_w = false;
  bool found = false;
};

bool turns_left(const Tin& tin, VertexId a, VertexId b, VertexId c) {
  return orient(tin.position(a), tin.position(b), tin.position(c)) > 0;
}

/// First triangle of w whose next corner is `vl`, or kNone.
TriangleId find_first(const Tin& tin, VertexId w, VertexId vl) {
  const TriangleId start = tin.vertices[w].triangle;
  TriangleId t = start;
  do {
    const Triangle& triangle = tin.triangles[t];
    const int c = corner_of(triangle, w);
    if (triangle.v[next_corner(c)] == vl) {
      return t;
    }
    t = triangle.n[next_corner(c)];
  } while (t != kNone && t != start);
  return kNone;
}

/// Walks the fan and checks that it stays valid with u in w's place.
Fan find_fan(const Tin& tin, const SplitSite& site) {
  Fan fan;
  fan.first = find_first(tin, site.w, site.vl);
  if (fan.first == kNone) {
    return fan;
  }
  {
    const Triangle& triangle = tin.triangles[fan.first];
    fan.outer_left = triangle.n[previous_corner(corner_of(triangle, site.w))];
  }
  TriangleId t = fan.first;
  do {
    const Triangle& triangle = tin.triangles[t];
    const int c = corner_of(triangle, site.w);
    const VertexId a = triangle.v[next_corner(c)];
    const VertexId b = triangle.v[previous_corner(c)];
    if (!turns_left(tin, site.u, a, b)) {
      return fan;
    }
    fan.holds_triangle_of_w |= tin.vertices[site.w].triangle == t;
    fan.last = t;
    t = triangle.n[next_corner(c)];
    if (b == site.vr) {
      fan.outer_right = t;
      fan.found = true;
      return fan;
    }
  } while (t != kNone && t != fan.first);
  return fan;
}

/// The sides of the split: new triangles strictly counter-clockwise, missing ones flat and on the border.
bool sides_fit(const Tin& tin, const SplitSite& s, const Fan& fan) {
  const bool left = s.has_left ? turns_left(tin, s.u, s.w, s.vl)
                               : fan.outer_left == kNone && orient(tin.position(s.vl), tin.position(s.u),
                                                                   tin.position(s.w)) == 0;
  const bool right = s.has_right ? turns_left(tin, s.u, s.vr, s.w)
                                 : fan.outer_right == kNone && orient(tin.position(s.w), tin.position(s.u),
                                                                      tin.position(s.vr)) == 0;
  return left && right && (s.has_left || s.has_right);
}

TriangleId append(Tin& tin, const Triangle& triangle, TriangleClass c) {
  const auto id = static_cast<TriangleId>(tin.triangles.size());
  tin.triangles.push_back(triangle);
  tin.classes.push_back(c);
  return id;
}

void replace_neighbour(Tin& tin, TriangleId t, TriangleId was, TriangleId now) {
  if (t != kNone) {
    Triangle& triangle = tin.triangles[t];
    triangle.n[side_of(triangle, was)] = now;
  }
}

/// Puts u in w's place in every triangle of the fan.
void move_fan(Tin& tin, const SplitSite& site, const Fan& fan) {
  TriangleId t = fan.first;
  while (true) {
    Triangle& triangle = tin.triangles[t];
    const int c = corner_of(triangle, site.w);
    triangle.v[c] = site.u;
    if (t == fan.last) {
      return;
    }
    t = triangle.n[next_corner(c)];
  }
}

}  // namespace

SplitResult split(Tin& tin, const SplitSite& site) {
  const Fan fan = find_fan(tin, site);
  if (!fan.found || !sides_fit(tin, site, fan)) {
    return {};
  }
  move_fan(tin, site, fan);
  SplitResult result;
  result.applied = true;
  if (site.has_left) {
    result.left = append(
        tin, {{site.u, site.w, site.vl}, {fan.outer_left, fan.first, kNone}}, site.left_class);
    replace_neighbour(tin, fan.outer_left, fan.first, result.left);
  }
  Triangle& first = tin.triangles[fan.first];
  first.n[previous_corner(corner_of(first, site.u))] = result.left;
  if (site.has_right) {
    result.right = append(
        tin, {{site.u, site.vr, site.w}, {fan.outer_right, result.left, fan.last}}, site.right_class);
    replace_neighbour(tin, fan.outer_right, fan.last, result.right);
  }
  if (result.left != kNone) {
    tin.triangles[result.left].n[2] = result.right;
  }
  Triangle& last = tin.triangles[fan.last];
  last.n[next_corner(corner_of(last, site.u))] = result.right;

  tin.vertices[site.u].triangle = site.has_right ? fan.first : result.left;
  if (fan.holds_triangle_of_w) {
    tin.vertices[site.w].triangle = site.has_left ? result.left : result.right;
  }
  if (site.has_right && fan.outer_right == kNone) {
    tin.vertices[site.vr].triangle = result.right;  // the border edge (vr, w) now begins there
  }
  return result;
}

}  // namespace ptin
