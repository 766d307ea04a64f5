// SPDX-License-Identifier: GPL-3.0-or-later
//
// Buckets of points that outlive the process.
#include <algorithm>
#include <filesystem>
#include <type_traits>

#include "engine/construct/point_buckets.h"
#include "engine/error.h"
#include "storage/checksum.h"

namespace ptin {

namespace {

// PointSpool's records, what is sorted, and what a bucket holds; point_spool.h, point_sorter.h.
constexpr std::uint64_t kSpooledBytes = 27, kSortedBytes = 16, kStoredBytes = 16;

void put_text(ArrayFileWriter& file, const std::string& text) {
  file.put(std::span<const char>(text));
}

std::string take_text(ArrayFileReader& file) {
  const std::span<const char> text = file.take<char>();
  return {text.begin(), text.end()};
}

}  // namespace

/// The plain values of buckets and their frame.
struct PointBuckets::Kept {
  AffineMap map;
  HeightEncoding heights;
  double height_rounding, height_quantum, min_height, max_height;
  PointCounts counts;
  std::uint64_t size, bucket_points, checksum;
  std::uint32_t vertical_crs_known, geographic, codes_are_whole, unused;
};

SourceDisk PointBuckets::disk_of(std::uint64_t points) noexcept {
  // Tiles of points have longer borders than squares, and push up more: 42 bytes a point were
  // measured for 3 million, 67 for 1 million.
  return {.while_reading = points * (kSpooledBytes + kSortedBytes),
          .kept = points * kStoredBytes,
          .tiles_of_vertex = 72.0};
}

void PointBuckets::add_to_checksum(std::span<const std::byte> bucket) {
  const std::array<std::uint64_t, 2> link{checksum_, checksum_of(bucket)};
  checksum_ = checksum_of_object(link);
}

ArrayFileFacts PointBuckets::save(FileLayer& files, const std::string& index) const {
  static_assert(std::is_trivially_copyable_v<Kept>);
  file_->sync();
  const TerrainFrame& f = frame_;
  const Kept kept{f.map,
                  f.heights,
                  f.height_rounding,
                  f.height_quantum,
                  f.min_height,
                  f.max_height,
                  counts_,
                  size_,
                  bucket_points_,
                  checksum_,
                  f.vertical_crs_known ? 1U : 0U,
                  f.geographic ? 1U : 0U,
                  codes_are_whole_ ? 1U : 0U,
                  0};
  ArrayFileWriter file(files, index);
  file.put(std::span(&kept, 1));
  for (const std::string& text : {f.crs_wkt, f.horizontal_unit, f.vertical_unit}) {
    put_text(file, text);
  }
  file.put(hull_.corners());
  file.put(boxes_.front());
  file.sync();
  return file.facts();
}

void PointBuckets::check_points(const std::string& path, std::uint64_t expected,
                                const std::stop_token& stop,
                                const std::function<void(std::uint64_t, std::uint64_t)>& progress) {
  std::error_code ignored;
  bool is_sound = std::filesystem::file_size(path, ignored) == size_ * sizeof(Stored);
  std::vector<Stored> bucket;
  for (std::uint64_t first = 0; is_sound && first < size_; first += bucket.size()) {
    if (stop.stop_requested()) {
      throw Error(ErrorCode::cancelled, "the build was cancelled");
    }
    bucket.resize(static_cast<std::size_t>(std::min(bucket_points_, size_ - first)));
    file_->read_at(std::as_writable_bytes(std::span(bucket)), first * sizeof(Stored));
    add_to_checksum(std::as_bytes(std::span(bucket)));
    if (progress && first / bucket_points_ % 1024 == 0) {
      progress(first, size_);
    }
  }
  if (!is_sound || checksum_ != expected) {
    throw Error(ErrorCode::corruption,
                "the sorted points of the unfinished build are damaged; start again after "
                "--discard",
                path);
  }
}

PointBuckets PointBuckets::load(FileLayer& files, const std::string& buckets,
                                const std::string& index, const ArrayFileFacts& facts,
                                const std::stop_token& stop,
                                const std::function<void(std::uint64_t, std::uint64_t)>& progress) {
  ArrayFileReader file(index, facts);
  const Kept kept = file.take<Kept>()[0];
  PointBuckets result;
  TerrainFrame& f = result.frame_;
  f.map = kept.map;
  f.heights = kept.heights;
  f.height_rounding = kept.height_rounding;
  f.height_quantum = kept.height_quantum;
  f.min_height = kept.min_height;
  f.max_height = kept.max_height;
  f.vertical_crs_known = kept.vertical_crs_known != 0;
  f.geographic = kept.geographic != 0;
  f.crs_wkt = take_text(file);
  f.horizontal_unit = take_text(file);
  f.vertical_unit = take_text(file);
  result.counts_ = kept.counts;
  result.size_ = kept.size;
  result.bucket_points_ = kept.bucket_points;
  result.codes_are_whole_ = kept.codes_are_whole != 0;
  result.hull_ = ConvexHull(file.take_copy<GridPoint>());
  result.boxes_.push_back(file.take_copy<GridBox>());
  file.require_undamaged();
  result.file_ = std::make_unique<ScratchFile>(files, buckets, ScratchFile::Kept::kExisting);
  result.check_points(buckets, kept.checksum, stop, progress);
  result.index_boxes();
  return result;
}

}  // namespace ptin
