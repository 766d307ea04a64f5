// SPDX-License-Identifier: GPL-3.0-or-later
//
// The buckets that the triangulation of a tile looks into, and which of their points are in it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <unordered_map>
#include <unordered_set>
#include <vector>

#include "engine/construct/points/point_buckets.h"
#include "engine/geometry/box.h"

namespace ptin {

/// Loads buckets when they are asked for, and knows which of their points are *taken*: inserted
/// into the triangulation. When all that is loaded weighs too much, points are forgotten, but not
/// which of them are taken. Not thread-safe.
class BucketCache {
 public:
  /// Points of a bucket that share one of its boxes.
  static constexpr std::size_t kBlock = 32;

  struct Bucket {
    std::vector<BucketPoint> points;
    std::vector<std::uint8_t> is_in;  ///< 1 for each of `points` that is taken.
    std::vector<GridBox> boxes;       ///< Boxes of what is not taken of each kBlock points.
    bool has_more = false;            ///< Some are taken that were not so from the beginning.

    /// True when all points are taken.
    [[nodiscard]] bool is_used_up() const noexcept;
  };

  /// @param buckets      Must live as long as this.
  /// @param first, end   The points first .. end - 1 are taken from the beginning: the tile's own.
  /// @param most_bytes   The weight above which tidy() forgets points.
  BucketCache(const PointBuckets& buckets, std::uint64_t first, std::uint64_t end,
              std::size_t most_bytes)
      : buckets_(buckets), first_(first), end_(end), most_bytes_(most_bytes) {}

  /// Points in this box are taken from the beginning, too. To be called before load().
  void set_box(const GridBox& box) { box_ = box; }

  /// A bucket, which is read unless it is loaded. The reference is valid until tidy(), or until
  /// set_used_up() of this bucket.  @throws Error io_error
  [[nodiscard]] Bucket& load(std::uint64_t bucket);
  /// To be called when all points of a bucket are taken: it is not looked into again.
  void set_used_up(std::uint64_t bucket);
  [[nodiscard]] bool is_used_up(std::uint64_t bucket) const { return used_up_.contains(bucket); }
  /// Forgets all loaded points where they weigh too much.
  void tidy();

  /// The weight of what is loaded, bytes.
  [[nodiscard]] std::size_t bytes() const noexcept { return bytes_; }

 private:
  static std::size_t weight(const Bucket& b) noexcept;

  const PointBuckets& buckets_;
  std::uint64_t first_, end_;
  std::size_t most_bytes_;
  GridBox box_;
  std::size_t bytes_ = 0;
  std::unordered_map<std::uint64_t, Bucket> loaded_;
  /// For buckets with has_more that were forgotten: which of their points are taken.
  std::unordered_map<std::uint64_t, std::vector<bool>> taken_;
  std::unordered_set<std::uint64_t> used_up_;
};

}  // namespace ptin
