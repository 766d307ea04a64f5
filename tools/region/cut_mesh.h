// SPDX-License-Identifier: GPL-3.0-or-later
//
// A triangulation into which the border of a region is inserted (cut.h): its nodes are spots, so that
// every decision is exact.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "engine/mesh/tin.h"
#include "engine/query/shape/spot.h"

namespace ptin::tools {

/// A vertex of the cut mesh.
struct CutNode {
  Spot at;
  std::array<double, 3> map{};  ///< x, y in map units, height.
  bool has_height = false;
  bool is_tin_vertex = false;
  /// The ends of the edge of the TIN on which a cut point lies, in order; kNone for other nodes.
  std::uint32_t edge_low = kNone;
  std::uint32_t edge_high = kNone;
  TriangleId triangle = kNone;  ///< One triangle around it.
};

struct CutTriangle {
  std::array<std::uint32_t, 3> v{};  ///< Counter-clockwise.
  std::array<TriangleId, 3> n{};     ///< n[i] across the edge opposite to v[i].
  /// border[i]: the edge opposite to v[i] is part of the region's border, an odd number of times.
  std::array<bool, 3> border{};
  TriangleClass cls = TriangleClass::kSurface;
};

/// A corner of a region's border. The map coordinates are the caller's own.
struct BorderCorner {
  Spot at;
  MapPoint map;
};

/// One straight piece of a region's border.
struct BorderSegment {
  BorderCorner from, to;
};

/// The triangulation, and the steps that insert a border into it. Every step keeps it valid:
/// strictly counter-clockwise triangles, symmetric neighbours.
class CutMesh {
 public:
  std::vector<CutNode> nodes;
  std::vector<CutTriangle> triangles;

  /// The node at a corner: an existing one, or a new one that splits an edge or a triangle. kNone
  /// when the corner lies outside of the mesh.
  std::uint32_t insert_point(const BorderCorner& corner);
  /// Makes the part of a segment inside of the mesh a chain of border edges. `from` and `to` are
  /// the nodes at its ends, or kNone where an end lies outside.
  void insert_segment(const BorderSegment& segment, std::uint32_t from, std::uint32_t to);

 private:
  struct CutPlace {
    TriangleId triangle = kNone;
    int corner = -1;  ///< >= 0: at this corner.
    int edge = -1;    ///< >= 0: on the edge opposite to this corner.
  };
  [[nodiscard]] Spot at(std::uint32_t node) const noexcept { return nodes[node].at; }
  [[nodiscard]] CutPlace place_in(TriangleId t, Spot p) const noexcept;
  [[nodiscard]] CutPlace locate(Spot p);
  [[nodiscard]] std::vector<TriangleId> star(std::uint32_t v) const;
  void split_triangle(TriangleId t, std::uint32_t node);
  void split_edge(TriangleId t, int edge, std::uint32_t node);
  [[nodiscard]] bool can_split_edge(TriangleId t, int i, Spot p) const noexcept;
  void toggle_border(std::uint32_t a, std::uint32_t b);
  void trace(std::uint32_t from, Spot target, std::uint32_t to, const BorderSegment& segment);
  /// One step of trace(): the next node on the way from `v`, kNone when the way leaves the mesh.
  std::uint32_t next_on_the_way(std::uint32_t v, Spot target, std::uint32_t to,
                                const BorderSegment& segment);
  /// The node where the way v -> target crosses the edge opposite to corner `i` of `t`: new, or an
  /// end of the edge.
  std::uint32_t cross_edge(TriangleId t, int i, Spot v, Spot target, const BorderSegment& segment);
  [[nodiscard]] CutNode crossing(std::uint32_t a, std::uint32_t b, Spot v, Spot target,
                                 const BorderSegment& segment) const;
  /// The first node of the mesh's outline that a segment with both ends outside meets.
  std::uint32_t entry_of(const BorderSegment& segment);

  TriangleId hint_ = 0;
};

}  // namespace ptin::tools
