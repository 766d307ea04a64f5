// SPDX-License-Identifier: GPL-3.0-or-later
//
// The full surface of a part of a TIN: any set of its triangles, with holes, of several pieces.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "engine/construct/tile/border_witnesses.h"
#include "engine/construct/tile/fixed_gaps.h"
#include "engine/construct/tile/full_surface.h"
#include "engine/geometry/packed_boxes.h"
#include "engine/mesh/tin.h"

namespace ptin {

/// The border between surface and void in a part.
struct PartBorder {
  BorderWitnesses witnesses;                          ///< Witnesses, vertex by vertex of the part.
  std::function<bool(GridPoint, GridPoint)> goes_on;  ///< As PartOfTerrain::goes_on.
  GroundStep step;
};

/// The surface of a leaf of points or of a TIN: the triangles of the full TIN that are its own. An
/// edge may begin and end outside of the part, and enter and leave it more than once.
class PartSurface final : public FullSurface {
 public:
  /// Keeps a copy of `part`. REQUIRES: its vertices are in the order of their keys, and neighbours
  /// are kNone at its border.
  /// @param border  Where the terrain has voids.
  /// @param fixed   The fixed edges of the part.
  PartSurface(const Tin& part, const HeightEncoding& encoding,
              std::optional<PartBorder> border = std::nullopt, FixedGaps fixed = {});

  /// Cost: the crossings, and the logarithm of the length of the border.
  [[nodiscard]] double largest_gap(const EdgeEnd& a, const EdgeEnd& b) const override;
  [[nodiscard]] double fixed_gap(const EdgeEnd& a, const EdgeEnd& b,
                                 double stop_above) const override {
    return fixed_.largest_gap(a, b, stop_above);
  }
  [[nodiscard]] bool has_fixed_edges() const noexcept override { return !fixed_.is_empty(); }
  /// 0 without a PartBorder.
  [[nodiscard]] double border_move(GridPoint a, GridPoint b) const override;

 private:
  /// A side of a triangle beyond which the part has no triangle. The walk around its first corner
  /// begins in that triangle.
  struct BorderSide {
    VertexId first, second;  ///< The part is on the left of first -> second.
    TriangleId triangle;
    int side;  ///< Opposite to this corner of `triangle`.
  };
  struct Step;
  template <class Visitor>
  class Walk;
  class GapVisitor;
  class BorderVisitor;

  void index_border();
  [[nodiscard]] VertexId vertex_at(GridPoint p) const noexcept;
  /// Reports to `visitor` where the edge from a to b goes within the part.
  template <class Visitor>
  void walk_over(GridPoint a, GridPoint b, Visitor& visitor) const;
  template <class Visit>
  void visit_border(GridPoint a, GridPoint b, const Visit& visit) const;

  Tin part_;
  HeightEncoding encoding_;
  std::optional<PartBorder> void_border_;
  std::vector<BorderSide> border_;       ///< By first corner.
  std::vector<std::uint32_t> by_place_;  ///< Indices into border_, along the Hilbert curve.
  PackedBoxes boxes_;                    ///< Boxes of the sides, in that order.
  std::vector<std::uint8_t> on_border_;  ///< 1 for a vertex of the border.
  FixedGaps fixed_;
};

}  // namespace ptin
