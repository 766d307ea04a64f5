// SPDX-License-Identifier: GPL-3.0-or-later
//
// A flat hash table from vertex keys to local vertex indices.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "engine/geometry/point.h"
#include "engine/large_array.h"
#include "engine/prefetch.h"

namespace ptin {

/// Open addressing with linear probing over one array of 16-byte slots, at most five eighths full.
/// The hash folds y into x, multiplies and keeps the high bits (Fibonacci hashing; Knuth,
/// TAOCP 3, section 6.4). Threads: const functions may run at once.
class KeyTable {
 public:
  static constexpr std::uint32_t kAbsent = UINT32_MAX;

  explicit KeyTable(std::size_t capacity = 0) { reserve(capacity); }

  [[nodiscard]] std::size_t size() const noexcept { return size_; }

  /// Makes room for `capacity` keys, fewer than 2^31, in all, so that inserting up to that many
  /// never rehashes. Cost: linear when it grows.
  void reserve(std::size_t capacity) {
    const std::size_t wanted = slots_for(capacity);
    if (wanted <= slots_.size()) {
      return;
    }
    std::vector<Slot> old;
    reserve_large(old, wanted);
    old.resize(wanted);
    old.swap(slots_);
    for (const Slot& slot : old) {
      if (slot.key != kNoVertexKey) {
        slots_[place(slot.key)] = slot;
      }
    }
  }

  /// Empty again, with room for `capacity` keys; what was allocated is used again. Cost: linear.
  void reset(std::size_t capacity) {
    slots_.assign(slots_for(capacity), {});
    size_ = 0;
  }

  /// Adds a key. Returns false, and changes nothing, when it is there already.
  /// REQUIRES: key != kNoVertexKey; size() below the reserved capacity.
  bool insert(VertexKey key, std::uint32_t value) noexcept {
    Slot& slot = slots_[place(key)];
    if (slot.key == key) {
      return false;
    }
    slot = {key, value};
    ++size_;
    return true;
  }

  /// The value of a key; where it is not there, adds it with `value` first. REQUIRES: as insert().
  std::uint32_t find_or_insert(VertexKey key, std::uint32_t value) noexcept {
    Slot& slot = slots_[place(key)];
    if (slot.key != key) {
      slot = {key, value};
      ++size_;
    }
    return slot.value;
  }

  /// The value of a key, or kAbsent.
  [[nodiscard]] std::uint32_t find(VertexKey key) const noexcept {
    const Slot& slot = slots_[place(key)];
    return slot.key == key ? slot.value : kAbsent;
  }

  /// Asks the processor to fetch the slot that find() or insert() will look at.
  void prefetch(VertexKey key) const noexcept { ptin::prefetch(&slots_[home(key)]); }

  /// Bytes of a table that was reserved for `capacity` keys.
  [[nodiscard]] static std::size_t bytes_for(std::size_t capacity) noexcept {
    return slots_for(capacity) * sizeof(Slot);
  }

 private:
  struct Slot {
    VertexKey key = kNoVertexKey;
    std::uint32_t value = kAbsent;
  };

  [[nodiscard]] static std::size_t slots_for(std::size_t capacity) noexcept {
    return capacity + capacity * 3 / 5 + 2;
  }
  [[nodiscard]] std::size_t home(VertexKey key) const noexcept {
    constexpr std::uint64_t kGoldenRatio = 0x9E3779B97F4A7C15u;  // 2^64 / phi, odd
    const std::uint64_t hash = ((key ^ (key >> 27)) * kGoldenRatio) >> 32;
    return (hash * slots_.size()) >> 32;
  }
  /// The slot of `key`, or the free one where it would go. Ends because the table is never full.
  [[nodiscard]] std::size_t place(VertexKey key) const noexcept {
    std::size_t i = home(key);
    while (slots_[i].key != key && slots_[i].key != kNoVertexKey) {
      i = after(i);
    }
    return i;
  }
  [[nodiscard]] std::size_t after(std::size_t i) const noexcept {
    return i + 1 == slots_.size() ? 0 : i + 1;
  }

  std::vector<Slot> slots_;
  std::size_t size_ = 0;
};

}  // namespace ptin
