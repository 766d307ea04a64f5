// SPDX-License-Identifier: GPL-3.0-or-later
//
// What tiles in work take in memory, by measurement (engine/DECISIONS.md, section 4.8). Work is
// admitted by these numbers.
#pragma once

#include <cstdint>

namespace ptin {

/// Bytes that each kind of work takes: upper bounds over terrains of every kind that was measured.
struct TileBytes {
  std::uint64_t collapse_of_sample = 1320;  ///< A batch, for a sample of its largest leaf.
  std::uint64_t replay_of_sample = 500;     ///< A replay, for a sample of the leaf.
  double join_of_pushed = 2.2;              ///< A join, for a byte of its children's pushed files.
  std::uint64_t pushed_of_vertex = 880;  ///< A vertex in these files; the plan expects joins by it.
  double close_of_segment = 2.0;         ///< Closing, for a byte of its segment.
  std::uint64_t fixed = 8U << 20;        ///< Any work, besides.

  /// A batch: its leaves one by one, then their join.
  /// @param leaf_samples  Samples of its largest leaf.
  [[nodiscard]] std::uint64_t of_batch(std::uint64_t leaf_samples) const noexcept {
    return fixed + leaf_samples * collapse_of_sample;
  }
  /// A tile of level 2 or more.
  /// @param pushed_bytes  Bytes of the files of its children.
  [[nodiscard]] std::uint64_t of_join(std::uint64_t pushed_bytes) const noexcept {
    return fixed + static_cast<std::uint64_t>(static_cast<double>(pushed_bytes) * join_of_pushed);
  }
  /// Closing a tile of level 2 or more.
  /// @param segment_bytes  Bytes of its file.
  [[nodiscard]] std::uint64_t of_close(std::uint64_t segment_bytes) const noexcept {
    return fixed +
           static_cast<std::uint64_t>(static_cast<double>(segment_bytes) * close_of_segment);
  }
  /// A batch in tightening, leaf by leaf.
  /// @param leaf_samples  Samples of its largest leaf.
  [[nodiscard]] std::uint64_t of_replay(std::uint64_t leaf_samples) const noexcept {
    return fixed + leaf_samples * replay_of_sample;
  }
};

}  // namespace ptin
