// SPDX-License-Identifier: GPL-3.0-or-later
//
// Buckets of points that outlive the process.
#include <type_traits>
#include <utility>

#include "engine/construct/grid/frame_file.h"
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
  // Tiles of points have longer borders than squares, and push up more: their files took 42 bytes a
  // point for 3 million points, and 67 for 1 million.
  return {.while_reading = points * (PointSpool::kRecordBytes + sorted),
          .spooled = points * PointSpool::kRecordBytes,
          .kept = points * kMostPackedBytes,
          .tiles_of_vertex = 79.0,
          .output_of_vertex = kPointOutputOfVertex};
}

ArrayFileFacts PointBuckets::save(FileLayer& files, const std::string& index) const {
  static_assert(std::is_trivially_copyable_v<Kept>);
  file_->sync();
  const Kept kept{counts_, size_, bucket_points_, codes_are_whole_ ? 1U : 0U};
  ArrayFileWriter file(files, index);
  file.put(std::span(&kept, 1));
  put_frame(file, frame_);
  file.put(hull_.corners());
  file.put(boxes_.boxes());
  file.put(ends_);
  file.put(checksums_);
  file.put(fixed_.vertices());
  file.put(fixed_.edges());
  file.put(fixed_.sides_without_ground());
  file.sync();
  return file.facts();
}

PointBuckets PointBuckets::load(FileLayer& files, const std::string& buckets,
                                const std::string& index, const ArrayFileFacts& facts) {
  ArrayFileReader file(index, facts);
  const Kept kept = file.take<Kept>()[0];
  PointBuckets result;
  result.frame_ = take_frame(file);
  result.counts_ = kept.counts;
  result.size_ = kept.size;
  result.bucket_points_ = kept.bucket_points;
  result.codes_are_whole_ = kept.codes_are_whole != 0;
  result.hull_ = ConvexHull(file.take_copy<GridPoint>());
  result.boxes_ = PackedBoxes(file.take_copy<GridBox>());
  result.ends_ = file.take_copy<std::uint64_t>();
  result.checksums_ = file.take_copy<std::uint64_t>();
  LineGraph lines;
  lines.vertices = file.take_copy<LineVertex>();
  lines.edges = file.take_copy<LineEdge>();
  lines.without_ground = file.take_copy<SideWithoutGround>();
  file.require_undamaged();
  result.fixed_ = FixedEdges(std::move(lines));
  result.file_ = std::make_unique<ScratchFile>(files, buckets, ScratchFile::Kept::kExisting);
  result.path_ = buckets;
  return result;
}

}  // namespace ptin
