// SPDX-License-Identifier: GPL-3.0-or-later
//
// Whether any vertex key comes twice, exactly and in bounded memory.
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "engine/geometry/box.h"
#include "engine/geometry/point.h"

namespace ptin {

/// Finds the keys that come twice. The caller gives all keys once in each pass:
///
///   for (p = 0; p < passes(); ++p) { begin(p); add(...); ...; end(); }
///
/// Where one bit for each position of the bounds fits the memory, there is one pass and a bit for
/// each position. Otherwise each pass keeps one part of the keys, chosen by a hash, and sorts it;
/// there are as many passes as that takes.
class UniqueKeys {
 public:
  /// @param keys        At most so many keys come in a pass.
  /// @param most_twice  At most so many keys that come twice are kept; further ones are dropped.
  UniqueKeys(const GridBox& bounds, std::uint64_t keys, std::uint64_t memory_bytes,
             std::size_t most_twice)
      : bounds_(bounds),
        most_twice_(most_twice),
        width_(std::uint64_t{static_cast<std::uint32_t>(bounds.max_x - bounds.min_x)} + 1) {
    const std::uint64_t height =
        std::uint64_t{static_cast<std::uint32_t>(bounds.max_y - bounds.min_y)} + 1;
    const std::uint64_t positions = width_ * height;  // at most (2^30 + 1)^2
    by_bits_ = positions / 8 < memory_bytes;
    if (by_bits_) {
      bits_.resize(positions / 64 + 1);
    } else {
      const std::uint64_t at_once = std::max<std::uint64_t>(memory_bytes / sizeof(VertexKey), 1024);
      passes_ = (keys + keys / 64) / at_once + 1;          // parts are not quite equal
      part_.reserve(std::min(at_once, keys + keys / 64));  // growing would take twice as much
    }
  }

  [[nodiscard]] std::uint64_t passes() const noexcept { return passes_; }
  void begin(std::uint64_t pass) {
    pass_ = pass;
    part_.clear();
  }
  /// REQUIRES: on the grid.
  void add(GridPoint p) {
    if (by_bits_ && contains(bounds_, p)) {
      const std::uint64_t i = static_cast<std::uint64_t>(p.y - bounds_.min_y) * width_ +
                              static_cast<std::uint64_t>(p.x - bounds_.min_x);
      const std::uint64_t bit = std::uint64_t{1} << (i % 64);
      if ((bits_[i / 64] & bit) != 0) {
        keep_twice(key_of(p));
      }
      bits_[i / 64] |= bit;
    } else if (!by_bits_ && (key_of(p) * 0x9E3779B97F4A7C15U >> 32) % passes_ == pass_) {
      part_.push_back(key_of(p));
    }
  }
  /// Ends a pass. Where keys are sorted, those that come twice are found here.
  void end() {
    std::sort(part_.begin(), part_.end());
    for (std::size_t i = 1; i < part_.size(); ++i) {
      if (part_[i] == part_[i - 1]) {
        keep_twice(part_[i]);
      }
    }
    part_.clear();
  }
  [[nodiscard]] const std::vector<VertexKey>& twice() const noexcept { return twice_; }

 private:
  void keep_twice(VertexKey key) {
    if (twice_.size() < most_twice_) {
      twice_.push_back(key);
    }
  }

  GridBox bounds_;
  std::size_t most_twice_;
  std::uint64_t width_;
  bool by_bits_ = false;
  std::uint64_t passes_ = 1;
  std::uint64_t pass_ = 0;
  std::vector<std::uint64_t> bits_;
  std::vector<VertexKey> part_;
  std::vector<VertexKey> twice_;
};

}  // namespace ptin
