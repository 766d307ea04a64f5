// SPDX-License-Identifier: GPL-3.0-or-later
//
// What tiles in work take in memory, by measurement (engine/DECISIONS.md, section 4.8): workers are admitted by it.
#pragma once

#include <cstdint>

namespace ptin {

/// Bytes of each kind of work. Upper bounds for terrains of every kind that was measured.
struct TileBytes {
  std::uint64_t collapse_of_sample = 1200;  ///< A leaf's, with its batch's join.
  std::uint64_t replay_of_sample = 500;     ///< A leaf's.
  double join_of_pushed = 2.0;              ///< Times the bytes of the files of the children.
  std::uint64_t pushed_of_vertex = 820;     ///< In those files: plan only.
  std::uint64_t fixed = 8U << 20;

  [[nodiscard]] std::uint64_t of_batch(std::uint64_t leaf_samples) const noexcept {
    return fixed + leaf_samples * collapse_of_sample;
  }
  [[nodiscard]] std::uint64_t of_join(std::uint64_t pushed_bytes) const noexcept {
    return fixed + static_cast<std::uint64_t>(static_cast<double>(pushed_bytes) * join_of_pushed);
  }
  [[nodiscard]] std::uint64_t of_replay(std::uint64_t leaf_samples) const noexcept {
    return fixed + leaf_samples * replay_of_sample;
  }
};

}  // namespace ptin
