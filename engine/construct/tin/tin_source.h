// SPDX-License-Identifier: GPL-3.0-or-later
//
// A TIN of somebody else's as a terrain, of any size: read, snapped to the grid, checked, made
// convex, and taken tile by tile.
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
#include "engine/construct/grid/terrain_frame.h"
#include "engine/construct/scratch/array_file.h"
#include "engine/construct/scratch/external_sorter.h"
#include "engine/construct/scratch/record_file.h"
#include "engine/construct/tin/tin_on_grid.h"
#include "engine/geometry/convex_hull.h"
#include "engine/mesh/tin.h"

namespace ptin {

/// What happened on the way from the file.
struct TinCounts {
  std::uint64_t vertices = 0;  ///< Distinct positions, of triangles.
  std::uint64_t surface_triangles = 0;
  std::uint64_t void_triangles = 0;      ///< That fill up the convex hull.
  std::uint64_t left_out_triangles = 0;  ///< Hidden ones, and those with a corner of no height.
  std::uint64_t unused_vertices = 0;     ///< In no triangle: left out.
  std::uint64_t merged_vertices = 0;     ///< Shared a position and a height with another.
  std::uint64_t mended_triangles = 0;    ///< Slivers that snapping spoiled: edges flipped.
  double largest_shift_plan = 0.0;       ///< How far snapping moved a vertex, CRS units.
};

/// The full TIN of a file of triangles, on disk.
///
/// The grid is that of points (point_buckets.h), but that digits beyond it are dropped: programs
/// write TINs with all digits of a double. Without a resolution the unit is the smallest power of
/// ten that keeps every digit or, where that spans more than 2^30 units, the smallest that does
/// not; largest_shift_plan says what that moved. Vertices that share a position and a height are
/// one; slivers that snapping flattens or turns over are flipped away (sliver_flips.h). Concave
/// borders and holes are filled with void triangles up to the convex hull.
///
/// Threads: const members from any number at once.
class TinTriangles {
 public:
  using Progress = std::function<void(const char* stage, std::uint64_t done, std::uint64_t total)>;

  /// Reads one TIN (tin_soup.h says from what) once.
  /// @param keep_as  Stem of kept_files(), which must not exist: the triangles stay in them, so
  /// that
  ///                 load() can take them up; "" keeps them in files without names.
  /// @throws Error  as read_tin_file()
  ///                invalid_argument    this is no terrain: triangles without area (after
  ///                snapping),
  ///                                    turned over or over one another, positions with several
  ///                                    heights, T-junctions; the message counts each kind and
  ///                                    names its first place. An id that no vertex has, or that
  ///                                    two have. A bbox is asked for. The CRS is not understood
  ///                resource_exhausted  the disk is full; the border does not fit into memory.bytes
  ///                io_error, cancelled
  /// Cost: O(n log n), about 2 us a triangle. Disk: about 500 bytes a vertex while it is sorted,
  /// 130 in the end; in memory.folder. Memory: memory.bytes, of which the border takes
  /// kBytesOfBorderEdge for an edge; beyond kMostBorderInMemory edges it is swept over
  /// (void_sweep.h).
  static TinTriangles read(const std::string& path, const SourceOptions& options,
                           const ExternalMemory& memory, const std::stop_token& stop = {},
                           const Progress& progress = {}, const std::string& keep_as = "");

  [[nodiscard]] static std::array<std::string, 3> kept_files(const std::string& stem);
  /// Writes all but the triangles to `index`, and makes all files durable.
  /// @throws Error io_error, resource_exhausted
  [[nodiscard]] ArrayFileFacts save(FileLayer& files, const std::string& index);
  /// Takes up what read() kept and save() wrote.
  /// @throws Error corruption  a file is not what was written; not_found, io_error, cancelled
  /// Cost: one reading of the triangles, to check them.
  static TinTriangles load(FileLayer& files, const std::string& kept_as, const std::string& index,
                           const ArrayFileFacts& facts, const std::stop_token& stop = {},
                           const std::function<void(std::uint64_t, std::uint64_t)>& progress = {});

  /// What read() takes of the disk for so many vertices.
  [[nodiscard]] static SourceDisk disk_of(std::uint64_t vertices) noexcept;

  [[nodiscard]] const TerrainFrame& frame() const noexcept { return frame_; }
  [[nodiscard]] const TinCounts& counts() const noexcept { return counts_; }
  [[nodiscard]] const ConvexHull& hull() const noexcept { return hull_; }

  /// Part `i` of `n`: the triangles, surface and void, whose smallest vertex (by key: the lowest,
  /// then leftmost) is one of the vertices i / n to (i + 1) / n along the curve. In general a
  /// polygon with holes, of several pieces, that may touch itself at a vertex. Vertices are in the
  /// order of their keys. Every triangle is in one part.
  /// @throws Error io_error; resource_exhausted  more triangles than one mesh in memory counts
  /// Cost: linear but for sorting; 130 bytes a triangle while it runs.
  [[nodiscard]] Tin part(std::uint64_t i, std::uint64_t n) const;

  /// What an edge of the border takes in memory while pockets and holes are triangulated.
  static constexpr std::uint64_t kBytesOfBorderEdge = 320;
  /// Borders of so many edges are triangulated in memory, which gives better triangles; larger ones
  /// are swept over. Whatever the memory, since it decides the bytes of the output: so few that
  /// their 20 MiB are less than the half of what any build needs for its smallest tile.
  static constexpr std::uint64_t kMostBorderInMemory = std::uint64_t{1} << 16;

 private:
  struct Kept;
  TinTriangles() = default;
  [[nodiscard]] std::uint64_t place_of_part(std::uint64_t i, std::uint64_t n) const;
  void take(const RecordFile<GridTriangle>& from, std::uint64_t begin, std::uint64_t end,
            std::vector<GridTriangle>& triangles) const;

  TerrainFrame frame_;
  TinCounts counts_;
  ConvexHull hull_;
  bool codes_are_whole_ = false;
  std::unique_ptr<RecordFile<GridTriangle>> surface_, voids_;
  std::unique_ptr<RecordFile<std::uint64_t>> places_;
};

}  // namespace ptin
