// SPDX-License-Identifier: GPL-3.0-or-later
//
// The removed samples that each triangle covers: short arrays in one pool.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <span>
#include <vector>

#include "engine/error.h"
#include "engine/geometry/height.h"
#include "engine/geometry/point.h"
#include "engine/growing_array.h"

namespace ptin {

/// A sample of the source that is no vertex any more, or a square block of them: 2^side_log by
/// 2^side_log samples of a raster with one height, or all without one; `position` is its
/// south-western sample, a multiple of its side. Lakes, seas and voids are blocks: a triangle over
/// a million samples lists about as many elements as its border is long (sample_blocks.h).
///
/// `depth` is the distance to the nearest sample of the other class in ground units, +infinity
/// beyond the cut-off; negative for samples without a height (engine/DESIGN.md, section 3.2); of a block,
/// the farthest from 0.
struct Sample {
  GridPoint position;
  HeightBits height = 0;
  float depth = 0.0F;
  std::uint32_t side_log = 0;
};

/// Where a triangle's samples are. Owned by the triangle; only SampleLists makes sense of it.
struct SampleSlot {
  std::uint32_t offset = 0;
  std::uint32_t count = 0;
};

/// Arrays of samples whose capacities are powers of two, in one pool with a free list for each
/// capacity. A list is taken at its final length and given back whole: a collapse takes the lists
/// of the star and gives new ones to the fan. At most 2^32 - 1 samples in one pool (one tile).
class SampleLists {
 public:
  /// A list of `count` samples, not initialised. Spans into the pool end with the next call.
  /// @throws Error resource_exhausted  the pool would hold more than 2^32 - 1 samples
  [[nodiscard]] SampleSlot take(std::uint32_t count) {
    if (count == 0) {
      return {};
    }
    const auto capacity_log = static_cast<std::size_t>(std::bit_width(count - 1));
    std::vector<std::uint32_t>& free = free_[capacity_log];
    used_ += std::size_t{1} << capacity_log;
    if (!free.empty()) {
      const std::uint32_t offset = free.back();
      free.pop_back();
      return {offset, count};
    }
    const std::size_t offset = pool_.size();
    const std::size_t end = offset + (std::size_t{1} << capacity_log);
    if (end > UINT32_MAX) {
      throw Error(ErrorCode::resource_exhausted,
                  "a tile holds more samples than one list of them counts; build in smaller tiles");
    }
    pool_.grow(end);
    return {static_cast<std::uint32_t>(offset), count};
  }

  void give_back(SampleSlot slot) {
    if (slot.count != 0) {
      const auto capacity_log = static_cast<std::size_t>(std::bit_width(slot.count - 1));
      free_[capacity_log].push_back(slot.offset);
      used_ -= std::size_t{1} << capacity_log;
    }
  }

  /// True when a third of the pool is free lists of lengths that nobody asks for any more: as
  /// triangles grow, so do their lists. Time to lay them out anew (tile_compact.h).
  [[nodiscard]] bool is_sparse() const noexcept {
    constexpr std::size_t kWorthwhile = std::size_t{1} << 16;
    return pool_.size() > kWorthwhile && pool_.size() / 3 * 2 > used_;
  }
  /// Samples in lists, each rounded up to its capacity.
  [[nodiscard]] std::size_t used() const noexcept { return used_; }

  [[nodiscard]] std::span<Sample> samples(SampleSlot slot) noexcept {
    return {pool_.data() + slot.offset, slot.count};
  }
  [[nodiscard]] std::span<const Sample> samples(SampleSlot slot) const noexcept {
    return {pool_.data() + slot.offset, slot.count};
  }
  [[nodiscard]] const Sample* data(SampleSlot slot) const noexcept {
    return pool_.data() + slot.offset;
  }

  /// Moves lists to the front of the pool, in the order they have there, and lets the rest of it go
  /// but for a quarter. Nothing is there twice meanwhile.
  /// @param slots  Those of all lists; a count may have been lowered (the first elements stay).
  /// Cost: linear in the pool, and n log n in the lists.
  void close_gaps(std::vector<SampleSlot*> slots) {
    std::sort(slots.begin(), slots.end(),
              [](const SampleSlot* a, const SampleSlot* b) { return a->offset < b->offset; });
    used_ = 0;
    for (SampleSlot* slot : slots) {
      const Sample* first = pool_.data() + slot->offset;
      std::copy(first, first + slot->count, pool_.data() + used_);
      slot->offset = static_cast<std::uint32_t>(used_);
      used_ += std::bit_ceil(std::size_t{slot->count});
    }
    for (std::vector<std::uint32_t>& free : free_) {
      free.clear();
    }
    pool_.shrink(used_);
  }

  /// Room for so many in all.  @throws std::bad_alloc
  void reserve(std::size_t samples) { pool_.reserve(samples); }

 private:
  GrowingArray<Sample> pool_;
  std::size_t used_ = 0;
  std::array<std::vector<std::uint32_t>, 33> free_;
};

}  // namespace ptin
