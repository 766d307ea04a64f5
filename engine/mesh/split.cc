// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/mesh/split.h"

#include "engine/geometry/orient.h"

namespace ptin {

namespace {

// Place (0, 1 or 2) of an id in the corners or neighbours of a triangle. Without branches, since
// the place cannot be predicted. REQUIRES: one of the three is `id`.
int place_of(const std::uint32_t (&ids)[3], std::uint32_t id) noexcept {
  return static_cast<int>(ids[1] == id) + 2 * static_cast<int>(ids[2] == id);
}
constexpr std::uint8_t kNext[3] = {1, 2, 0};
constexpr std::uint8_t kPrevious[3] = {2, 0, 1};

constexpr Triangle kRemoved{{kNone, kNone, kNone}, {kNone, kNone, kNone}};

/// The fan of a split: triangles of w from vl counter-clockwise round to vr.
struct Fan {
  TriangleId first = kNone, last = kNone;
  TriangleId outer_left = kNone, outer_right = kNone;  ///< Beyond the edges (w, vl) and (vr, w).
  VertexId vl = kNone, vr = kNone;
  bool holds_triangle_of_w = false;
  bool fits = false;
};

bool turns_left(const Tin& tin, VertexId a, VertexId b, VertexId c) {
  return orient(tin.position(a), tin.position(b), tin.position(c)) > 0;
}

/// What lies around corner w of a triangle. All six numbers are loaded at once and the right ones
/// selected, so that a walk waits for one load a triangle and for no branch.
struct Around {
  VertexId next, previous;  ///< The other corners, counter-clockwise.
  TriangleId turn;          ///< The next triangle around w, counter-clockwise.
};
Around around(const Triangle& t, VertexId w) noexcept {
  const std::uint32_t m1 = 0U - static_cast<std::uint32_t>(t.v[1] == w);
  const std::uint32_t m2 = 0U - static_cast<std::uint32_t>(t.v[2] == w);
  const std::uint32_t m0 = ~(m1 | m2);
  const auto select = [=](std::uint32_t if_0, std::uint32_t if_1, std::uint32_t if_2) {
    return (if_0 & m0) | (if_1 & m1) | (if_2 & m2);
  };
  return {select(t.v[1], t.v[2], t.v[0]), select(t.v[2], t.v[0], t.v[1]),
          select(t.n[1], t.n[2], t.n[0])};
}

/// How a split names vl and vr: by their ids, or by their keys.
struct EndIds {
  VertexId vl, vr;
  [[nodiscard]] bool is_vl(const Vertex* /*all*/, VertexId v) const noexcept { return v == vl; }
  [[nodiscard]] bool is_vr(const Vertex* /*all*/, VertexId v) const noexcept { return v == vr; }
};
struct EndKeys {
  VertexKey vl, vr;
  [[nodiscard]] bool is_vl(const Vertex* all, VertexId v) const noexcept {
    return key_of(all[v].position) == vl;
  }
  [[nodiscard]] bool is_vr(const Vertex* all, VertexId v) const noexcept {
    return key_of(all[v].position) == vr;
  }
};

/// Finds the first triangle of w whose next corner is vl, and vl.
template <class Ends>
void find_first(const Tin& tin, VertexId w, const Ends& ends, Fan& fan) {
  const Triangle* const triangles = tin.triangles.data();
  const Vertex* const vertices = tin.vertices.data();
  const TriangleId start = vertices[w].triangle;
  TriangleId t = start;
  do {
    const Around here = around(triangles[t], w);
    if (ends.is_vl(vertices, here.next)) {
      fan.first = t;
      fan.vl = here.next;
      return;
    }
    t = here.turn;
  } while (t != kNone && t != start);
}

/// Puts `now` in the place of `was` from triangle `t` counter-clockwise up to and with `last`.
void replace_corner(Tin& tin, TriangleId t, TriangleId last, VertexId was, VertexId now) {
  while (true) {
    Triangle& triangle = tin.triangles[t];
    const int c = place_of(triangle.v, was);
    triangle.v[c] = now;
    if (t == last) {
      return;
    }
    t = triangle.n[kNext[c]];
  }
}

/// Walks the fan and puts u in w's place, as long as each triangle stays counter-clockwise. Where
/// the fan does not fit, the triangles from `first` to `last` have been changed already, and the
/// caller changes them back.
template <class Ends>
Fan move_fan(Tin& tin, const SplitSite& site, const Ends& ends) {
  Fan fan;
  find_first(tin, site.w, ends, fan);
  if (fan.first == kNone) {
    return fan;
  }
  Triangle* const triangles = tin.triangles.data();
  const Vertex* const vertices = tin.vertices.data();
  const GridPoint u = vertices[site.u].position;
  const TriangleId known = vertices[site.w].triangle;
  fan.outer_left = triangles[fan.first].n[kPrevious[place_of(triangles[fan.first].v, site.w)]];
  GridPoint a = vertices[fan.vl].position;
  TriangleId t = fan.first;
  do {
    Triangle& triangle = triangles[t];
    const Around here = around(triangle, site.w);
    const GridPoint b = vertices[here.previous].position;
    if (orient(u, a, b) <= 0) {
      return fan;
    }
    a = b;
    triangle.v[place_of(triangle.v, site.w)] = site.u;
    fan.holds_triangle_of_w |= known == t;
    fan.last = t;
    t = here.turn;
    if (ends.is_vr(vertices, here.previous)) {
      fan.vr = here.previous;
      fan.outer_right = t;
      fan.fits = true;
      return fan;
    }
  } while (t != kNone && t != fan.first);
  return fan;
}

/// True when the sides of the split fit. A side that exists is a strictly counter-clockwise
/// triangle. A side that does not exist lies flat on the border.
bool sides_fit(const Tin& tin, const SplitSite& s, const Fan& fan) {
  const bool left = s.has_left
                        ? turns_left(tin, s.u, s.w, s.vl)
                        : fan.outer_left == kNone &&
                              orient(tin.position(s.vl), tin.position(s.u), tin.position(s.w)) == 0;
  const bool right =
      s.has_right ? turns_left(tin, s.u, s.vr, s.w)
                  : fan.outer_right == kNone &&
                        orient(tin.position(s.w), tin.position(s.u), tin.position(s.vr)) == 0;
  return left && right && (s.has_left || s.has_right);
}

void put(Tin& tin, TriangleId id, const Triangle& triangle, TriangleClass c) {
  tin.triangles[id] = triangle;
  tin.classes[id] = c;
}

template <class Ends>
bool split_between(Tin& tin, SplitSite& site, const Ends& ends, TriangleId left, TriangleId right) {
  const Fan fan = move_fan(tin, site, ends);
  site.vl = fan.vl;
  site.vr = fan.vr;
  if (!fan.fits || !sides_fit(tin, site, fan)) [[unlikely]] {
    if (fan.last != kNone) {
      replace_corner(tin, fan.first, fan.last, site.u, site.w);
    }
    return false;
  }
  left = site.has_left ? left : kNone;
  right = site.has_right ? right : kNone;
  if (site.has_left) {
    put(tin, left, {{site.u, site.w, site.vl}, {fan.outer_left, fan.first, right}},
        site.left_class);
    replace_neighbour(tin, fan.outer_left, fan.first, left);
  }
  Triangle& first = tin.triangles[fan.first];
  first.n[kPrevious[place_of(first.v, site.u)]] = left;
  if (site.has_right) {
    put(tin, right, {{site.u, site.vr, site.w}, {fan.outer_right, left, fan.last}},
        site.right_class);
    replace_neighbour(tin, fan.outer_right, fan.last, right);
  }
  Triangle& last = tin.triangles[fan.last];
  last.n[kNext[place_of(last.v, site.u)]] = right;

  tin.vertices[site.u].triangle = site.has_right ? fan.first : left;
  TriangleId& known = tin.vertices[site.w].triangle;
  known = fan.holds_triangle_of_w ? (site.has_left ? left : right) : known;
  if (site.has_right && fan.outer_right == kNone) {
    tin.vertices[site.vr].triangle = right;  // the border edge (vr, w) now begins there
  }
  return true;
}

}  // namespace

bool split_into(Tin& tin, SplitSite& site, const SplitEnds& ends, TriangleId left,
                TriangleId right) {
  return split_between(tin, site, EndKeys{ends.vl, ends.vr}, left, right);
}

SplitResult split(Tin& tin, const SplitSite& site) {
  const auto before = static_cast<TriangleId>(tin.triangles.size());
  const TriangleId right = before + (site.has_left ? 1 : 0);
  tin.triangles.resize(right + (site.has_right ? 1 : 0), kRemoved);
  tin.classes.resize(tin.triangles.size(), TriangleClass::kSurface);
  SplitSite found = site;
  if (!split_between(tin, found, EndIds{site.vl, site.vr}, before, right)) {
    tin.triangles.resize(before);
    tin.classes.resize(before);
    return {};
  }
  return {site.has_left ? before : kNone, site.has_right ? right : kNone, true};
}

}  // namespace ptin
