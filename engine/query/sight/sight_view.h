// SPDX-License-Identifier: GPL-3.0-or-later
//
// A line over a mesh that is partly coarse: piece by piece, what is certain of the line's height
// above the full surface.
#pragma once

#include <cstdint>
#include <vector>

#include "engine/query/refine/bounded_mesh.h"
#include "engine/query/sight/sight_ray.h"

namespace ptin {

enum class PieceVerdict : std::uint8_t { kVisible, kHidden, kUndecided };

/// One piece of the line. Clearance: height of the line above the full surface.
struct SightPiece {
  double from = 0.0, to = 0.0;                ///< Shares of the way.
  double ground_from = 0.0, ground_to = 0.0;  ///< Of the mesh; only on surface.
  double deviation = 0.0;                     ///< Of the full surface from the mesh.
  double highest = 0.0;                       ///< Nothing of the full surface is above.
  bool surface = false;
  bool final = false;                  ///< No record that may be asked for will change it.
  bool exact = false;                  ///< No record at all will, whatever the tolerance.
  bool settled = false;                ///< What it is, surface or void, is so in the full TIN.
  double least = 0.0, most = 0.0;      ///< Bounds of the smallest clearance.
  double guess = 0.0, guess_at = 0.0;  ///< Smallest clearance over the mesh; where.
  PieceVerdict verdict = PieceVerdict::kUndecided;
};

/// Nothing was left out of the piece that would change a clearance over it.
[[nodiscard]] inline bool is_final_truth(const SightPiece& p) noexcept {
  return p.final && p.settled && p.deviation == 0;
}

/// A stretch of the line in which all records above a deviation are applied, unless their surface
/// ends lower than `margin` below the line; infinite: all of them.
struct KnownStretch {
  double from = 0.0, to = 0.0;
  double deviation = -1.0;  ///< Negative: all.
  double margin = 0.0;
  bool beyond = false;  ///< Those within the tolerance too.
};

/// What does not change while one terrain is asked.
struct SightFacts {
  HeightEncoding heights;
  double file_deviation = 0.0;    ///< Of the full TIN from its source.
  double finest_deviation = 0.0;  ///< Of what is final: the file's, or that of the tolerance.
  double base_deviation = 0.0;    ///< Of the coarse mesh; applied everywhere.
  double max_height = 0.0;        ///< Of the whole terrain.
  double tolerance = -1.0;        ///< Of the level of detail; negative: all records.
  bool is_level_asked = false;    ///< Else there is nothing beyond it.
  bool has_voids = false;
  bool final_settles = true;  ///< Where the mesh is final, its voids are those of the source.
  bool exact_settles = true;  ///< Where it is exact, they are.
};

/// One end of the line: what is given, and the ground below it as far as it is known.
struct SightEnd {
  double height = 0.0;
  bool absolute = false;
  bool inside = false;      ///< Of the domain.
  bool surface = false;     ///< Over ground.
  bool known = false;       ///< The mesh is exact there.
  double deviation = -1.0;  ///< Records above it are applied here; negative: all; before: infinite.
  Footing footing;
  Interval level;  ///< Height of the end.
};

class SightView {
 public:
  SightView(const SightFacts& facts, Spot p, Spot q) : facts_(facts), p_(p), q_(q) {}

  SightEnd a, b;
  double bend = 0.0;
  std::vector<KnownStretch> known;
  std::vector<SightPiece> pieces;

  /// Walks the mesh from p to q and fills pieces and ends. Cost: the triangles on the way.
  void look(const BoundedMesh& mesh, TriangleId start);
  /// Decides each piece as far as bounds can, and exactly where nothing is left out.
  void decide(const BoundedMesh& mesh);

  [[nodiscard]] const Ray& ray() const noexcept { return ray_; }
  /// Over every void: something below the line is missing.
  [[nodiscard]] bool ends_defined() const noexcept {
    return (a.absolute || a.surface) && (b.absolute || b.surface);
  }
  /// The heights of both ends are as certain as the file is.
  [[nodiscard]] bool knows_levels() const noexcept {
    return (a.absolute || a.known) && (b.absolute || b.known);
  }
  [[nodiscard]] TriangleId start() const noexcept { return start_; }
  /// The line meets the domain in one point alone, and whether that is ground may still change.
  [[nodiscard]] bool is_touch_open() const noexcept { return touch_open_; }
  /// A vertex that the line passes between voids, or touches from outside, lies above the line.
  [[nodiscard]] bool is_touched_from_below() const noexcept { return touched_ <= 1.0; }
  /// Share of the way of the first such vertex.
  [[nodiscard]] double touched_at() const noexcept { return touched_; }
  /// The least clearance over the vertices that it passes so; infinite when there is none.
  [[nodiscard]] const Lowest& least_touch() const noexcept { return least_touch_; }

 private:
  void add_piece(const BoundedMesh& mesh, const LinePiece& piece);
  void set_only_point(const BoundedMesh& mesh, const LineWalk& walk);
  void set_end(const BoundedMesh& mesh, const Crossing& c, TriangleId t, bool surface,
               SightEnd& end) const;
  [[nodiscard]] TriangleId answering(const BoundedMesh& mesh, const SightEnd& end,
                                     TriangleId near) const;
  void set_level(SightEnd& end) const;
  void decide_by_bounds(SightPiece& piece) const;
  void decide_exactly(const BoundedMesh& mesh);
  void check_touch(const BoundedMesh& mesh, const Crossing& c, const ExactRay& exact);
  [[nodiscard]] double ground_at(const BoundedMesh& mesh, const Crossing& c) const;
  /// Bound of the rounding of any clearance here.
  [[nodiscard]] double rounding() const noexcept;

  SightFacts facts_;
  Spot p_, q_;
  TriangleId start_ = 0;
  Ray ray_;
  double magnitude_ = 0.0;  ///< Largest height of the mesh on the way.
  double touched_ = 2.0;    ///< Above 1: none.
  Lowest least_touch_{};
  bool any_exact_ = false;  ///< Some piece needs exact arithmetic.
  bool touch_open_ = false;
};

}  // namespace ptin
