// SPDX-License-Identifier: GPL-3.0-or-later
//
// How far an edge passes from the breaklines that it crosses.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "engine/construct/tile/full_surface.h"
#include "engine/geometry/height.h"
#include "engine/geometry/packed_boxes.h"
#include "engine/mesh/tin.h"

namespace ptin {

/// The fixed edges of a leaf: those of its triangles that lie on a breakline or on the boundary, with
/// surface on one side at least. Threads: const.
class FixedGaps {
 public:
  FixedGaps() = default;
  /// @param sides  By part.triangles: bit i is set where side i is a fixed edge; may be empty.
  FixedGaps(const Tin& part, std::span<const std::uint8_t> sides, const HeightEncoding& encoding);

  [[nodiscard]] bool is_empty() const noexcept { return edges_.empty(); }
  /// A bound on the vertical distance between the edge a-b and the fixed edges that it crosses, in
  /// height codes. Tight up to rounding; 0 where all heights are equal, or none is crossed.
  /// @param stop_above  As FullSurface::fixed_gap().
  /// Cost: the fixed edges whose boxes a-b goes through.
  [[nodiscard]] double largest_gap(const EdgeEnd& a, const EdgeEnd& b, double stop_above) const;

 private:
  struct Edge {
    EdgeEnd p, q;
  };
  std::vector<Edge> edges_;  ///< Along the Hilbert curve.
  PackedBoxes boxes_;
};

}  // namespace ptin
