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

/// The plain values of buckets.
struct PointBuckets::Kept {
  PointCounts counts;
  std::uint64_t size, bucket_points;
  std::uint64_t codes_are_whole;
};

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
  const Kept kept{index_.counts, index_.size, index_.bucket_points,
                  index_.codes_are_whole ? 1U : 0U};
  ArrayFileWriter file(files, index);
  file.put(std::span(&kept, 1));
  put_frame(file, index_.frame);
  file.put(index_.empty_inputs);
  put_warnings(file, index_.warnings);
  file.put(index_.hull.corners());
  file.put(index_.ranges);
  file.put(boxes_.boxes());
  file.put(index_.ends);
  file.put(index_.checksums);
  put_edges(file, index_.fixed);
  file.sync();
  return file.finish();
}

PointBuckets PointBuckets::load(FileLayer& files, const std::string& buckets,
                                const std::string& index, const ArrayFileFacts& facts) {
  ArrayFileReader file(index, facts);
  const Kept kept = file.take<Kept>()[0];
  Index result;
  result.frame = take_frame(file);
  result.counts = kept.counts;
  result.size = kept.size;
  result.bucket_points = kept.bucket_points;
  result.codes_are_whole = kept.codes_are_whole != 0;
  result.empty_inputs = file.take_copy<std::uint64_t>();
  result.warnings = take_warnings(file);
  result.hull = ConvexHull(file.take_copy<GridPoint>());
  result.ranges = file.take_copy<Range>();
  result.boxes = file.take_copy<GridBox>();
  result.ends = file.take_copy<std::uint64_t>();
  result.checksums = file.take_copy<std::uint64_t>();
  result.fixed = take_edges(file);
  PointBuckets points(files, buckets, std::move(result));
  points.require_whole();
  return points;
}

}  // namespace ptin
