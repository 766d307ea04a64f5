// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/mesh/collapse.h"

#include "engine/geometry/orient.h"

namespace ptin {

namespace {

/// The fan of a collapse into link[j] has the edges (link[i], link[i + 1]) for i in [first, first +
/// count), modulo degree.
struct FanRange {
  std::size_t first;
  std::size_t count;
};

FanRange fan_range(const Star& star, std::size_t j) noexcept {
  const std::size_t triangles = star.triangles.size();
  if (star.closed) {
    return {star.after(j), triangles - 2};
  }
  return {j == 0 ? std::size_t{1} : std::size_t{0}, triangles - 1};
}

void remove_triangle(Tin& tin, TriangleId t) {
  Triangle& triangle = tin.triangles[t];
  triangle.v[0] = triangle.v[1] = triangle.v[2] = kNone;
  triangle.n[0] = triangle.n[1] = triangle.n[2] = kNone;
}

/// Makes `kept` and the triangle across the edge of `gone` opposite to the centre neighbours of
/// each other.
void bridge(Tin& tin, VertexId center, TriangleId gone, TriangleId kept) {
  const Triangle& triangle = tin.triangles[gone];
  const TriangleId outer = triangle.n[corner_of(triangle, center)];
  replace_neighbour(tin, kept, gone, outer);
  replace_neighbour(tin, outer, gone, kept);
}

void repoint(Tin& tin, VertexId v, TriangleId was, TriangleId now) {
  if (tin.vertices[v].triangle == was) {
    tin.vertices[v].triangle = now;
  }
}

}  // namespace

bool can_collapse(const Tin& tin, const Star& star, std::size_t j) noexcept {
  const std::size_t degree = star.degree();
  if (!star.closed) {
    if ((j != 0 && j + 1 != degree) || star.triangles.size() < 2) {
      return false;
    }
    if (orient(tin.position(star.link.back()), tin.position(star.center),
               tin.position(star.link.front())) != 0) {
      return false;
    }
  }
  const GridPoint w = tin.position(star.link[j]);
  const FanRange fan = fan_range(star, j);
  std::size_t i = fan.first;
  for (std::size_t n = 0; n < fan.count; ++n) {
    const std::size_t k = i + 1 == degree ? 0 : i + 1;
    if (orient(w, tin.position(star.link[i]), tin.position(star.link[k])) <= 0) {
      return false;
    }
    i = k;
  }
  return true;
}

CollapseSite collapse_site(const Star& star, std::size_t j) noexcept {
  CollapseSite site{star.center, star.link[j], kNone, kNone, kNone, kNone};
  if (star.closed) {
    site.left = star.triangles[j];
    site.right = star.triangles[star.before(j)];
    site.vl = star.link[star.after(j)];
    site.vr = star.link[star.before(j)];
  } else if (j == 0) {
    site.left = star.triangles.front();
    site.vl = star.link[1];
    site.vr = star.link.back();
  } else {
    site.right = star.triangles.back();
    site.vl = star.link.front();
    site.vr = star.link[star.link.size() - 2];
  }
  return site;
}

CollapseSite collapse(Tin& tin, const Star& star, std::size_t j) {
  const CollapseSite site = collapse_site(star, j);
  const FanRange fan = fan_range(star, j);
  const std::size_t triangles = star.triangles.size();
  const TriangleId first = star.triangles[fan.first];
  const TriangleId last = star.triangles[(fan.first + fan.count - 1) % triangles];

  if (site.left != kNone) {
    bridge(tin, site.u, site.left, first);
    repoint(tin, site.vl, site.left, first);
    repoint(tin, site.w, site.left, first);
  }
  if (site.right != kNone) {
    bridge(tin, site.u, site.right, last);
    repoint(tin, site.vr, site.right, last);
    repoint(tin, site.w, site.right, first);
  }
  std::size_t i = fan.first;
  for (std::size_t n = 0; n < fan.count; ++n, i = star.after(i)) {
    Triangle& triangle = tin.triangles[star.triangles[i]];
    triangle.v[corner_of(triangle, site.u)] = site.w;
  }
  if (site.left != kNone) {
    remove_triangle(tin, site.left);
  }
  if (site.right != kNone) {
    remove_triangle(tin, site.right);
  }
  tin.vertices[site.u].triangle = kNone;
  return site;
}

}  // namespace ptin
