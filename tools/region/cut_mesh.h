// SPDX-License-Identifier: GPL-3.0-or-later
//
// A triangulation into which the border of a region is inserted (cut.h): nodes on a fine lattice,
// exact orientation.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "engine/mesh/tin.h"

namespace ptin::tools {

/// A position on the lattice of 2^-22 grid units.
struct LatticePoint {
  std::int64_t x = 0;
  std::int64_t y = 0;
  friend bool operator==(const LatticePoint&, const LatticePoint&) = default;
};
inline constexpr double kLatticePerGrid = 4194304.0;  // 2^22
/// Largest coordinate: differences stay below 2^62 and twice an area below 2^125.
inline constexpr double kLatticeMax = 1152921504606846976.0;  // 2^60

/// Twice the signed area of (a, b, c): the sign is exact, the value is rounded to double.
[[nodiscard]] double lattice_orient(LatticePoint a, LatticePoint b, LatticePoint c) noexcept;

/// A vertex of the cut mesh.
struct CutNode {
  LatticePoint at;
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

/// One straight piece of a region's border. The map coordinates are the caller's own.
struct BorderSegment {
  LatticePoint from, to;
  std::array<double, 2> map_from{}, map_to{};
};

/// The triangulation, and the steps that insert a border into it. Every step keeps it valid:
/// strictly counter-clockwise triangles, symmetric neighbours.
class CutMesh {
 public:
  std::vector<CutNode> nodes;
  std::vector<CutTriangle> triangles;

  /// The node at `at`: an existing one, or a new one that splits an edge or a triangle. kNone when
  /// `at` lies outside of the mesh.
  /// @param map  The map coordinates of a new node.
  std::uint32_t insert_point(LatticePoint at, const std::array<double, 2>& map);
  /// Makes the part of a segment inside of the mesh a chain of border edges. `from` and `to` are
  /// the nodes at its ends, or kNone where an end lies outside.
  void insert_segment(const BorderSegment& segment, std::uint32_t from, std::uint32_t to);

 private:
  struct CutPlace {
    TriangleId triangle = kNone;
    int corner = -1;  ///< >= 0: at this corner.
    int side = -1;    ///< >= 0: on the edge opposite to this corner.
  };
  [[nodiscard]] LatticePoint at(std::uint32_t node) const noexcept { return nodes[node].at; }
  [[nodiscard]] CutPlace place_in(TriangleId t, LatticePoint p) const noexcept;
  [[nodiscard]] CutPlace locate(LatticePoint p);
  [[nodiscard]] std::vector<TriangleId> star(std::uint32_t v) const;
  void split_triangle(TriangleId t, std::uint32_t node);
  void split_edge(TriangleId t, int side, std::uint32_t node);
  [[nodiscard]] bool can_split_edge(TriangleId t, int side, LatticePoint p) const noexcept;
  void toggle_border(std::uint32_t a, std::uint32_t b);
  void trace(std::uint32_t from, LatticePoint target, std::uint32_t to,
             const BorderSegment& segment);
  /// One step of trace(): the next node on the way from `v`, kNone when the way leaves the mesh.
  std::uint32_t next_on_the_way(std::uint32_t v, LatticePoint target, std::uint32_t to,
                                const BorderSegment& segment);
  /// The node where the way v -> target crosses the edge opposite to `side` of `t`: new, or an end
  /// of the edge.
  std::uint32_t cross_edge(TriangleId t, int side, LatticePoint v, LatticePoint target,
                           const BorderSegment& segment);
  [[nodiscard]] CutNode crossing(std::uint32_t a, std::uint32_t b, LatticePoint v,
                                 LatticePoint target, const BorderSegment& segment) const;
  /// The first node of the mesh's outline that a segment with both ends outside meets.
  std::uint32_t entry_of(const BorderSegment& segment);

  TriangleId hint_ = 0;
};

}  // namespace ptin::tools
