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

/// One piece of the line, inside of one triangle or along one edge of the mesh. Its clearance is
/// the height of the line above the full surface. Heights are in the height's unit.
struct SightPiece {
  double from = 0.0, to = 0.0;                ///< Shares of the way.
  double ground_from = 0.0, ground_to = 0.0;  ///< Heights of the mesh at both; set only on surface.
  double deviation = 0.0;  ///< Most that the full surface deviates from the mesh.
  double highest = 0.0;    ///< No point of the full surface is higher.
  bool surface = false;
  bool final = false;              ///< No record that the request may ask for changes the piece.
  bool exact = false;              ///< No record of the file changes it, whatever the tolerance.
  bool settled = false;            ///< It is surface, or void, in the full TIN too.
  double least = 0.0, most = 0.0;  ///< Bounds of the smallest clearance.
  /// Smallest clearance over the mesh, and its share of the way.
  double guess = 0.0, guess_at = 0.0;
  PieceVerdict verdict = PieceVerdict::kUndecided;  ///< What the bounds, or exact arithmetic, say.
};

/// True when no record was left out that would change a clearance over the piece.
[[nodiscard]] inline bool is_final_truth(const SightPiece& p) noexcept {
  return p.final && p.settled && p.deviation == 0;
}

/// A stretch of the line and what the mesh holds there: all records of a deviation above
/// `deviation`, except those whose surface ends lower than `margin` below the line.
struct KnownStretch {
  double from = 0.0, to = 0.0;
  double deviation = -1.0;  ///< Negative: records of any deviation.
  double margin = 0.0;      ///< Infinite: no record is missing for its height.
  bool beyond = false;      ///< Records within the tolerance of the level of detail are there too.
};

/// What does not change while one terrain is asked.
struct SightFacts {
  HeightEncoding heights;
  double file_deviation = 0.0;    ///< Of the file's full TIN from its source.
  double finest_deviation = 0.0;  ///< Of final pieces: the file's, or that of the level of detail.
  double base_deviation = 0.0;    ///< The mesh has all records above this, everywhere.
  double max_height = 0.0;        ///< Of the whole terrain.
  double tolerance = -1.0;        ///< Of the level of detail; negative: it keeps all records.
  bool is_level_asked = false;    ///< A level of detail was asked for: records beyond it exist.
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
  bool known = false;    ///< All records at the end are applied.
  /// Records at the end of a larger deviation are applied. Negative: all are. Infinite: none is
  /// known to be, as before the ends are asked for.
  double deviation = -1.0;
  Footing footing;  ///< Where on the mesh the end stands.
  Interval level;   ///< Bounds of the height of the end.
};

/// A line over a mesh, as far as the mesh tells. The owner says in `known` which records the mesh
/// holds along the line, refines the mesh, and looks again. Threads: one owner.
class SightView {
 public:
  SightView(const SightFacts& facts, Spot p, Spot q) : facts_(facts), p_(p), q_(q) {}

  SightEnd a, b;
  double bend = 0.0;
  std::vector<KnownStretch> known;
  std::vector<SightPiece> pieces;

  /// Walks the mesh from p to q and fills pieces and ends.  @param start  Any triangle; one near p
  /// is fast. Cost: the triangles on the way.
  void look(const BoundedMesh& mesh, TriangleId start);
  /// Decides each piece: by bounds, and where these do not tell and no record was left out,
  /// exactly.
  void decide(const BoundedMesh& mesh);

  [[nodiscard]] const Ray& ray() const noexcept { return ray_; }
  /// True when both ends have a height: each is absolute or stands on ground.
  [[nodiscard]] bool ends_defined() const noexcept {
    return (a.absolute || a.surface) && (b.absolute || b.surface);
  }
  /// True when the heights of both ends are as certain as the file is.
  [[nodiscard]] bool knows_levels() const noexcept {
    return (a.absolute || a.known) && (b.absolute || b.known);
  }
  /// The triangle in which the last look() began to walk.
  [[nodiscard]] TriangleId start() const noexcept { return start_; }
  /// True when the line meets the domain in one point alone, and records may still change whether
  /// that point is ground.
  [[nodiscard]] bool is_touch_open() const noexcept { return touch_open_; }
  /// True when a vertex hides the line alone: the line passes it between voids, or touches it from
  /// outside of the domain, and the vertex lies above the line.
  [[nodiscard]] bool is_touched_from_below() const noexcept { return touched_ <= 1.0; }
  /// Share of the way of the first vertex that hides the line so; above 1 when there is none.
  [[nodiscard]] double touched_at() const noexcept { return touched_; }
  /// The least clearance over all vertices that the line passes or touches so; infinite when there
  /// is none.
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
  /// Bound of the rounding of any clearance of the line.
  [[nodiscard]] double rounding() const noexcept;

  SightFacts facts_;
  Spot p_, q_;
  TriangleId start_ = 0;
  Ray ray_;
  /// Largest of the heights of the mesh on the way, and at least the sum of the ends' given heights
  /// and the offset.
  double magnitude_ = 0.0;
  double touched_ = 2.0;  ///< As touched_at().
  Lowest least_touch_{};
  bool any_exact_ = false;  ///< Some piece needs exact arithmetic.
  bool touch_open_ = false;
};

}  // namespace ptin
