// SPDX-License-Identifier: GPL-3.0-or-later
//
// A flat hash table of the vertices of a mesh, by their keys.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "engine/geometry/point.h"
#include "engine/large_array.h"
#include "engine/mesh/tin.h"
#include "engine/prefetch.h"

namespace ptin {

/// As KeyTable (engine/geometry/key_table.h), for the vertices of one mesh. Keys are not kept: a slot
/// has half of a hash, and where that is the same the mesh has the key. So a slot takes 8 bytes,
/// and in the memory of a table of keys at most a third of the slots is taken: most look-ups end at
/// the first one. Every function is given that mesh. Threads: const functions may run at once.
class VertexTable {
 public:
  VertexTable() { reset(0); }

  /// Makes room for `capacity` vertices, fewer than 2^32 / 3, in all. Cost: linear when it grows.
  void reserve(const Tin& tin, std::size_t capacity) {
    if (slots_for(capacity) <= slots_.size()) {
      return;
    }
    std::vector<Slot> old;
    reserve_large(old, slots_for(capacity));
    old.resize(slots_for(capacity));
    old.swap(slots_);
    for (const Slot& slot : old) {
      if (slot.vertex != kNone) {
        slots_[place(tin, key_of(tin.position(slot.vertex)))] = slot;
      }
    }
  }

  /// Empty again, with room for `capacity` vertices; what was allocated is used again. Cost: linear.
  void reset(std::size_t capacity) { slots_.assign(slots_for(capacity), {}); }

  /// Adds a vertex. Returns false, and changes nothing, when one of its position is there already.
  /// REQUIRES: the mesh has the vertex; fewer vertices than were reserved.
  bool insert(const Tin& tin, VertexId vertex) noexcept {
    const VertexKey key = key_of(tin.position(vertex));
    Slot& slot = slots_[place(tin, key)];
    const bool is_free = slot.vertex == kNone;
    if (is_free) {
      slot = {tag_of(hash_of(key)), vertex};
    }
    return is_free;
  }

  /// Removes a vertex, where it is there. Vertices behind it in its run move up (Knuth, TAOCP 3,
  /// algorithm 6.4R), so no slot is spent. Cost: the run's length.
  void erase(const Tin& tin, VertexKey key) noexcept {
    std::size_t hole = place(tin, key);
    if (slots_[hole].vertex == kNone) {
      return;
    }
    for (std::size_t i = after(hole); slots_[i].vertex != kNone; i = after(i)) {
      // The vertex at i may move into the hole unless its home lies behind the hole, cyclically.
      const std::size_t from = home(hash_of(key_of(tin.position(slots_[i].vertex))));
      if (hole <= i ? (from <= hole || from > i) : (from <= hole && from > i)) {
        slots_[hole] = slots_[i];
        hole = i;
      }
    }
    slots_[hole] = {};
  }

  /// The vertex of a key, or kNone.
  [[nodiscard]] VertexId find(const Tin& tin, VertexKey key) const noexcept {
    return slots_[place(tin, key)].vertex;
  }

  /// The vertex in the first slot where find() will look, or kNone: mostly that of the key. No vertex
  /// is looked at.
  [[nodiscard]] VertexId guess(VertexKey key) const noexcept {
    return slots_[home(hash_of(key))].vertex;
  }

  /// Asks the processor to fetch the slot that find() or insert() will look at.
  void prefetch(VertexKey key) const noexcept { ptin::prefetch(&slots_[home(hash_of(key))]); }

  /// Bytes of a table that was reserved for `capacity` vertices.
  [[nodiscard]] static std::size_t bytes_for(std::size_t capacity) noexcept {
    return slots_for(capacity) * sizeof(Slot);
  }

 private:
  struct Slot {
    std::uint32_t tag = 0;
    VertexId vertex = kNone;
  };

  [[nodiscard]] static std::size_t slots_for(std::size_t capacity) noexcept {
    return 3 * capacity + 2;
  }
  /// Folds y into x and multiplies (Fibonacci hashing; Knuth, TAOCP 3, section 6.4). The high half
  /// says where a key belongs.
  [[nodiscard]] static std::uint64_t hash_of(VertexKey key) noexcept {
    constexpr std::uint64_t kGoldenRatio = 0x9E3779B97F4A7C15u;  // 2^64 / phi, odd
    return (key ^ (key >> 27)) * kGoldenRatio;
  }
  [[nodiscard]] static std::uint32_t tag_of(std::uint64_t hash) noexcept {
    return static_cast<std::uint32_t>(hash);
  }
  [[nodiscard]] std::size_t home(std::uint64_t hash) const noexcept {
    return ((hash >> 32) * slots_.size()) >> 32;
  }
  /// The slot of `key`, or the free one where it would go. Ends because the table is never full.
  [[nodiscard]] std::size_t place(const Tin& tin, VertexKey key) const noexcept {
    const std::uint64_t hash = hash_of(key);
    std::size_t i = home(hash);
    while (slots_[i].vertex != kNone &&
           (slots_[i].tag != tag_of(hash) || key_of(tin.position(slots_[i].vertex)) != key)) {
      i = after(i);
    }
    return i;
  }
  [[nodiscard]] std::size_t after(std::size_t i) const noexcept {
    return i + 1 == slots_.size() ? 0 : i + 1;
  }

  std::vector<Slot> slots_;
};

}  // namespace ptin
