// SPDX-License-Identifier: GPL-3.0-or-later
//
// Somebody's TIN, of any size, as a terrain: read, snapped to the grid, checked, made convex, and
// taken tile by tile.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <stop_token>
#include <string>
#include <vector>

#include "engine/construct/grid/source_disk.h"
#include "engine/construct/grid/source_options.h"
#include "engine/construct/grid/source_warning.h"
#include "engine/construct/grid/terrain_frame.h"
#include "engine/construct/scratch/array_file.h"
#include "engine/construct/scratch/record_file.h"
#include "engine/construct/tin/tin_on_grid.h"
#include "engine/geometry/convex_hull.h"
#include "engine/mesh/tin.h"
#include "storage/file/external_sorter.h"

namespace ptin {

/// What happened on the way from the file.
struct TinCounts {
  std::uint64_t vertices = 0;  ///< Distinct positions of corners.
  std::uint64_t surface_triangles = 0;
  std::uint64_t void_triangles = 0;      ///< That fill up the convex hull.
  std::uint64_t left_out_triangles = 0;  ///< Hidden ones, and those with a corner without a height.
  std::uint64_t unused_vertices = 0;     ///< In no triangle that stays: left out.
  std::uint64_t merged_vertices = 0;     ///< Shared a position and a height with another vertex.
  std::uint64_t mended_triangles = 0;    ///< Bad ones taken away in mending what snapping spoiled.
  double largest_shift_plan = 0.0;       ///< The farthest that snapping moved a vertex, CRS units.
};

/// The full TIN of a file of triangles, on disk.
///
/// The grid is chosen as that of points (points/point_source.h): digits for which it has no room are
/// dropped, and largest_shift_plan says how far that moved vertices. Vertices that share a position and a height
/// are one. Slivers that snapping flattens or turns over are flipped away (tin/sliver_flips.h).
/// Concave borders and holes are filled with void triangles up to the convex hull.
///
/// Threads: const members from any number at once.
class TinTriangles {
 public:
  using Progress = std::function<void(const char* stage, std::uint64_t done, std::uint64_t total)>;

  /// Reads one TIN once. Which formats there are, read/tin_file.h says.
  /// @param keep_as  The triangles stay in kept_files(keep_as), which must not exist, so that
  ///                 load() can take them up; "" keeps them in files without names.
  /// @throws Error  as read_tin_file()
  ///                invalid_argument    this is no terrain: triangles without area (after
  ///                snapping),
  ///                                    turned over or over one another, positions with several
  ///                                    heights, T-junctions; the message counts each kind and
  ///                                    names its first place. An id that no vertex has, or that
  ///                                    two have. A bbox is asked for. The CRS is not understood
  ///                resource_exhausted  the disk is full; the border, or what surrounds slivers,
  ///                does
  ///                                    not fit into memory.bytes
  ///                io_error, cancelled
  /// Cost: O(n log n), about 2 us a triangle. Disk: about 500 bytes a vertex while it is sorted,
  /// 130 in the end; in memory.folder. Memory: memory.bytes, of which a border of up to
  /// kMostBorderInMemory edges takes kBytesOfBorderEdge for each; a longer border is swept over
  /// (tin/void_sweep.h).
  static TinTriangles read(const std::string& path, const SourceOptions& options,
                           const ExternalMemory& memory, const std::stop_token& stop = {},
                           const Progress& progress = {}, const std::string& keep_as = "");

  /// The files in which read() keeps its triangles as `stem`.
  [[nodiscard]] static std::array<std::string, 3> kept_files(const std::string& stem);
  /// Writes all but what is in kept_files() to the file `index`, and makes all files durable.
  /// @return  What load() needs to know of `index`.
  /// @throws Error io_error, resource_exhausted
  [[nodiscard]] ArrayFileFacts save(FileLayer& files, const std::string& index);
  /// Takes up what read() kept as `kept_as` and save() wrote to `index`.
  /// @throws Error corruption  the index is not what was written; not_found, io_error
  /// Cost: reads the index; triangles are checked whenever they are taken.
  static TinTriangles load(FileLayer& files, const std::string& kept_as, const std::string& index,
                           const ArrayFileFacts& facts);

  /// What read() takes of the disk for so many vertices.
  [[nodiscard]] static SourceDisk disk_of(std::uint64_t vertices) noexcept;

  [[nodiscard]] const TerrainFrame& frame() const noexcept { return frame_; }
  [[nodiscard]] const TinCounts& counts() const noexcept { return counts_; }
  [[nodiscard]] const SourceWarnings& warnings() const noexcept { return warnings_; }
  [[nodiscard]] const ConvexHull& hull() const noexcept { return hull_; }

  /// Part `i` of `n`. The vertices are cut along the curve into n pieces of equally many; the part
  /// has the triangles, surface and void, whose smallest vertex (by key: the lowest, then leftmost)
  /// is in piece i. So every triangle is in one part. A part is in general a polygon with holes, of
  /// several pieces, that may touch itself at a vertex. Its vertices are in the order of their
  /// keys.
  /// @throws Error io_error, corruption; resource_exhausted  more triangles than one mesh in memory counts
  /// Cost: linear but for sorting; 130 bytes a triangle while it runs.
  [[nodiscard]] Tin part(std::uint64_t i, std::uint64_t n) const;

  /// What an edge of the border takes in memory while pockets and holes are triangulated there.
  static constexpr std::uint64_t kBytesOfBorderEdge = 320;
  /// Borders of up to so many edges are triangulated in memory, which gives better triangles;
  /// larger ones are swept over. The number is the same whatever the memory, since it decides the
  /// bytes of the output. It is so small that the 20 MiB that it takes are less than half of what
  /// any build needs for its smallest tile.
  static constexpr std::uint64_t kMostBorderInMemory = std::uint64_t{1} << 16;

 private:
  TinTriangles() = default;
  [[nodiscard]] std::uint64_t place_of_part(std::uint64_t i, std::uint64_t n) const;
  void take(const RecordFile<GridTriangle>& from, std::uint64_t begin, std::uint64_t end,
            std::vector<GridTriangle>& triangles) const;

  TerrainFrame frame_;
  TinCounts counts_;
  SourceWarnings warnings_;
  ConvexHull hull_;
  bool codes_are_whole_ = false;
  std::unique_ptr<RecordFile<GridTriangle>> surface_, voids_;
  std::unique_ptr<RecordFile<std::uint64_t>> places_;  ///< Places of all vertices along the curve.
};

}  // namespace ptin
