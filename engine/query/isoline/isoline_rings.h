// SPDX-License-Identifier: GPL-3.0-or-later
//
// Rings around the parts of a surface in bands of heights, walked over its triangles. For
// isoline_bands.cc.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "engine/mesh/tin.h"
#include "engine/query/isoline/isoline_bands.h"
#include "engine/query/isoline/isoline_cut.h"

namespace ptin {

/// A point of a ring, and the vertex of the surface that it is; kNone between vertices.
struct RingPoint {
  MapPoint point;
  VertexId vertex = kNone;
};

/// A surface cut by levels. A vertex at a level counts as above it, but here what has no area is no
/// part of a band: two parts that meet in a vertex exactly at the level are two, and a ridge
/// exactly at a level, lower on both sides, does not part what is below. So no ring touches another
/// but in single points, and none surrounds what hangs together by points alone. Of triangle t, the
/// part in band b is piece `piece(t, b)`; pieces that share more than a point are of one component.
class BandMesh {
 public:
  BandMesh(const SurfaceArrays& surface, std::span<const double> levels,
           const QueryContext& context);

  /// Called for every ring with its band, the component inside and its points: the inside is on the
  /// left. Points may repeat; a ring may have no area.
  using Visitor = std::function<void(std::uint32_t band, std::uint32_t component,
                                     const std::vector<RingPoint>& ring)>;
  void visit_rings(const Visitor& visitor);

 private:
  enum class Kind : std::uint8_t { kForward, kBackward, kBorder };
  /// What a ring walks along: a line through triangle `t` (forward: the upper border of the band;
  /// backward: the lower one), or the border side `side` of `t`, from a vertex in the band.
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
  std::vector<std::array<TriangleId, 3>> neighbours_;  ///< Opposite to the corners.
  std::vector<std::uint32_t> bands_;                   ///< Beside the vertices.
  std::vector<std::uint32_t> first_piece_;             ///< Beside the triangles.
  std::vector<std::uint32_t> parent_;                  ///< Union-find over the pieces.
  std::vector<std::uint8_t> visited_;  ///< Beside the pieces: a bit for each kind but kBorder.
  std::vector<std::uint8_t> border_visited_;  ///< Beside the triangles: a bit a side.
  std::vector<RingPoint> ring_;
};

}  // namespace ptin
