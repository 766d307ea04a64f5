// SPDX-License-Identifier: GPL-3.0-or-later
//
// Any number of points on the grid, on disk: merged, in the order of the Hilbert curve, cut into
// buckets of equal size whose boxes are kept in memory.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <stop_token>
#include <string>
#include <vector>

#include "engine/construct/grid/point_sorter.h"
#include "engine/construct/grid/source_disk.h"
#include "engine/construct/grid/source_options.h"
#include "engine/construct/grid/terrain_frame.h"
#include "engine/construct/lines/fixed_edges.h"
#include "engine/construct/scratch/array_file.h"
#include "engine/geometry/box.h"
#include "engine/geometry/convex_hull.h"
#include "engine/geometry/packed_boxes.h"
#include "engine/geometry/point.h"
#include "storage/file/file_layer.h"

namespace ptin {

/// A point on the grid.
struct BucketPoint {
  GridPoint position;
  HeightBits height = 0;
};

/// What happened on the way from the source to the buckets.
struct PointCounts {
  std::uint64_t source_points = 0;    ///< Read and not left out.
  std::uint64_t left_out_points = 0;  ///< By class or place, withheld, or without a height.
  std::uint64_t merged_points = 0;    ///< source_points less the distinct positions.
  /// How far a point moved at most: in plan when it was snapped to the grid (CRS units; 0 where the
  /// grid keeps every digit), and in height when it was merged (height's unit).
  double largest_shift_plan = 0.0;
  double largest_shift_height = 0.0;
};

/// Points in buckets. Skewed sources are no worse than even ones: buckets hold equally many points,
/// however far apart. Threads: const members from any number at once.
class PointBuckets {
 public:
  using Progress = std::function<void(const char* stage, std::uint64_t done, std::uint64_t total)>;

  /// Reads the sources once, puts what they hold on one grid, and sorts it.
  ///
  /// Grid: the unit is `options.resolution`, and the origin a multiple of it. Without a resolution
  /// the unit is the power of ten of the CRS unit that keeps every digit of every x and y, and the
  /// origin is the smallest x and y. LAS declares its digits with its scale factor. Where a scale
  /// factor is no power of ten, the smallest of such files is the unit, and the origin is aligned
  /// with the offset of its file.
  /// Merging: points that fall together become one. `options.merge` decides its height: by default
  /// the mean, rounded to a code where heights are codes.
  /// Lines: the vertices of `options.lines`, noded (lines/line_noding.h), are points too. A point
  /// that falls on one of them is merged into it, whatever the rule: the line's height stands. Points
  /// outside of the boundary are left out.
  /// Heights: int32 with the power of ten that keeps every digit, where that fits; else as for a
  /// Float64 raster (grid/height_fit.h).
  /// CRS: `options.a_srs`, else the CRS that all files declare.
  ///
  /// The result depends on the set of points alone, not on their order or the files that they come
  /// from; but for PointMerge::kFirst, which goes by both.
  ///
  /// Disk, in memory.folder: 27 bytes a point while points are read, 43 (for kFirst 51) while they
  /// are sorted, then
  /// at most 16, mostly half of that (points/packed_bucket.h). Memory: memory.bytes, and 32 bytes
  /// for each of at most 2^20 buckets.
  /// @param keep_as  A file that must not exist: the buckets stay in it, so that load() can take
  ///                 them up; "" keeps them in a file without a name.
  /// @throws Error  not_found, io_error, unsupported_version  as open_point_stream()
  ///                invalid_argument    as the streams; CRSs that differ; no points; fewer than 3
  ///                                    distinct ones; all collinear; an extent of more than 2^30
  ///                                    grid units (the message names a resolution)
  ///                resource_exhausted  the disk is full
  ///                cancelled           `stop` fired
  static PointBuckets read(const std::vector<std::string>& paths, const SourceOptions& options,
                           const ExternalMemory& memory, const std::stop_token& stop = {},
                           const Progress& progress = {}, const std::string& keep_as = "");
  /// What read() takes of the disk for so many points.
  [[nodiscard]] static SourceDisk disk_of(std::uint64_t points,
                                          PointMerge rule = PointMerge::kMean) noexcept;

  /// Writes all but the points to the file `index`, and makes both files durable.
  /// @return  What load() needs to know of `index`.
  /// @throws Error io_error, resource_exhausted
  [[nodiscard]] ArrayFileFacts save(FileLayer& files, const std::string& index) const;
  /// Takes up what read() kept in the file `buckets` and save() wrote to `index`.
  /// @throws Error corruption  the index is not what was written; not_found, io_error
  /// Cost: reads the index; a bucket is checked whenever it is taken.
  static PointBuckets load(FileLayer& files, const std::string& buckets, const std::string& index,
                           const ArrayFileFacts& facts);

  [[nodiscard]] const TerrainFrame& frame() const noexcept { return frame_; }
  [[nodiscard]] const PointCounts& counts() const noexcept { return counts_; }
  [[nodiscard]] const ConvexHull& hull() const noexcept { return hull_; }
  /// The edges of breaklines and of the boundary. Their vertices are among the points.
  [[nodiscard]] const FixedEdges& fixed_edges() const noexcept { return fixed_; }
  /// The stored height of vertex `number` of the fixed edges.
  [[nodiscard]] HeightBits fixed_height(std::uint32_t number) const {
    return stored(fixed_.vertices()[number].height);
  }
  /// Distinct positions.
  [[nodiscard]] std::uint64_t size() const noexcept { return size_; }
  /// Points of each bucket; the last one may have fewer.
  [[nodiscard]] std::uint64_t bucket_points() const noexcept { return bucket_points_; }
  [[nodiscard]] std::uint64_t buckets() const noexcept { return boxes_.boxes().size(); }
  [[nodiscard]] const GridBox& box(std::uint64_t bucket) const noexcept {
    return boxes_.boxes()[bucket];
  }
  /// Points first .. first + count - 1 in the order of the curve.
  /// @throws Error corruption  a bucket is not what was written; io_error
  void take(std::uint64_t first, std::uint64_t count, std::vector<BucketPoint>& points) const;

  /// Calls visit(bucket) for each bucket with meets(box of the bucket), the nearest to `from`
  /// first, until visit() returns false. Where meets() holds for a box it must hold for every box
  /// around that.
  template <class Meets, class Visit>
  void visit_nearest(GridPoint from, const Meets& meets, const Visit& visit) const {
    boxes_.visit_nearest(from, meets, visit);
  }

 private:
  class Writer;
  struct Kept;
  PointBuckets() = default;
  void sort(class PointSpool& spool, const struct PointGrid& grid, PointMerge rule,
            const ExternalMemory& memory, const std::stop_token& stop, const Progress& progress,
            const std::string& keep_as);
  template <class Sorter>
  void sort_by(class PointSpool& spool, const struct PointGrid& grid, PointMerge rule,
               const ExternalMemory& memory, const std::stop_token& stop, const Progress& progress,
               const std::string& keep_as);
  template <class Sorter>
  void add_unless_fixed(const struct SourcePoint& p, const struct PointGrid& grid,
                        const class PointOrder& order, Sorter& sorter);
  template <class Sorter>
  void add_fixed_vertices(const class PointOrder& order, Sorter& sorter);
  /// A height as the file of buckets holds it, as terrains store it.
  [[nodiscard]] HeightBits stored(double height) const;
  void require_undamaged(std::uint64_t bucket, std::span<const std::byte> bytes) const;
  /// Where a bucket begins in the file.
  [[nodiscard]] std::uint64_t begin_of(std::uint64_t bucket) const noexcept {
    return bucket == 0 ? 0 : ends_[bucket - 1];
  }

  TerrainFrame frame_;
  PointCounts counts_;
  ConvexHull hull_;
  std::uint64_t size_ = 0;
  std::uint64_t bucket_points_ = 1024;
  bool codes_are_whole_ = false;  ///< Heights on disk are codes.
  std::unique_ptr<ScratchFile> file_;
  std::vector<std::uint64_t> ends_;       ///< Where each bucket ends in the file.
  std::vector<std::uint64_t> checksums_;  ///< Of the buckets.
  std::string path_;                      ///< Of a file that was kept, for errors.
  PackedBoxes boxes_;                     ///< Those of the buckets.
  FixedEdges fixed_;
};

}  // namespace ptin
