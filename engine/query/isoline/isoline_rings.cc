// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/query/isoline/isoline_rings.h"

#include <algorithm>
#include <numeric>

#include "engine/check.h"
#include "engine/error.h"
#include "engine/mesh/link.h"

namespace ptin {

namespace {
constexpr std::uint64_t kTriangleBytes = 12 + 4 + 1 + 3 * 16;  // neighbours, pieces, sides to sort
constexpr std::uint64_t kPieceBytes = 4 + 1;
/// A line through a triangle gives a point to the polygon above it and one to the polygon below it.
/// Each of the two is held as found (24 bytes), in its polygon (2 x 16), and as whoever writes it
/// needs it (40).
constexpr std::uint64_t kLineBytes = 2 * (24 + 2 * 16 + 40);
}  // namespace

BandMesh::BandMesh(const SurfaceArrays& surface, std::span<const double> levels,
                   const QueryContext& context)
    : surface_(surface), levels_(levels), context_(context) {
  bands_.reserve(surface.vertices.size());
  for (const auto& v : surface.vertices) {
    bands_.push_back(static_cast<std::uint32_t>(
        std::upper_bound(levels.begin(), levels.end(), v[2]) - levels.begin()));
  }
  std::uint64_t pieces = 0;
  for (TriangleId t = 0; t < surface.triangles.size(); ++t) {
    pieces += high(t) - low(t) + 1;
  }
  context.admit(surface.vertices.size() * 28 + surface.triangles.size() * (12 + kTriangleBytes) +
                pieces * kPieceBytes + (pieces - surface.triangles.size()) * kLineBytes);
  if (pieces >= kNone) {
    throw Error(ErrorCode::resource_exhausted,
                "the levels cut the surface into more parts than 32 bits number: ask for fewer "
                "levels, a window or a larger error",
                context.file());
  }
  find_neighbours(context);
  first_piece_.reserve(surface.triangles.size());
  std::uint32_t next = 0;
  for (TriangleId t = 0; t < surface.triangles.size(); ++t) {
    first_piece_.push_back(next);
    next += high(t) - low(t) + 1;
  }
  parent_.resize(next);
  visited_.resize(next);
  border_visited_.resize(surface.triangles.size());
  std::iota(parent_.begin(), parent_.end(), 0U);
  join_components();
}

std::uint32_t BandMesh::low(TriangleId t) const noexcept {
  const auto& v = surface_.triangles[t];
  return std::min({bands_[v[0]], bands_[v[1]], bands_[v[2]]});
}

std::uint32_t BandMesh::high(TriangleId t) const noexcept {
  const auto& v = surface_.triangles[t];
  return std::max({bands_[v[0]], bands_[v[1]], bands_[v[2]]});
}

void BandMesh::find_neighbours(const QueryContext& context) {
  std::vector<TriangleSide> sides = sides_of(surface_.triangles.size(), [&](TriangleId t, int i) {
    return surface_.triangles[t][static_cast<std::size_t>(i)];
  });
  context.check_stop();
  neighbours_.assign(surface_.triangles.size(), {kNone, kNone, kNone});
  join_sides(sides, [&](const TriangleSide& a, const TriangleSide& b) {
    neighbours_[a.triangle][a.place] = b.triangle;
    neighbours_[b.triangle][b.place] = a.triangle;
  });
}

std::uint32_t BandMesh::component(std::uint32_t piece) noexcept {
  while (parent_[piece] != piece) {
    parent_[piece] = parent_[parent_[piece]];
    piece = parent_[piece];
  }
  return piece;
}

/// Joins the pieces of neighbouring triangles into components: in each band of which the common
/// edge holds more than a point, and in the band below the edge where the edge is a ridge.
void BandMesh::join_components() {
  const auto join = [&](std::uint32_t a, std::uint32_t b) {
    a = component(a), b = component(b);
    parent_[std::max(a, b)] = std::min(a, b);
  };
  for (TriangleId t = 0; t < surface_.triangles.size(); ++t) {
    for (int i = 0; i < 3; ++i) {
      const TriangleId n = neighbours_[t][static_cast<std::size_t>(i)];
      if (n == kNone || n < t) {
        continue;
      }
      const auto& v = surface_.triangles[t];
      VertexId lower = v[next_corner(i)];
      VertexId upper = v[previous_corner(i)];
      if (bands_[lower] > bands_[upper]) {
        std::swap(lower, upper);
      }
      std::uint32_t end = bands_[upper] + 1;
      if (bands_[lower] < bands_[upper] && is_at(upper, bands_[upper] - 1)) {
        --end;
      }
      for (std::uint32_t band = bands_[lower]; band < end; ++band) {
        join(piece(t, band), piece(n, band));
      }
      if (bands_[upper] > 0 && beyond_ridge(t, bands_[upper] - 1) == n) {
        join(piece(t, bands_[upper] - 1), piece(n, bands_[upper] - 1));
      }
    }
  }
}

/// The triangle across the side of `t` that is a ridge exactly at `level`, lower on both sides;
/// kNone when there is none.
TriangleId BandMesh::beyond_ridge(TriangleId t, std::uint32_t level) const noexcept {
  for (int i = 0; i < 3; ++i) {
    const auto& v = surface_.triangles[t];
    const TriangleId n = neighbours_[t][static_cast<std::size_t>(i)];
    if (n != kNone && bands_[v[i]] <= level && is_at(v[next_corner(i)], level) &&
        is_at(v[previous_corner(i)], level) && low(n) <= level) {
      return n;
    }
  }
  return kNone;
}

/// True when all that `t` has at `level` or above is one corner exactly at it.
bool BandMesh::is_point(TriangleId t, std::uint32_t level) const noexcept {
  const auto& v = surface_.triangles[t];
  int above = 0;
  bool exact = true;
  for (const VertexId corner : v) {
    above += bands_[corner] > level ? 1 : 0;
    exact = exact && (bands_[corner] <= level || is_at(corner, level));
  }
  return above == 1 && exact;
}

RingPoint BandMesh::cut(TriangleId t, int side, std::uint32_t level) const noexcept {
  const auto& v = surface_.triangles[t];
  VertexId below = v[next_corner(side)];
  VertexId above = v[previous_corner(side)];
  if (bands_[below] > level) {
    std::swap(below, above);
  }
  const auto& b = surface_.vertices[below];
  const auto& a = surface_.vertices[above];
  return {cut_of({b[0], b[1], b[2]}, {a[0], a[1], a[2]}, levels_[level]),
          a[2] == levels_[level] ? above : kNone};
}

/// The side through which the line at `level` enters or leaves a triangle.
int BandMesh::line_side(TriangleId t, std::uint32_t level, bool entry) const noexcept {
  const auto& v = surface_.triangles[t];
  const bool above[3] = {bands_[v[0]] > level, bands_[v[1]] > level, bands_[v[2]] > level};
  return entry ? entry_side(above) : exit_side(above);
}

/// What a ring walks along after vertex `v` of `t`, which lies in the band. Turns clockwise around
/// `v`, beginning with `t`, until it comes to the border side that leaves `v`, or to the lower
/// border of the band where `v` lies exactly on it.
/// @param arrived  The ring came through `t`, whose line is therefore not taken again.
BandMesh::Element BandMesh::around(TriangleId t, VertexId v, std::uint32_t band,
                                   bool arrived) const {
  const bool exact = band > 0 && is_at(v, band - 1);
  for (;; arrived = false) {
    if (exact && !arrived && low(t) < band) {
      return {Kind::kBackward, t, 0};
    }
    const auto& corners = surface_.triangles[t];
    const int corner = corners[0] == v ? 0 : (corners[1] == v ? 1 : 2);
    const int leaving = previous_corner(corner);
    const TriangleId n = neighbours_[t][static_cast<std::size_t>(leaving)];
    if (n == kNone) {
      return {Kind::kBorder, t, leaving};
    }
    t = n;
  }
}

/// Goes on along border side `side` of `t`, from a point on it: to the end of the side and round
/// that vertex, or to where a line leaves the side. Adds the point there.
BandMesh::Element BandMesh::along_border(TriangleId t, int side, std::uint32_t band,
                                         std::vector<RingPoint>& ring) const {
  const VertexId end = surface_.triangles[t][previous_corner(side)];
  if (bands_[end] > band) {
    ring.push_back(cut(t, side, band));
    return over_ridges(t, band, ring);
  }
  if (bands_[end] < band) {
    ring.push_back(cut(t, side, band - 1));
    return {Kind::kBackward, t, 0};
  }
  const auto& p = surface_.vertices[end];
  ring.push_back({{p[0], p[1]}, end});
  return around(t, end, band, false);
}

/// Goes on along the upper border of the band, through `t`. Where that border is a ridge, which
/// does not divide the band, it goes on from the same point on the other side of the ridge.
BandMesh::Element BandMesh::over_ridges(TriangleId t, std::uint32_t band,
                                        std::vector<RingPoint>& ring) const {
  for (;;) {
    const TriangleId beyond = beyond_ridge(t, band);
    if (beyond == kNone) {
      return {Kind::kForward, t, 0};
    }
    const int side = line_side(beyond, band, false);
    t = neighbours_[beyond][static_cast<std::size_t>(side)];
    if (t == kNone) {
      return along_border(beyond, side, band, ring);
    }
  }
}

/// Walks along `e`, adds the point at its end, and returns what comes next.
BandMesh::Element BandMesh::walk(const Element& e, std::uint32_t band,
                                 std::vector<RingPoint>& ring) {
  if (e.kind == Kind::kBorder) {
    return along_border(e.t, e.side, band, ring);
  }
  const bool forward = e.kind == Kind::kForward;
  const std::uint32_t level = forward ? band : band - 1;
  const int side = line_side(e.t, level, !forward);
  ring.push_back(cut(e.t, side, level));
  if (!forward && ring.back().vertex != kNone) {
    return around(e.t, ring.back().vertex, band, true);
  }
  const TriangleId n = neighbours_[e.t][static_cast<std::size_t>(side)];
  if (n == kNone) {
    return along_border(e.t, side, band, ring);
  }
  return forward ? over_ridges(n, band, ring) : Element{e.kind, n, 0};
}

std::uint8_t& BandMesh::visited(const Element& e, std::uint32_t band) noexcept {
  return e.kind == Kind::kBorder ? border_visited_[e.t] : visited_[piece(e.t, band)];
}

void BandMesh::visit_from(const Element& start, std::uint32_t band, const Visitor& visitor) {
  const auto bit = [](const Element& e) {
    return static_cast<std::uint8_t>(e.kind == Kind::kBorder ? 1U << e.side
                                                             : 1U << static_cast<unsigned>(e.kind));
  };
  if ((visited(start, band) & bit(start)) != 0) {
    return;
  }
  ring_.clear();
  Element e = start;
  do {
    visited(e, band) |= bit(e);
    e = walk(e, band, ring_);
    PTIN_CHECK(ring_.size() <= 2 * parent_.size() + 3 * border_visited_.size());  // each step once
  } while (e != start);
  visitor(band, component(piece(start.t, band)), ring_);
}

void BandMesh::visit_rings(const Visitor& visitor) {
  for (TriangleId t = 0; t < surface_.triangles.size(); ++t) {
    if (t % kStopInterval == 0) {
      context_.check_stop();
    }
    for (std::uint32_t level = low(t); level < high(t); ++level) {
      if (beyond_ridge(t, level) == kNone) {
        visit_from({Kind::kForward, t, 0}, level, visitor);
      }
      if (!is_point(t, level)) {
        visit_from({Kind::kBackward, t, 0}, level + 1, visitor);
      }
    }
  }
  // Then the rings that no line meets: borders of the surface that lie in one band as a whole. A
  // side that falls from a vertex exactly at a level has only that point in the vertex's band.
  for (TriangleId t = 0; t < surface_.triangles.size(); ++t) {
    for (int side = 0; side < 3; ++side) {
      const std::uint32_t band = bands_[surface_.triangles[t][next_corner(side)]];
      const std::uint32_t end = bands_[surface_.triangles[t][previous_corner(side)]];
      if (neighbours_[t][static_cast<std::size_t>(side)] == kNone && band == end) {
        visit_from({Kind::kBorder, t, side}, band, visitor);
      }
    }
  }
}

}  // namespace ptin
