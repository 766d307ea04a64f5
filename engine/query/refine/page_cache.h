// SPDX-License-Identifier: GPL-3.0-or-later
//
// Record pages that a moving window keeps between two moves: decoded, within a limit of memory.
#pragma once

#include <cstddef>
#include <cstdint>
#include <list>
#include <span>
#include <unordered_map>
#include <vector>

#include "engine/query/select/accounting.h"
#include "storage/store_file.h"

namespace ptin {

/// Decoded pages, at most `limit_bytes` of them (but one at least); the page that was used longest
/// ago goes first. Threads: one owner.
class PageCache {
 public:
  /// @param store  Borrowed for the life of the cache.
  PageCache(const StoreFile& store, std::uint64_t limit_bytes)
      : store_(store), limit_bytes_(limit_bytes) {}

  /// Announces to the store those of `pages` (ascending) that are not in the cache and so will be
  /// read.
  void announce(std::span<const PageId> pages, QueryContext& context) const;

  /// All records of a page, in the order of the file; valid until the next call. Cost: a look-up
  /// for a page in the cache; another page is read, and the pages used longest ago make room for
  /// it.
  /// @throws Error corruption, io_error
  [[nodiscard]] std::span<const VertexSplit> records(PageId page, QueryContext& context);

  [[nodiscard]] std::uint64_t limit_bytes() const noexcept { return limit_bytes_; }
  [[nodiscard]] std::uint64_t bytes() const noexcept { return bytes_; }

 private:
  struct Entry {
    PageId page;
    std::vector<VertexSplit> records;
    [[nodiscard]] std::uint64_t bytes() const noexcept;
  };
  void make_room(std::uint64_t bytes);

  const StoreFile& store_;
  std::uint64_t limit_bytes_;
  std::uint64_t bytes_ = 0;
  std::list<Entry> entries_;  ///< The one used last comes first.
  std::unordered_map<std::uint64_t, std::list<Entry>::iterator> places_;
};

}  // namespace ptin
