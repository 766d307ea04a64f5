// SPDX-License-Identifier: GPL-3.0-or-later
//
// Walks over a mesh: to a spot, and along a straight line. Every decision is exact (shape/spot.h),
// so a line through vertices, along edges or along the border is walked like any other.
//
// The mesh must be valid and whole (mesh/validate.h): a disk over a convex domain. A mesh that
// refine() has cut at a region (refine/refine.h) is not.
#pragma once

#include <array>
#include <cstdint>

#include "engine/geometry/height.h"
#include "engine/mesh/tin.h"
#include "engine/query/shape/spot.h"

namespace ptin {

/// Where a spot lies: on a vertex, in an edge without its ends, in a triangle without its sides, or
/// outside of the domain.
enum class Lies : std::uint8_t { kOutside, kInTriangle, kOnEdge, kOnVertex };

struct Place {
  Lies lies = Lies::kOutside;
  /// A closed triangle that holds the spot. For kOutside a triangle with a border edge that has the
  /// spot beyond it.
  TriangleId triangle = kNone;
  /// kOnEdge, kOutside: the side, numbered by the corner opposite to it; kOnVertex: the corner.
  int index = 0;
};

/// Finds the place of a spot by a visibility walk whose choices are pseudo-random but the same in
/// every run. Such a walk ends with probability 1 (Devillers, Pion, Teillaud 2002). After as many
/// steps as the mesh has triangles all triangles are looked at instead.
/// @param start  Any triangle; one near the spot is fast.
/// Cost: about the square root of the number of triangles between `start` and the spot.
[[nodiscard]] Place find_spot(const Tin& tin, Spot q, TriangleId start);

/// The triangle that answers for a place that several closed triangles share, the same however the
/// mesh is numbered: a surface triangle before a void one; among equals the one whose corners'
/// keys, in ascending order, come first. Returns kNone for a place outside. Cost: the degree of the
/// vertex.
[[nodiscard]] TriangleId answering_triangle(const Tin& tin, const Place& place);

/// True when a surface triangle holds the vertex. Cost: its degree.
[[nodiscard]] bool touches_surface(const Tin& tin, VertexId v);
/// True when a void triangle holds the vertex. Cost: its degree.
[[nodiscard]] bool touches_void(const Tin& tin, VertexId v);

/// A point of the mesh as a weighted mean of one, two or three vertices: the vertex that it is on,
/// the ends of its edge, or the corners of its triangle. Vertices ascend by key, so that the same
/// point is the same mean from both sides of an edge and in every numbering. Weights are positive
/// and exact.
struct Footing {
  int count = 0;
  std::array<VertexId, 3> vertex{kNone, kNone, kNone};
  std::array<Int128, 3> weight{};

  [[nodiscard]] Lies lies() const noexcept {
    return count == 1 ? Lies::kOnVertex : (count == 2 ? Lies::kOnEdge : Lies::kInTriangle);
  }
};

/// The footing of a spot. REQUIRES: place = find_spot(tin, q, ...), not outside.
[[nodiscard]] Footing footing_of(const Tin& tin, Spot q, const Place& place);

/// The mean of the first `count` of some numbers, 1 to 3, with these weights. Exact of one number
/// and where all are equal; else off by at most 8 units of rounding (2^-53) of the largest
/// magnitude, and never outside of their range. REQUIRES: weights are positive.
[[nodiscard]] double weighted_mean(int count, const std::array<double, 3>& z,
                                   const std::array<Int128, 3>& weight);

/// The height code at a point as a weighted mean of codes, apart from a mesh.
struct WeightedCodes {
  int count = 0;
  std::array<double, 3> code{};
  std::array<Int128, 3> weight{};

  [[nodiscard]] double mean() const { return weighted_mean(count, code, weight); }
  /// True when all codes are the same: the mean is then exact.
  [[nodiscard]] bool is_level() const noexcept {
    return (count < 2 || code[1] == code[0]) && (count < 3 || code[2] == code[0]);
  }
};

/// The height code at a footing: the weighted mean of the codes of its vertices. REQUIRES: all
/// vertices of the footing have heights.
[[nodiscard]] WeightedCodes codes_at(const Tin& tin, const HeightEncoding& heights,
                                     const Footing& f);
[[nodiscard]] inline double code_at(const Tin& tin, const HeightEncoding& heights,
                                    const Footing& f) {
  return codes_at(tin, heights, f).mean();
}

/// Where a line crosses the mesh.
struct Crossing {
  Footing footing;
  /// Share of the way along the line, from p to q (LineWalk), exactly: numerator / denominator, in
  /// [0, 1].
  Int128 numerator = 0;
  Int128 denominator = 1;

  [[nodiscard]] double share() const noexcept {
    return static_cast<double>(numerator) / static_cast<double>(denominator);
  }
};

/// A point of a line, and the surface there, apart from a mesh.
struct LinePoint {
  WeightedCodes ground;  ///< Count 0 where there is no surface.
  Int128 numerator = 0;  ///< As Crossing.
  Int128 denominator = 1;

  [[nodiscard]] double share() const noexcept {
    return static_cast<double>(numerator) / static_cast<double>(denominator);
  }
  /// Neither the beginning of the line nor its end.
  [[nodiscard]] bool is_inner() const noexcept { return numerator > 0 && numerator < denominator; }
};

/// A stretch of a line between two crossings: inside of one triangle, or along one edge.
struct LinePiece {
  Crossing from, to;
  TriangleId triangle = kNone;  ///< Holds the piece; along an edge one of its two triangles.
  /// Along an edge the other triangle, kNone at the border; inside kNone.
  TriangleId other = kNone;

  /// True when the piece lies on a closed surface triangle.
  [[nodiscard]] bool is_surface(const Tin& tin) const noexcept {
    return tin.classes[triangle] == TriangleClass::kSurface ||
           (other != kNone && tin.classes[other] == TriangleClass::kSurface);
  }
};

/// Walks from p to q piece by piece, in order. A line that begins outside of the domain is walked
/// from where it enters the domain. A line that leaves the domain ends there, since the domain is
/// convex.
class LineWalk {
 public:
  /// REQUIRES: p != q.
  /// @param tin    Borrowed for the life of the walk.
  /// @param start  Any triangle; one near p is fast.
  LineWalk(const Tin& tin, Spot p, Spot q, TriangleId start);

  /// False when the line and the domain share no point.
  [[nodiscard]] bool meets_domain() const noexcept { return meets_; }
  /// The first point of the line in the domain, set when meets_domain(). next() does not change it.
  [[nodiscard]] const Crossing& entry() const noexcept { return entry_; }
  /// True when p itself lies in the domain.
  [[nodiscard]] bool begins_inside() const noexcept { return begins_inside_; }
  /// True when q itself lies in the domain. Known once next() has returned false.
  [[nodiscard]] bool ends_inside() const noexcept { return ends_inside_; }

  /// Goes to the next piece; false when there is none. Cost: constant; at a vertex its degree.
  bool next();
  [[nodiscard]] const LinePiece& piece() const noexcept { return piece_; }

 private:
  enum class State : std::uint8_t { kInTriangle, kIntoEdge, kAtVertex, kAlongEdge, kDone };

  [[nodiscard]] Int128 turn(VertexId v) const { return side(p_, q_, tin_->position(v)); }
  void begin_at(const Place& place);
  void begin_on_edge(TriangleId t, int edge_side);
  void begin_outside(const Place& place);
  void enter_through(TriangleId t, int edge_side);
  void leave_triangle(TriangleId t);
  void cross_triangle();
  bool step_from_vertex();
  void step_along_edge();
  void exit_by_edge(TriangleId t, int edge_side, Int128 right, Int128 left);
  void exit_by_vertex(TriangleId t, VertexId v);
  void end_at(const Footing& footing);
  [[nodiscard]] bool lies_ahead(GridPoint v) const noexcept;
  [[nodiscard]] int compare_with_end(GridPoint v) const noexcept;
  [[nodiscard]] Crossing at_vertex(VertexId v) const;
  [[nodiscard]] Crossing at_edge(VertexId right, VertexId left, Int128 right_turn,
                                 Int128 left_turn) const;

  const Tin* tin_;
  Spot p_, q_;
  State state_ = State::kDone;
  TriangleId triangle_ = kNone;            ///< The triangle to cross next.
  int side_ = 0;                           ///< kIntoEdge: entered through this side of triangle_.
  Int128 right_turn_ = 0, left_turn_ = 0;  ///< turn() of the ends of the edge entered through.
  VertexId vertex_ = kNone;                ///< kAtVertex: the vertex; kAlongEdge: the end ahead.
  TriangleId beside_ = kNone;              ///< kAlongEdge: the other triangle of the edge.
  bool meets_ = false, begins_inside_ = false, ends_inside_ = false;
  Crossing entry_;
  LinePiece piece_;
};

}  // namespace ptin
