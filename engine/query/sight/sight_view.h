// SPDX-License-Identifier: GPL-3.0-or-later
//
// A line over a mesh that is partly coarse: piece by piece, what is certain of the line's height
// above the full surface.
#pragma once

#include <optional>
#include <vector>

#include "engine/geometry/infinity.h"
#include "engine/query/refine/bounded_surface.h"
#include "engine/query/sight/sight_line.h"

namespace ptin {

/// A stretch of the line and what the mesh holds there: all records of a deviation above
/// `deviation`.
struct KnownStretch {
  double from = 0.0, to = 0.0;
  double deviation = -1.0;  ///< Negative: records of any deviation.
  bool beyond = false;      ///< Records within the tolerance of the level of detail are there too.
};

/// A line over a mesh, as far as the mesh shows it. The owner says in `known` which records the
/// mesh holds along the line, refines the mesh, and looks again. Threads: one owner.
class SightView : public SightLine {
 public:
  using SightLine::SightLine;
  explicit SightView(const SightLine& line) : SightLine(line) {}

  std::vector<KnownStretch> known;
  /// Records at the ends of a larger deviation are applied. Negative: all are. Infinite: none is
  /// known to be, as before the ends are asked for.
  double end_deviation = kInfinity;

  /// Walks the mesh from p to q, fills pieces and ends, and decides each piece: by bounds, and
  /// where these do not decide and no record was left out, exactly. Cost: the triangles on the way.
  void look(const BoundedSurface& mesh);

  /// A point, as a share of the way, of which records may still change whether it is ground, and
  /// which is not a part of a piece that decides: the one in which the line meets the domain, or
  /// one in which two voids meet.
  [[nodiscard]] const std::optional<double>& open_touch() const noexcept { return open_touch_; }
  /// True when no record was left out that may change the classes at a point.
  [[nodiscard]] bool is_settled_at(double share) const noexcept;

 private:
  void add_piece(const BoundedSurface& mesh, const LinePiece& piece);
  void set_only_point(const BoundedSurface& mesh, const LineWalk& walk);
  void set_end(const BoundedSurface& mesh, const Crossing& c, TriangleId t, SightEnd& end) const;
  [[nodiscard]] TriangleId answering(const BoundedSurface& mesh, const SightEnd& end) const;
  void decide_exactly_all(const BoundedSurface& mesh);
  void check_touch(const BoundedSurface& mesh, const Crossing& c);

  TriangleId start_ = 0;  ///< Where the last look() began; triangles keep their numbers.
  std::optional<double> open_touch_;
};

}  // namespace ptin
