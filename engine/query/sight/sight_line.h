// SPDX-License-Identifier: GPL-3.0-or-later
//
// A line of sight over pieces of a surface: what is certain of its height above the full surface.
#pragma once

#include <cstdint>
#include <vector>

#include "engine/geometry/infinity.h"
#include "engine/query/sight/sight.h"
#include "engine/query/sight/sight_ray.h"

namespace ptin {

enum class PieceVerdict : std::uint8_t { kVisible, kHidden, kUndecided };

/// One piece of the line, inside of one triangle or along one edge. Its clearance is the height of
/// the line above the full surface. Heights are in the height's unit.
struct SightPiece {
  double from = 0.0, to = 0.0;                ///< Shares of the way.
  double ground_from = 0.0, ground_to = 0.0;  ///< Heights of the surface there; set on surface.
  double deviation = 0.0;  ///< Most that the full surface deviates from the piece.
  double highest = 0.0;    ///< No point of the full surface is higher.
  bool surface = false;
  bool along_edge = false;         ///< Set by stars, where both triangles of the edge come.
  bool final = false;              ///< No record that the request may ask for changes the piece.
  bool exact = false;              ///< No record of the file changes it, whatever the tolerance.
  bool settled = false;            ///< It is surface, or void, in the full TIN too.
  double least = 0.0, most = 0.0;  ///< Bounds of the smallest clearance.
  /// Smallest clearance over the piece as it is, and its share of the way.
  double guess = 0.0, guess_at = 0.0;
  double most_at = 0.0;  ///< Share of the way where the clearance is `most` at most.
  PieceVerdict verdict = PieceVerdict::kUndecided;  ///< What the bounds, or exact arithmetic, say.
  friend bool operator==(const SightPiece&, const SightPiece&) = default;
};

/// True when no record was left out that would change a clearance over the piece.
[[nodiscard]] inline bool is_final_truth(const SightPiece& p) noexcept {
  return p.final && p.settled && p.deviation == 0;
}

/// What does not change while one terrain is asked.
struct SightFacts {
  HeightEncoding heights;
  double file_deviation = 0.0;    ///< Deviation of the file's full TIN from its source.
  double finest_deviation = 0.0;  ///< Deviation of final pieces: the file's, or the level's.
  double min_height = 0.0, max_height = 0.0;  ///< Heights of the whole terrain.
  const Detail* detail = nullptr;             ///< The level of detail; borrowed.
  bool is_level_asked = false;                ///< A level of detail leaves records out.
  bool has_voids = false;
  bool final_settles = true;  ///< Voids of final pieces are those of the source.
  bool exact_settles = true;  ///< Voids of exact pieces are those of the source.
};

/// One end of the line: what the request gives, and what is known of the ground below it.
struct SightEnd {
  double height = 0.0;  ///< Above ground, or absolute.
  bool absolute = false;
  bool inside = false;   ///< The end lies in the domain.
  bool surface = false;  ///< The end stands on ground.
  bool known = false;    ///< The ground is that of the file's full TIN.
  WeightedCodes ground;  ///< Set where the end stands on ground.
  Interval level;        ///< Bounds of the height of the end.
};

/// A vertex that a line passes between voids, or touches from outside of the domain.
struct Touch {
  double least = kInfinity, most = kInfinity;  ///< Bounds of the clearance.
  double guess = kInfinity, at = 0.0;          ///< Over the vertex as it is; its share of the way.
};

/// A line, its ends, and the pieces of a surface below it. Threads: one owner.
class SightLine {
 public:
  /// @param facts  Borrowed for the life of the line.  REQUIRES: p != q.
  /// @param bend   Curvature::drop_at() of the line's length.
  SightLine(const SightFacts& facts, Spot p, Spot q, const SightPair& pair, bool absolute,
            double bend);

  SightEnd a, b;
  std::vector<SightPiece> pieces;

  [[nodiscard]] Spot p() const noexcept { return p_; }
  [[nodiscard]] Spot q() const noexcept { return q_; }
  [[nodiscard]] const Ray& ray() const noexcept { return ray_; }
  /// True when both ends have a height: each is absolute or stands on ground.
  [[nodiscard]] bool ends_defined() const noexcept {
    return (a.absolute || a.surface) && (b.absolute || b.surface);
  }
  /// True when the heights of both ends are as certain as the file is.
  [[nodiscard]] bool knows_levels() const noexcept {
    return ends_defined() && (a.absolute || a.known) && (b.absolute || b.known);
  }
  /// The first of `pieces` that is hidden for certain, or null.
  [[nodiscard]] const SightPiece* hidden_piece() const noexcept;

  /// Sets the ray from what the ends say, and forgets touches.
  void take_levels();
  /// Sets the height of an end that stands on `ground`, a mean of the codes of a surface that the
  /// full one may deviate from by so much.
  void stand_on(SightEnd& end, const WeightedCodes& ground, double deviation) const;
  /// The height of the surface at a point.
  [[nodiscard]] double ground_of(const WeightedCodes& ground) const {
    return facts_.heights.height_of_code(ground.mean());
  }
  /// Bound of the rounding of any clearance of the line.
  [[nodiscard]] double rounding() const noexcept;
  /// Sets `settled`, and deviation and height to what the file and the level of detail certify at
  /// best, from `final` and `exact`.
  void certify(SightPiece& piece) const;
  /// Sets bounds, guess and verdict.
  void decide_by_bounds(SightPiece& piece) const;
  /// Puts the pieces in their order, each once. What holds of either triangle holds on their common
  /// edge.
  void order_pieces();
  /// Where pieces of the full TIN are there beside those of a level of detail, they stand in the
  /// place of these. REQUIRES: order_pieces() came before.
  void prefer_exact();
  /// Decides a piece of surface in rationals, where its bounds do not decide and nothing is left
  /// out.
  void decide_exactly(SightPiece& piece, const LinePoint& from, const LinePoint& to) const;
  /// Looks at a point in which the line meets the closed surface beside a void, or from outside of
  /// the domain. An end of the line there does not hide the line.
  /// REQUIRES: the file's full TIN is surface there, of this height.
  void take_touch(const LinePoint& at);
  /// The same at a point of which it is not known whether it is ground, nor how high.
  void take_open_touch(double share);

  /// True when a vertex hides the line alone: the line passes it between voids, or touches it from
  /// outside of the domain, and the vertex lies above the line.
  [[nodiscard]] bool is_touched_from_below() const noexcept { return touched_ <= 1.0; }
  /// True when a vertex may hide the line so, and what was left out would decide.
  [[nodiscard]] bool may_be_touched_from_below() const noexcept { return may_be_touched_; }
  /// Share of the way of the first vertex that hides the line so; above 1 when there is none.
  [[nodiscard]] double touched_at() const noexcept { return touched_; }
  /// The vertex of least clearance that the line passes or touches so; of infinite clearance when
  /// there is none.
  [[nodiscard]] const Touch& least_touch() const noexcept { return least_touch_; }

 protected:
  [[nodiscard]] const SightFacts& facts() const noexcept { return facts_; }

 private:
  [[nodiscard]] bool can_be_exact() const noexcept {
    return facts_.file_deviation == 0 && knows_levels();
  }
  /// One piece for two that lie on the common edge of two triangles.
  [[nodiscard]] SightPiece united_on_edge(const SightPiece& x, const SightPiece& y) const;
  /// The piece over a part of its way. REQUIRES: piece.from <= from < to <= piece.to.
  [[nodiscard]] SightPiece part_of(const SightPiece& piece, double from, double to) const;
  [[nodiscard]] ExactRay exact_ray() const;

  const SightFacts& facts_;
  Spot p_, q_;
  double bend_;
  double magnitude_;  ///< Sum of all heights of which rounding() depends.
  Ray ray_;
  double touched_ = 2.0;  ///< As touched_at().
  bool may_be_touched_ = false;
  Touch least_touch_;
};

}  // namespace ptin
