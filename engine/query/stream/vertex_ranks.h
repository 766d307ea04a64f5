// SPDX-License-Identifier: GPL-3.0-or-later
//
// How many vertices that are there come before another one along the curve.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace ptin {

/// A bit for each place along the curve, and counts of those that are set. Vertices are added in
/// batches, and asked for between two of these. Cost: a batch a count of n / 512 places, a question
/// eight words.
class VertexRanks {
 public:
  explicit VertexRanks(std::size_t places) : words_((places / kBlock + 1) * kWords) {}

  /// The vertex at this place is there from the next count() on.
  void add(std::size_t place) noexcept { words_[place / 64] |= std::uint64_t{1} << (place % 64); }
  void count() {
    before_.resize(words_.size() / kWords);
    std::uint32_t sum = 0;
    for (std::size_t block = 0; block < before_.size(); ++block) {
      before_[block] = sum;
      sum += set_in(block * kWords, (block + 1) * kWords);
    }
  }
  /// Vertices before this place when count() was called.
  [[nodiscard]] std::uint32_t before(std::size_t place) const noexcept {
    const std::size_t word = place / 64;
    const std::uint64_t below = words_[word] & ((std::uint64_t{1} << (place % 64)) - 1);
    return before_[place / kBlock] + set_in(place / kBlock * kWords, word) +
           static_cast<std::uint32_t>(std::popcount(below));
  }

 private:
  static constexpr std::size_t kWords = 8;
  static constexpr std::size_t kBlock = 64 * kWords;
  [[nodiscard]] std::uint32_t set_in(std::size_t word, std::size_t end) const noexcept {
    std::uint32_t sum = 0;
    for (; word < end; ++word) sum += static_cast<std::uint32_t>(std::popcount(words_[word]));
    return sum;
  }
  std::vector<std::uint64_t> words_;
  std::vector<std::uint32_t> before_;  ///< Of each block.
};

}  // namespace ptin
