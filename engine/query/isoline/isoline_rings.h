// SPDX-License-Identifier: GPL-3.0-or-later
//
// Rings around the parts of a surface in bands of heights, walked over the triangles of the
// surface. For isoline_bands.cc.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "engine/mesh/tin.h"
#include "engine/query/isoline/isoline_bands.h"
#include "engine/query/isoline/isoline_cut.h"

namespace ptin {

/// A point of a ring, in map units. `vertex` is the vertex of the surface at the point; kNone
/// between vertices.
struct RingPoint {
  MapPoint point;
  VertexId vertex = kNone;
};

/// A surface cut by levels. The part of triangle t in band b is piece `piece(t, b)`. Pieces of a
/// band that share more than a single point belong to one component.
///
/// A vertex at a level counts as above it, as it does for isolines. But a part without area belongs
/// to no band, which decides two cases:
/// - Two parts of a band that meet only in a vertex exactly at a level are two components.
/// - A ridge exactly at a level, lower on both sides, does not divide the band below it.
///
/// So two rings touch in single points at most, and no ring runs around several parts that hang
/// together only at points.
class BandMesh {
 public:
  /// All borrowed for the life of the mesh.
  /// @throws Error resource_exhausted, cancelled
  /// Cost: O(n log n) in triangles and pieces.
  BandMesh(const SurfaceArrays& surface, std::span<const double> levels,
           const QueryContext& context);

  /// Called once for every ring, with its band, the component inside of it, and its points. The
  /// inside lies to the left. Points may repeat, and a ring may have no area.
  using Visitor = std::function<void(std::uint32_t band, std::uint32_t component,
                                     const std::vector<RingPoint>& ring)>;
  /// Walks along all rings. May be called once.  @throws Error cancelled; what `visitor` throws
  void visit_rings(const Visitor& visitor);

 private:
  enum class Kind : std::uint8_t { kForward, kBackward, kBorder };
  /// One step of a ring, which has its band on the left:
  /// kForward   the line through triangle `t` that is the upper border of the band;
  /// kBackward  the line through `t` that is the lower border of the band;
  /// kBorder    side `side` of `t`, a border side of the surface, from a vertex in the band.
  struct Element {
    Kind kind = Kind::kBorder;
    TriangleId t = kNone;
    int side = 0;
    friend bool operator==(const Element&, const Element&) = default;
  };

  void find_neighbours(const QueryContext& context);
  void join_components();
  [[nodiscard]] std::uint32_t low(TriangleId t) const noexcept;
  [[nodiscard]] std::uint32_t high(TriangleId t) const noexcept;
  [[nodiscard]] std::uint32_t piece(TriangleId t, std::uint32_t band) const noexcept {
    return first_piece_[t] + band - low(t);
  }
  [[nodiscard]] std::uint32_t component(std::uint32_t piece) noexcept;
  [[nodiscard]] std::uint8_t& visited(const Element& e, std::uint32_t band) noexcept;
  [[nodiscard]] RingPoint cut(TriangleId t, int side, std::uint32_t level) const noexcept;
  [[nodiscard]] int line_side(TriangleId t, std::uint32_t level, bool entry) const noexcept;
  [[nodiscard]] Element walk(const Element& e, std::uint32_t band, std::vector<RingPoint>& ring);
  [[nodiscard]] Element along_border(TriangleId t, int side, std::uint32_t band,
                                     std::vector<RingPoint>& ring) const;
  [[nodiscard]] Element around(TriangleId t, VertexId v, std::uint32_t band, bool arrived) const;
  [[nodiscard]] Element over_ridges(TriangleId t, std::uint32_t band,
                                    std::vector<RingPoint>& ring) const;
  [[nodiscard]] bool is_at(VertexId v, std::uint32_t level) const noexcept {
    return surface_.vertices[v][2] == levels_[level];
  }
  [[nodiscard]] TriangleId beyond_ridge(TriangleId t, std::uint32_t level) const noexcept;
  [[nodiscard]] bool is_point(TriangleId t, std::uint32_t level) const noexcept;
  void visit_from(const Element& start, std::uint32_t band, const Visitor& visitor);

  SurfaceArrays surface_;
  std::span<const double> levels_;
  const QueryContext& context_;
  /// For each triangle its neighbours, opposite to its corners.
  std::vector<std::array<TriangleId, 3>> neighbours_;
  std::vector<std::uint32_t> bands_;          ///< For each vertex its band.
  std::vector<std::uint32_t> first_piece_;    ///< For each triangle the piece in its lowest band.
  std::vector<std::uint32_t> parent_;         ///< Union-find over the pieces.
  std::vector<std::uint8_t> visited_;         ///< For each piece a bit for each kind but kBorder.
  std::vector<std::uint8_t> border_visited_;  ///< For each triangle a bit for each side.
  std::vector<RingPoint> ring_;
};

}  // namespace ptin
