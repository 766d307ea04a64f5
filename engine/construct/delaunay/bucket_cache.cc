// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/delaunay/bucket_cache.h"

#include <algorithm>
#include <utility>

namespace ptin {

bool BucketCache::Bucket::is_used_up() const noexcept {
  return std::all_of(boxes.begin(), boxes.end(), [](const GridBox& b) { return is_empty(b); });
}

std::size_t BucketCache::weight(const Bucket& b) noexcept {
  return sizeof b + b.points.size() * (sizeof b.points[0] + sizeof b.is_in[0]) +
         b.boxes.size() * sizeof b.boxes[0];
}

BucketCache::Bucket& BucketCache::load(std::uint64_t bucket) {
  const auto [found, is_new] = loaded_.try_emplace(bucket);
  Bucket& loaded = found->second;
  if (!is_new) {
    return loaded;
  }
  const std::uint64_t begin = buckets_.begin_of(bucket);
  const std::uint64_t end = buckets_.begin_of(bucket + 1);
  buckets_.take(begin, end - begin, loaded.points);
  loaded.is_in.resize(loaded.points.size());
  loaded.boxes.resize((loaded.points.size() + kBlock - 1) / kBlock);
  const auto taken = taken_.find(bucket);
  loaded.has_more = taken != taken_.end();
  for (std::uint64_t i = begin; i < end; ++i) {
    const std::uint64_t at = i - begin;
    const GridPoint p = loaded.points[at].position;
    const bool is_in =
        loaded.has_more ? bool{taken->second[at]} : (i >= first_ && i < end_) || contains(box_, p);
    loaded.is_in[at] = is_in ? 1 : 0;
    GridBox& box = loaded.boxes[at / kBlock];
    box = is_in ? box : united(box, p);
  }
  bytes_ += weight(loaded);
  return loaded;
}

void BucketCache::set_used_up(std::uint64_t bucket) {
  const auto found = loaded_.find(bucket);
  if (found != loaded_.end()) {
    bytes_ -= weight(found->second);
    loaded_.erase(found);
  }
  taken_.erase(bucket);
  used_up_.insert(bucket);
}

void BucketCache::tidy() {
  if (bytes_ <= most_bytes_) {
    return;
  }
  for (const auto& [number, bucket] : loaded_) {
    if (bucket.has_more) {
      taken_[number].assign(bucket.is_in.begin(), bucket.is_in.end());
    }
  }
  loaded_.clear();
  bytes_ = 0;
}

}  // namespace ptin
