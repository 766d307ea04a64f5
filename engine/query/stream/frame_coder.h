// SPDX-License-Identifier: GPL-3.0-or-later
//
// The code of a frame, from the splits that the cells of a terrain wrote down.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "engine/query/stream/split_models.h"
#include "engine/query/stream/split_turns.h"

namespace ptin {

/// Puts the splits of one frame after the other in order, and codes them. Threads: one owner.
class FrameCoder {
 public:
  /// @param cell_vertices  Of the base, in each cell along the curve.
  /// @param file           Named in errors.
  FrameCoder(std::vector<std::uint64_t> cell_vertices, std::string file);

  /// Most bytes that coding a frame of so many splits takes, with what the cells wrote down.
  [[nodiscard]] static std::uint64_t bytes_of(std::uint64_t splits) noexcept;

  /// Codes a frame, appending to `out`.
  /// @param coded  What CellCoder::code() of all cells wrote down, in any order.
  /// @throws Error corruption  it is not a frame of `count` splits
  void code(std::span<const std::byte> coded, std::uint64_t count, std::vector<std::byte>& out);

  /// Counts vertices of a cell that came with the frame that was coded last.
  void add(std::size_t cell, std::uint32_t vertices) { cell_vertices_[cell] += vertices; }

 private:
  void count_before();
  void read(std::span<const std::byte> coded);
  void find_makers();
  [[noreturn]] void reject(const std::string& why) const;

  std::string file_;
  std::vector<std::uint64_t> cell_vertices_;
  std::vector<std::uint64_t> before_;  ///< Vertices before each cell, and all.
  SplitModels models_;
  std::vector<SplitTurn> turns_;
  std::vector<std::uint32_t> places_;  ///< Where each split of the frame begins.
};

}  // namespace ptin
