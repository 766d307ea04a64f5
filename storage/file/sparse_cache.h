// SPDX-License-Identifier: GPL-3.0-or-later
//
// Blocks of a file that lies elsewhere, kept on this machine's disk.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

namespace ptin {

/// One sparse file: the blocks at their places, and behind them a checksum of each. A block is taken
/// for kept when it matches its checksum, which is never 0: so neither a crash nor another process
/// that writes the same blocks at the same time can make it say what the file does not. The name is
/// the key of the content, so it is never out of date. Threads: all functions may be called at once.
class SparseCache {
 public:
  /// Opens or makes `folder`/KEY.ptin-cache.
  /// @param bytes  Size of the file that is kept.
  /// @throws Error not_found (no such folder), io_error
  SparseCache(const std::string& folder, std::uint64_t key, std::uint64_t bytes);
  SparseCache(const SparseCache&) = delete;
  SparseCache& operator=(const SparseCache&) = delete;
  ~SparseCache();

  /// Fills `out` with block `number`, which has its length. False when it is not kept, or cannot be
  /// read.
  [[nodiscard]] bool load(std::uint64_t number, std::span<std::byte> out) const noexcept;
  /// Keeps a block. What the disk has no room for is not kept, silently: it is a cache.
  void keep(std::uint64_t number, std::span<const std::byte> block) noexcept;

 private:
  [[nodiscard]] std::uint64_t place_of_checksum(std::uint64_t number) const noexcept;

  int descriptor_ = -1;
  std::uint64_t bytes_;
};

}  // namespace ptin
