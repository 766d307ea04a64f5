// SPDX-License-Identifier: GPL-3.0-or-later
//
// Buckets of points that the triangulation of a tile looks into, and which of their points it has
// taken.
#pragma once

#include <cstddef>
#include <cstdint>
#include <unordered_map>
#include <unordered_set>
#include <vector>

#include "engine/construct/points/point_buckets.h"
#include "engine/geometry/box.h"

namespace ptin {

/// Loads buckets when they are asked for, and forgets their points (not which of them were taken)
/// when all of them weigh too much. Not thread-safe.
class BucketCache {
 public:
  /// Points of a bucket that share a box.
  static constexpr std::size_t kBlock = 32;

  struct Bucket {
    std::vector<BucketPoint> points;
    std::vector<std::uint8_t> is_in;  ///< Beside them: taken.
    std::vector<GridBox> boxes;       ///< Of the points not taken, kBlock at a time.
    bool has_more = false;            ///< More are taken than those known from the beginning.

    [[nodiscard]] bool is_used_up() const noexcept;
  };

  /// @param first, end   Points of the buckets that are taken from the beginning.
  /// @param most_bytes   Weight at which points are forgotten; a bucket in use may exceed it.
  /// The buckets must live as long as this.
  BucketCache(const PointBuckets& buckets, std::uint64_t first, std::uint64_t end,
              std::size_t most_bytes)
      : buckets_(buckets), first_(first), end_(end), most_bytes_(most_bytes) {}

  /// Points in this box are taken from the beginning, too. To be called before load().
  void set_box(const GridBox& box) { box_ = box; }

  /// The reference is valid until tidy() or the next call.  @throws Error io_error
  [[nodiscard]] Bucket& load(std::uint64_t bucket);
  /// All of its points are taken: it is not looked into again.
  void set_used_up(std::uint64_t bucket);
  [[nodiscard]] bool is_used_up(std::uint64_t bucket) const { return used_up_.contains(bucket); }
  /// Forgets points where they weigh too much.
  void tidy();

  /// Weight of what is loaded, bytes.
  [[nodiscard]] std::size_t bytes() const noexcept { return bytes_; }

 private:
  static std::size_t weight(const Bucket& b) noexcept;

  const PointBuckets& buckets_;
  std::uint64_t first_, end_;
  std::size_t most_bytes_;
  GridBox box_;
  std::size_t bytes_ = 0;
  std::unordered_map<std::uint64_t, Bucket> loaded_;
  /// Of forgotten buckets that have more.
  std::unordered_map<std::uint64_t, std::vector<bool>> taken_;
  std::unordered_set<std::uint64_t> used_up_;
};

}  // namespace ptin
