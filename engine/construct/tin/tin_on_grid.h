// SPDX-License-Identifier: GPL-3.0-or-later
//
// From a file of vertices and triangles that name them to triangles on the grid, each with its
// corners: joined by sorting, in bounded memory.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <stop_token>
#include <string>
#include <vector>

#include "engine/construct/grid/grid_vertex.h"
#include "engine/construct/grid/height_fit.h"
#include "engine/construct/grid/point_grid.h"
#include "engine/construct/grid/source_options.h"
#include "engine/construct/grid/source_warning.h"
#include "engine/construct/grid/terrain_frame.h"
#include "engine/construct/scratch/record_file.h"
#include "engine/construct/tin/tin_faults.h"
#include "engine/geometry/point.h"
#include "storage/file/external_sorter.h"

namespace ptin {

/// The index of the vertex with this key among vertices in the order of their keys.
/// REQUIRES: there is such a vertex. Cost: O(log n).
[[nodiscard]] VertexId vertex_number(std::span<const GridVertex> vertices, VertexKey key) noexcept;

/// A triangle that holds its corners, so that it needs no list of vertices.
struct GridTriangle {
  std::uint64_t place = 0;            ///< Place of the first corner along the curve (PointOrder).
  std::array<GridVertex, 3> corners;  ///< In turn, from the one with the smallest key on.

  [[nodiscard]] std::int64_t area() const noexcept;  ///< orient() of its corners: twice the area.
  /// Along the curve: by the place of the first corner, then by the keys of the second and the third.
  friend bool operator<(const GridTriangle& a, const GridTriangle& b) noexcept;
};

class PointOrder;

/// Makes a triangle of three corners; keeps which way round they go.
[[nodiscard]] GridTriangle grid_triangle(const std::array<GridVertex, 3>& corners,
                                         const PointOrder& order) noexcept;

/// The vertices of triangles, each once, in the order of their keys. Cost: O(n log n).
[[nodiscard]] std::vector<GridVertex> vertices_of(std::span<const GridTriangle> triangles);

/// Triangles that are wrong by themselves.
struct OrientationFaults {
  TinFault no_area;
  /// Triangles that have an area in the file, and on the grid none or go the other way round:
  /// snapping spoiled them. At most 65536 are kept.
  std::vector<GridTriangle> slivers;
  std::uint64_t more_slivers = 0;  ///< How many slivers there are besides.
};

/// All triangles of a file, on the grid.
struct TinOnGrid {
  PointGrid grid;
  std::string crs, vertical_crs;
  DeclaredUnits units;
  SourceWarnings warnings;
  HeightFit heights;
  /// Counter-clockwise, those that are clockwise in the file turned; but for slivers.
  std::unique_ptr<ExternalSorter<GridTriangle>> triangles;
  /// Distinct positions of the vertices of triangles, along the curve.
  std::unique_ptr<RecordFile<std::uint64_t>> places;
  std::uint64_t turned_triangles = 0;  ///< Those that went round unlike most.
  OrientationFaults faults;
  TinFault heights_differ;  ///< Positions with several heights.
  // As TinCounts (tin/tin_source.h).
  std::uint64_t left_out_triangles = 0;
  std::uint64_t unused_vertices = 0;
  std::uint64_t merged_vertices = 0;
  double largest_shift_plan = 0.0;
};

/// How a file is read. Options and memory must outlive the reading.
struct TinGridReading {
  const SourceOptions& options;
  const ExternalMemory& memory;
  std::stop_token stop;
  std::function<void(const char* stage, std::uint64_t done, std::uint64_t total)> progress;
};

/// Reads the file once. By which rules vertices are snapped, tin/tin_source.h says.
/// @throws Error as read_tin_file(); invalid_argument  an id that no vertex has, or that two have;
///               no triangle has a height; io_error, resource_exhausted (the disk is full)
/// Cost: O(n log n). Disk: about 500 bytes a vertex for a while, 130 in the end. Memory:
/// reading.memory.bytes.
[[nodiscard]] TinOnGrid read_on_grid(const std::string& path, const TinGridReading& reading);

}  // namespace ptin
