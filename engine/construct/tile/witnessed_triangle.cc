// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/tile/witnessed_triangle.h"

#include <algorithm>
#include <cstdint>

#include "engine/geometry/infinity.h"
#include "engine/geometry/orient.h"

namespace ptin {

WitnessedTriangle witnessed_triangle(const PartOfTerrain& part, const BorderWitnesses& witnesses,
                                     TriangleId t) {
  const Tin& tin = part.tin;
  const Triangle& triangle = tin.triangles[t];
  WitnessedTriangle w;
  double deepest = -1.0;
  for (int i = 0; i < 3; ++i) {
    const VertexId v = triangle.v[i];
    w.corners[i] = tin.position(v);
    w.nearest[i] = witnesses.nearest[v];
    const TriangleId beyond = triangle.n[i];
    w.is_known_side[i] = beyond != kNone && tin.classes[beyond] != tin.classes[t];
    w.is_border_side[i] =
        w.is_known_side[i] ||
        (beyond == kNone && part.goes_on(tin.position(triangle.v[next_corner(i)]),
                                         tin.position(triangle.v[previous_corner(i)])));
    if (witnesses.kind[v] != BorderWitnesses::Kind::kInner) {
      continue;
    }
    const double depth = w.nearest[i] == BorderWitnesses::kNoBorder
                             ? kInfinity
                             : distance(w.corners[i], w.nearest[i], part.step);
    if (depth > deepest ||
        (depth == deepest && key_of(w.corners[i]) < key_of(w.corners[w.witness]))) {
      deepest = depth;
      w.witness = i;
    }
  }
  const std::size_t other = tin.classes[t] == TriangleClass::kSurface ? 1 : 0;
  for (int i = 0; i < 3; ++i) {
    const VertexId a = triangle.v[i], b = triangle.v[next_corner(i)];
    const std::uint32_t of_a = witnesses.region[a][other], of_b = witnesses.region[b][other];
    if (of_a != kNone && of_b != kNone && of_a != of_b) {
      w.gap = std::max(w.gap, distance(witnesses.nearest[a], witnesses.nearest[b], part.step));
    }
    w.gap = std::max(w.gap, static_cast<double>(witnesses.doubt[a]));
  }
  if (w.witness != WitnessedTriangle::kCornerWitness && !witnesses.reach.empty()) {
    w.reach = witnesses.reach[triangle.v[w.witness]];
  }
  return w;
}

/// The distance to a point or an edge is convex, so greatest at a corner.
double greatest_depth(const WitnessedTriangle& t, std::span<const GroundPlace> piece,
                      GroundStep step) {
  double least = kInfinity;
  for (int i = 0; i < 3; ++i) {
    if (t.nearest[i] != BorderWitnesses::kNoBorder) {
      double most = 0.0;
      for (const GroundPlace p : piece) {
        most = std::max(most, distance(p, place_of(t.nearest[i]), step));
      }
      least = std::min(least, most);
    }
    if (t.is_known_side[i]) {
      double most = 0.0;
      for (const GroundPlace p : piece) {
        most = std::max(most, distance_bound(p, place_of(t.corners[(i + 1) % 3]),
                                             place_of(t.corners[(i + 2) % 3]), step));
      }
      least = std::min(least, most);
    }
  }
  return least;
}

namespace {

/// What an edge cuts off a triangle.
struct CutOff {
  std::array<GroundPlace, 8> piece;  ///< The corners of the piece, in no order.
  std::size_t corners = 0;
  std::array<GroundPlace, 2> cut{};  ///< The ends of the edge's part within the triangle.
  std::size_t ends = 0;
};

/// @param side     For each corner: its side of the edge, as a sign.
/// @param witness  The side of the witness; 0: it is on the edge, and all of the triangle counts.
CutOff cut_off(const WitnessedTriangle& t, const std::array<std::int64_t, 3>& side, int witness) {
  CutOff result;
  for (int i = 0; i < 3; ++i) {
    const int sign = side[i] > 0 ? 1 : (side[i] < 0 ? -1 : 0);
    if (sign == 0 && result.ends < 2) {
      result.cut[result.ends++] = place_of(t.corners[i]);
    }
    if (sign == 0 || sign != witness) {
      result.piece[result.corners++] = place_of(t.corners[i]);
    }
    const int k = (i + 1) % 3;
    if ((side[i] > 0 && side[k] < 0) || (side[i] < 0 && side[k] > 0)) {
      const double f = static_cast<double>(side[i]) /
                       (static_cast<double>(side[i]) - static_cast<double>(side[k]));
      const GroundPlace a = place_of(t.corners[i]), b = place_of(t.corners[k]);
      const GroundPlace at{a.x + (b.x - a.x) * f, a.y + (b.y - a.y) * f};
      result.piece[result.corners++] = at;
      if (result.ends < 2) {
        result.cut[result.ends++] = at;
      }
    }
  }
  return result;
}

}  // namespace

double border_crossing(const WitnessedTriangle& t, GridPoint a, GridPoint b,
                       GroundStep step) noexcept {
  std::array<std::int64_t, 3> side{};
  for (int i = 0; i < 3; ++i) {
    side[i] = orient(a, b, t.corners[i]);
  }
  std::int64_t of_witness = 0;
  if (t.witness == WitnessedTriangle::kCornerWitness) {
    const WayIn way = way_into(t.corners);
    of_witness = orient_towards(a, b, t.corners[way.corner], way.direction);
  } else {
    of_witness = side[t.witness];
    if (of_witness == 0) {
      return t.reach;
    }
  }
  const int sign = of_witness > 0 ? 1 : (of_witness < 0 ? -1 : 0);
  const CutOff off = cut_off(t, side, sign);
  double moved = std::max(t.gap, greatest_depth(t, {off.piece.data(), off.corners}, step));
  for (int i = 0; i < 3; ++i) {
    if (!t.is_border_side[i]) {
      continue;
    }
    for (const int end : {(i + 1) % 3, (i + 2) % 3}) {
      const bool is_cut_off = side[end] != 0 && (sign == 0 || (side[end] > 0) != (sign > 0));
      if (is_cut_off) {
        moved =
            std::max(moved, distance_bound(place_of(t.corners[end]), off.cut[0], off.cut[1], step));
      }
    }
  }
  return std::min(moved * (1.0 + 0x1p-40), static_cast<double>(t.reach));
}

}  // namespace ptin
