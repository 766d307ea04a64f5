// SPDX-License-Identifier: GPL-3.0-or-later
//
// Buckets of points that outlive the process.
#include <utility>

#include "engine/construct/grid/frame_file.h"
#include "engine/construct/grid/point_sorter.h"
#include "engine/construct/grid/warnings_file.h"
#include "engine/construct/lines/edges_file.h"
#include "engine/construct/points/packed_bucket.h"
#include "engine/construct/points/point_buckets.h"
#include "engine/construct/points/point_spool.h"

namespace ptin {

namespace {

/// What is kept of an index; its hull and its boxes are told apart.
template <class File, class Index, class Corners, class Boxes>
void serialize_index(File& file, Index& index, Corners& hull, Boxes&& boxes) {
  file.values(index.counts, index.size, index.bucket_points, index.codes_are_whole, index.frame,
              index.empty_inputs, index.warnings, hull, index.ranges, boxes, index.ends,
              index.checksums, index.fixed);
}

}  // namespace

SourceDisk PointBuckets::disk_of(std::uint64_t points, PointMerge rule) noexcept {
  const std::uint64_t sorted =
      rule == PointMerge::kFirst ? sizeof(NumberedHeight) : sizeof(KeyedHeight);
  // Points are spooled, and shared out among ranges beside that. The spools go, and beside what was
  // shared out come the buckets, and the runs of those ranges that are sorted on disk: of the few that
  // are too large for memory, as many as there are threads.
  // Tiles of points have longer borders than squares, and push up more: their files took 42 bytes a
  // point for 3 million points, and 67 for 1 million.
  return {.while_reading = points * (kSpooledBytes + sorted),
          .spooled = points * kSpooledBytes,
          .kept = points * kMostPackedBytes,
          .tiles_of_vertex = 79.0,
          .output_of_vertex = kPointOutputOfVertex};
}

ArrayFileFacts PointBuckets::save(FileLayer& files, const std::string& index) const {
  for (const auto& file : files_) {
    file->sync();
  }
  ArrayFileWriter file(files, index);
  serialize_index(file, index_, index_.hull.corners(), boxes_.boxes());
  file.sync();
  return file.finish();
}

PointBuckets PointBuckets::load(FileLayer& files, const std::string& buckets,
                                const std::string& index, const ArrayFileFacts& facts) {
  ArrayFileReader file(index, facts);
  Index result;
  std::vector<GridPoint> hull;
  serialize_index(file, result, hull, result.boxes);
  result.hull = ConvexHull(std::move(hull));
  PointBuckets points(files, buckets, std::move(result));
  points.require_whole();
  return points;
}

}  // namespace ptin
