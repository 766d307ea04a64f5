// SPDX-License-Identifier: GPL-3.0-or-later
//
// Any number of points on the grid, on disk: merged, in the order of the Hilbert curve, cut into
// buckets whose boxes are kept in memory.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "engine/construct/grid/left_out.h"
#include "engine/construct/grid/point_classes.h"
#include "engine/construct/grid/source_disk.h"
#include "engine/construct/grid/source_options.h"
#include "engine/construct/grid/source_warning.h"
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
  std::uint64_t source_points = 0;  ///< Read and not left out.
  LeftOutPoints left_out;
  PointClasses classes;
  std::uint64_t merged_points = 0;  ///< source_points less the distinct positions.
  /// How far a point moved at most: in plan when it was snapped to the grid (CRS units; 0 where the
  /// grid keeps every digit), and in height when it was merged (height's unit).
  double largest_shift_plan = 0.0;
  double largest_shift_height = 0.0;
};

/// Points in buckets: PointSource (points/point_source.h) makes them. Skewed sources are no worse than
/// even ones: buckets hold equally many points, however far apart, but for the last one of each range
/// of the curve, which may have fewer. Threads: const members from any number at once.
class PointBuckets {
 public:
  /// A range of the curve, whose buckets are in one file. None is without points.
  struct Range {
    std::uint64_t file = 0;  ///< Its number.
    std::uint64_t first_point = 0;
    std::uint64_t first_bucket = 0;
  };
  /// All but the points.
  struct Index {
    TerrainFrame frame;
    PointCounts counts;
    std::vector<std::uint64_t> empty_inputs;  ///< The numbers of those that have no point at all.
    SourceWarnings warnings;                  ///< Warnings of reading them.
    ConvexHull hull;
    std::uint64_t size = 0;           ///< Distinct positions.
    std::uint64_t bucket_points = 0;  ///< Points of a bucket that is not its range's last.
    bool codes_are_whole = false;     ///< Heights on disk are codes.
    std::vector<Range> ranges;
    std::vector<GridBox> boxes;            ///< Boxes of the buckets.
    std::vector<std::uint64_t> ends;       ///< Where each bucket ends in the file of its range.
    std::vector<std::uint64_t> checksums;  ///< Checksums of the buckets.
    FixedEdges fixed;
  };

  /// @param buckets  The path of the files of buckets, without "-" and the number of a range.
  /// @throws Error not_found, io_error
  PointBuckets(FileLayer& files, const std::string& buckets, Index index);

  /// What reading, sorting and the buckets take of the disk for so many points.
  [[nodiscard]] static SourceDisk disk_of(std::uint64_t points,
                                          PointMerge rule = PointMerge::kMean) noexcept;

  /// Writes all but the points to the file `index`, and makes all files durable.
  /// @return  What load() needs to know of `index`.
  /// @throws Error io_error, resource_exhausted
  [[nodiscard]] ArrayFileFacts save(FileLayer& files, const std::string& index) const;
  /// Takes up buckets, and what save() wrote to `index`.
  /// @param buckets  As of the constructor.
  /// @throws Error corruption  the index is not what was written, or a file of buckets has another
  ///                           length; not_found, io_error
  /// Cost: reads the index; a bucket is checked whenever it is taken.
  static PointBuckets load(FileLayer& files, const std::string& buckets, const std::string& index,
                           const ArrayFileFacts& facts);

  [[nodiscard]] const TerrainFrame& frame() const noexcept { return index_.frame; }
  [[nodiscard]] const PointCounts& counts() const noexcept { return index_.counts; }
  /// The numbers of the inputs that have no point, not even one that was left out.
  [[nodiscard]] const std::vector<std::uint64_t>& empty_inputs() const noexcept {
    return index_.empty_inputs;
  }
  [[nodiscard]] const SourceWarnings& warnings() const noexcept { return index_.warnings; }
  [[nodiscard]] const ConvexHull& hull() const noexcept { return index_.hull; }
  /// The edges of breaklines and of the boundary. Their vertices are among the points.
  [[nodiscard]] const FixedEdges& fixed_edges() const noexcept { return index_.fixed; }
  /// The stored height of vertex `number` of the fixed edges.
  [[nodiscard]] HeightBits fixed_height(std::uint32_t number) const {
    return stored(index_.fixed.vertices()[number].height);
  }
  /// Distinct positions.
  [[nodiscard]] std::uint64_t size() const noexcept { return index_.size; }
  /// The most points of a bucket.
  [[nodiscard]] std::uint64_t bucket_points() const noexcept { return index_.bucket_points; }
  [[nodiscard]] std::uint64_t buckets() const noexcept { return boxes_.boxes().size(); }
  /// The bucket that holds a point, given by its place in the order of the curve. Cost: logarithmic in
  /// the number of ranges.
  [[nodiscard]] std::uint64_t bucket_of(std::uint64_t point) const noexcept;
  /// The points of a bucket are those from begin_of() up to below begin_of() of the next one; size()
  /// for the one behind the last. Cost: as bucket_of().
  [[nodiscard]] std::uint64_t begin_of(std::uint64_t bucket) const noexcept;
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
  void require_whole() const;
  /// A height as the file of buckets holds it, as terrains store it.
  [[nodiscard]] HeightBits stored(double height) const;
  /// The number of the range of a bucket.
  [[nodiscard]] std::size_t range_of(std::uint64_t bucket) const noexcept;
  void read_bucket(std::uint64_t bucket, std::vector<std::byte>& bytes) const;

  Index index_;  ///< But for the boxes.
  PackedBoxes boxes_;
  std::string path_;                                 ///< The files' path, without a number.
  std::vector<std::unique_ptr<ScratchFile>> files_;  ///< By range.
};

}  // namespace ptin
