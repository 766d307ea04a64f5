// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/mesh/split.h"

#include <cstdint>

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

/// From u to a vertex.
struct Offset {
  std::int64_t x = 0, y = 0;
};
Offset offset(GridPoint u, GridPoint p) noexcept {
  return {std::int64_t{p.x} - u.x, std::int64_t{p.y} - u.y};
}
/// orient(u, u + a, u + b): a vertex of a fan is subtracted from u once, not for each triangle.
std::int64_t turn(const Offset& a, const Offset& b) noexcept { return a.x * b.y - a.y * b.x; }

/// The fan of a split: triangles of w from vl counter-clockwise round to vr.
struct Fan {
  TriangleId first = kNone, last = kNone;
  int place_in_first = 0, place_in_last = 0;           ///< Of the corner behind w.
  TriangleId outer_left = kNone, outer_right = kNone;  ///< Beyond the edges (w, vl) and (vr, w).
  VertexId vl = kNone, vr = kNone;
  Offset to_vl, to_vr;
  bool holds_triangle_of_w = false;
  bool fits = false;
};

/// A triangle of w on a counter-clockwise walk, which has come by its edge (w, next). From the place
/// of one corner the rest follows: half the instructions of selecting each by where w is.
struct Step {
  int place;          ///< Of corner `next`.
  VertexId previous;  ///< The third corner.
  TriangleId turn;    ///< The next triangle around w, beyond the edge (w, previous).
};
Step step(const Triangle& t, VertexId w, VertexId next) noexcept {
  const int place = place_of(t.v, next);
  return {place, t.v[0] ^ t.v[1] ^ t.v[2] ^ w ^ next, t.n[place]};
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
[[gnu::always_inline]] inline void find_first(const Tin& tin, VertexId w, const Ends& ends,
                                              Fan& fan) {
  const Triangle* const triangles = tin.triangles.data();
  const Vertex* const vertices = tin.vertices.data();
  const TriangleId start = vertices[w].triangle;
  TriangleId t = start;
  VertexId next = triangles[t].v[kNext[place_of(triangles[t].v, w)]];
  do {
    if (ends.is_vl(vertices, next)) {
      fan.first = t;
      fan.vl = next;
      return;
    }
    const Step here = step(triangles[t], w, next);
    next = here.previous;
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
[[gnu::always_inline]] inline Fan move_fan(Tin& tin, const SplitSite& site, const Ends& ends) {
  Fan fan;
  find_first(tin, site.w, ends, fan);
  if (fan.first == kNone) {
    return fan;
  }
  Triangle* const triangles = tin.triangles.data();
  const Vertex* const vertices = tin.vertices.data();
  const GridPoint u = vertices[site.u].position;
  const TriangleId known = vertices[site.w].triangle;
  Step here = step(triangles[fan.first], site.w, fan.vl);
  fan.place_in_first = here.place;
  fan.outer_left = triangles[fan.first].n[kNext[here.place]];
  fan.to_vl = offset(u, vertices[fan.vl].position);
  Offset to_next = fan.to_vl;
  TriangleId t = fan.first;
  while (true) {
    const VertexId previous = here.previous;
    const Offset to_previous = offset(u, vertices[previous].position);
    if (turn(to_next, to_previous) <= 0) {
      return fan;
    }
    triangles[t].v[kPrevious[here.place]] = site.u;
    fan.holds_triangle_of_w |= known == t;
    fan.last = t;
    fan.place_in_last = here.place;
    to_next = to_previous;
    t = here.turn;
    if (ends.is_vr(vertices, previous)) {
      fan.vr = previous;
      fan.to_vr = to_previous;
      fan.outer_right = t;
      fan.fits = true;
      return fan;
    }
    if (t == kNone || t == fan.first) {
      return fan;
    }
    here = step(triangles[t], site.w, previous);
  }
}

// Inlined, as the functions before it: a Fan that is handed over by its address lies in memory, and
// the walk waits for it.
/// True when the sides of the split fit. A side that exists is a strictly counter-clockwise
/// triangle. A side that does not exist lies flat on the border.
[[gnu::always_inline]] inline bool sides_fit(const Tin& tin, const SplitSite& s, const Fan& fan) {
  const Offset to_w = offset(tin.position(s.u), tin.position(s.w));
  const std::int64_t left = turn(to_w, fan.to_vl);
  const std::int64_t right = turn(fan.to_vr, to_w);
  return (s.has_left ? left > 0 : left == 0 && fan.outer_left == kNone) &&
         (s.has_right ? right > 0 : right == 0 && fan.outer_right == kNone) &&
         (s.has_left || s.has_right);
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
  tin.triangles[fan.first].n[kNext[fan.place_in_first]] = left;
  if (site.has_right) {
    put(tin, right, {{site.u, site.vr, site.w}, {fan.outer_right, left, fan.last}},
        site.right_class);
    replace_neighbour(tin, fan.outer_right, fan.last, right);
  }
  tin.triangles[fan.last].n[fan.place_in_last] = right;

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
