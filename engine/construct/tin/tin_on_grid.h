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

#include "engine/construct/grid/height_fit.h"
#include "engine/construct/grid/point_grid.h"
#include "engine/construct/grid/source_options.h"
#include "engine/construct/grid/terrain_frame.h"
#include "engine/construct/scratch/external_sorter.h"
#include "engine/construct/scratch/record_file.h"
#include "engine/construct/tin/tin_faults.h"
#include "engine/geometry/point.h"

namespace ptin {

/// A vertex on the grid, its height as PointGrid::height() has it.
struct GridVertex {
  GridPoint position;
  double height = 0.0;
};

/// Where the vertex of a key stands among vertices in the order of their keys.
/// REQUIRES: it is among them. Cost: O(log n).
[[nodiscard]] VertexId vertex_number(std::span<const GridVertex> vertices, VertexKey key) noexcept;

/// A triangle by itself.
struct GridTriangle {
  std::uint64_t place = 0;            ///< Of the first corner, along the curve (PointOrder).
  std::array<GridVertex, 3> corners;  ///< From the one with the smallest key on.

  [[nodiscard]] std::int64_t area() const noexcept;  ///< orient() of its corners.
};

class PointOrder;

/// Makes one of three corners; keeps which way round they go.
[[nodiscard]] GridTriangle grid_triangle(const std::array<GridVertex, 3>& corners,
                                         const PointOrder& order) noexcept;

/// Along the curve, by the first corner; those of one vertex by the others.
struct ByPlace {
  bool operator()(const GridTriangle& a, const GridTriangle& b) const noexcept;
};
using TriangleSorter = ExternalSorter<GridTriangle, ByPlace>;

/// What is wrong with triangles one by one, if those that are counter-clockwise (or clockwise) are
/// the right ones.
struct OrientationFaults {
  TinFault no_area, turned_over;
  /// Upright in the file and not on the grid: snapping spoiled them.
  std::vector<GridTriangle> slivers;
  std::uint64_t more_slivers = 0;  ///< Than are kept.
};

/// All triangles of a file, on the grid.
struct TinOnGrid {
  PointGrid grid;
  std::string crs, vertical_crs;
  HeightFit heights;
  std::unique_ptr<TriangleSorter> triangles;  ///< As the file has them, turned over or not.
  /// Distinct positions of the vertices of triangles, along the curve.
  std::unique_ptr<RecordFile<std::uint64_t>> places;
  bool is_clockwise = false;  ///< Most of them are: all are to be turned.
  OrientationFaults faults;   ///< Seen so.
  TinFault heights_differ;    ///< Positions with several heights.
  std::uint64_t left_out_triangles = 0;
  std::uint64_t unused_vertices = 0;
  std::uint64_t merged_vertices = 0;
  double largest_shift_plan = 0.0;
};

/// How it is read.
struct TinGridReading {
  const SourceOptions& options;
  const ExternalMemory& memory;
  std::stop_token stop;
  std::function<void(const char* stage, std::uint64_t done, std::uint64_t total)> progress;
};

/// Reads the file once (tin_source.h says by which rules vertices are snapped).
/// @throws Error as read_tin_file(); invalid_argument  an id that no vertex has, or that two have;
///               no triangle has a height; io_error, resource_exhausted (the disk is full)
/// Cost: O(n log n). Disk: about 500 bytes a vertex for a while, 130 in the end. Memory: that
/// given.
[[nodiscard]] TinOnGrid read_on_grid(const std::string& path, const TinGridReading& reading);

}  // namespace ptin
