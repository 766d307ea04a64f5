// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/points/point_buckets.h"

#include <algorithm>
#include <utility>

#include "engine/construct/grid/height_fit.h"
#include "engine/construct/points/packed_bucket.h"
#include "storage/file/checksum.h"

namespace ptin {

PointBuckets::PointBuckets(FileLayer& files, const std::string& buckets, Index index)
    : index_(std::move(index)), boxes_(std::move(index_.boxes)), path_(buckets) {
  for (const Range& range : index_.ranges) {
    files_.push_back(std::make_unique<ScratchFile>(files, path_ + "-" + std::to_string(range.file),
                                                   ScratchFile::Kept::kExisting));
  }
}

/// Refuses files that have lost bytes: a read behind their end would look like a fault of the disk.
void PointBuckets::require_whole() const {
  for (std::size_t range = 0; range < files_.size(); ++range) {
    const std::uint64_t behind =
        range + 1 < files_.size() ? index_.ranges[range + 1].first_bucket : buckets();
    if (files_[range]->size() != index_.ends[behind - 1]) {
      refuse_damaged(path_ + "-" + std::to_string(index_.ranges[range].file));
    }
  }
}

HeightBits PointBuckets::stored(double height) const {
  const HeightEncoding& heights = index_.frame.heights;
  return index_.codes_are_whole ? heights.bits(height) : encode_height(heights, height);
}

std::size_t PointBuckets::range_of(std::uint64_t bucket) const noexcept {
  const auto behind =
      std::upper_bound(index_.ranges.begin(), index_.ranges.end(), bucket,
                       [](std::uint64_t b, const Range& r) { return b < r.first_bucket; });
  return static_cast<std::size_t>(behind - index_.ranges.begin()) - 1;
}

std::uint64_t PointBuckets::bucket_of(std::uint64_t point) const noexcept {
  const auto behind =
      std::upper_bound(index_.ranges.begin(), index_.ranges.end(), point,
                       [](std::uint64_t p, const Range& r) { return p < r.first_point; });
  const Range& range = *(behind - 1);
  return range.first_bucket + (point - range.first_point) / index_.bucket_points;
}

std::uint64_t PointBuckets::begin_of(std::uint64_t bucket) const noexcept {
  if (bucket == buckets()) {
    return size();
  }
  const Range& range = index_.ranges[range_of(bucket)];
  return range.first_point + (bucket - range.first_bucket) * index_.bucket_points;
}

/// Reads the bytes of a bucket, and kUnpackSlack more that mean nothing.
void PointBuckets::read_bucket(std::uint64_t bucket, std::vector<std::byte>& bytes) const {
  const std::size_t range = range_of(bucket);
  const std::uint64_t begin =
      bucket == index_.ranges[range].first_bucket ? 0 : index_.ends[bucket - 1];
  const std::uint64_t count = index_.ends[bucket] - begin;
  bytes.resize(count + kUnpackSlack);
  files_[range]->read_at(std::span(bytes).first(count), begin);
  if (checksum_of(std::span(bytes).first(count)) != index_.checksums[bucket]) {
    refuse_damaged(path_ + "-" + std::to_string(index_.ranges[range].file));
  }
}

void PointBuckets::take(std::uint64_t first, std::uint64_t count,
                        std::vector<BucketPoint>& points) const {
  points.clear();
  points.reserve(count);
  std::vector<std::byte> packed;
  std::vector<GridVertex> bucket;
  std::uint64_t number = count == 0 ? 0 : bucket_of(first);
  for (std::uint64_t at = first; at < first + count; ++number) {
    const std::uint64_t begin = begin_of(number);
    const std::uint64_t end = std::min(begin_of(number + 1), first + count);
    read_bucket(number, packed);
    bucket.resize(end - begin);
    unpack_bucket(std::span(packed).first(packed.size() - kUnpackSlack), box(number), bucket);
    for (; at < end; ++at) {
      const GridVertex& p = bucket[at - begin];
      points.push_back({p.position, stored(p.height)});
    }
  }
}

}  // namespace ptin
