// SPDX-License-Identifier: GPL-3.0-or-later
//
// Whether triangles on the grid are a terrain: strictly counter-clockwise, beside one another, each
// point covered at most once. Exact.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "engine/geometry/affine.h"
#include "engine/geometry/point.h"
#include "engine/mesh/tin.h"

namespace ptin {

using Corners = std::array<VertexId, 3>;

/// A directed edge with a triangle on its left and none on its right.
struct BorderEdge {
  VertexId from, to;
};

/// One kind of fault: how often, and where first.
struct TinFault {
  std::uint64_t count = 0;
  GridPoint first;

  void add(GridPoint where) {
    if (count++ == 0) {
      first = where;
    }
  }
};

/// Everything that can be wrong with triangles.
struct TinFaults {
  TinFault no_area;      ///< Triangles whose corners lie on one line or coincide.
  TinFault turned_over;  ///< Triangles that the grid turned over, beyond mending.
  /// Triangles of the source that go another way round than most. No fault by themselves.
  std::uint64_t turned_in_source = 0;
  TinFault heights;       ///< Positions with several heights.
  TinFault shared_edges;  ///< Edges that more than one triangle has on the same side.
  TinFault t_junctions;   ///< Vertices inside of an edge of the border.
  TinFault crossings;     ///< Edges of the border that cross.
  TinFault covered;       ///< Pieces of the plane that are covered more than once.

  /// @param map   From the grid to the CRS, for the places in the message.
  /// @param path  Path of the TIN, for the message.
  /// @throws Error invalid_argument  there is a fault; the message counts each kind and names its
  ///                                 first place
  void refuse(const AffineMap& map, const std::string& path) const;
};

}  // namespace ptin
