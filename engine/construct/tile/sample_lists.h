// SPDX-License-Identifier: GPL-3.0-or-later
//
// The removed samples that each triangle covers: short lists in one pool.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <span>
#include <vector>

#include "engine/construct/tile/direction.h"
#include "engine/error.h"
#include "engine/geometry/height.h"
#include "engine/geometry/point.h"
#include "engine/growing_array.h"

namespace ptin {

/// A removed sample: one that is no vertex any more. Or a square block of them: 2^side_log by
/// 2^side_log samples of a raster, either all of one height or all without a height; `position` is
/// the south-western sample, whose coordinates are multiples of the block's side. Lakes, seas and
/// voids become blocks: a triangle over a million samples lists about as many elements as its
/// border is long (construct/measure/sample_blocks.h).
///
/// `reach` is what the sample is charged in the wrong class, a length on the ground
/// (tile/border_witnesses.h); negative for samples without a height, never 0 there. The reach of a
/// block is the one farthest from 0.
///
/// With a direction it is no sample but the witness of a triangle of the full TIN, which stands
/// infinitely near a vertex in that direction. One of surface has the vertex's height.
struct Sample {
  GridPoint position;
  HeightBits height = 0;
  float reach = 0.0F;
  std::uint16_t side_log = 0;
  Direction direction = kNoDirection;
};

/// Where the list of a triangle lies. The triangle owns the list; only SampleLists can read a slot.
struct SampleSlot {
  std::uint32_t offset = 0;
  std::uint32_t count = 0;
};

/// Lists of samples in one pool, with capacities that are powers of two and a free list for each
/// capacity. A list is taken at its final length and given back whole: a collapse gives back the
/// lists of the star and takes new ones for the fan. A pool (one tile) holds at most 2^32 - 1
/// samples.
class SampleLists {
 public:
  /// A new list of `count` samples, not initialised. Invalidates spans and pointers into the pool.
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

  /// Frees a list.
  void give_back(SampleSlot slot) {
    if (slot.count != 0) {
      const auto capacity_log = static_cast<std::size_t>(std::bit_width(slot.count - 1));
      free_[capacity_log].push_back(slot.offset);
      used_ -= std::size_t{1} << capacity_log;
    }
  }

  /// True when more than a third of a large pool is free. Its free lists are of lengths that are
  /// hardly asked for any more, since lists grow as triangles do: time to compact the tile
  /// (construct/collapse/tile_compact.h).
  [[nodiscard]] bool is_sparse() const noexcept {
    constexpr std::size_t kWorthwhile = std::size_t{1} << 16;
    return pool_.size() > kWorthwhile && pool_.size() / 3 * 2 > used_;
  }
  /// The capacities of all lists, in samples.
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

  /// Moves all lists to the front of the pool, in the order in which they lie there. Gives back the
  /// room behind them, but for a quarter of theirs. Works in place; invalidates spans and pointers.
  /// @param slots  Slots of all lists that are not empty. A count may have been lowered: the first
  ///     samples stay.
  /// Cost: linear in the pool, and n log n in the number of lists.
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

  /// Makes room for this many samples in all.  @throws std::bad_alloc
  void reserve(std::size_t samples) { pool_.reserve(samples); }

 private:
  GrowingArray<Sample> pool_;
  std::size_t used_ = 0;                             ///< Sum of the capacities of lists.
  std::array<std::vector<std::uint32_t>, 33> free_;  ///< By log2 of the capacity: offsets.
};

}  // namespace ptin
