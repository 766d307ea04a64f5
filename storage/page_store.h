// SPDX-License-Identifier: GPL-3.0-or-later
//
// The page store: the one way to the record pages. storage/page_stores.h has two implementations
// (mapped, pread). How pages that are read next are announced is storage/file/announcer.h's.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "storage/file/io_counters.h"

namespace ptin {

/// Number of a record page in its file, from 0. Never a byte offset.
enum class PageId : std::uint64_t {};
[[nodiscard]] constexpr std::uint64_t index_of(PageId id) noexcept {
  return static_cast<std::uint64_t>(id);
}

/// Reads record pages. Every implementation verifies a page's checksum before its bytes are seen:
/// the mapped one at the first touch, the pread one at every read. Threads: all functions may be
/// called at once on one store; counters belong to the caller.
class PageStore {
 public:
  PageStore() = default;
  PageStore(const PageStore&) = delete;
  PageStore& operator=(const PageStore&) = delete;
  virtual ~PageStore() = default;

  [[nodiscard]] virtual std::uint64_t page_count() const noexcept = 0;
  [[nodiscard]] virtual std::size_t page_bytes() const noexcept = 0;

  /// True for files elsewhere, where one page that was not announced costs as much time as a whole
  /// announced batch (storage/file/readable_file.h).
  [[nodiscard]] virtual bool is_far() const noexcept { return false; }

  /// Announces to the kernel which pages are read next; pages that lie near each other become one
  /// range. `ids` ascend. A hint: never fails.
  virtual void announce(std::span<const PageId> ids, IoCounters& counters) const noexcept = 0;

  /// Copies page `id` into `out` (page_bytes() long). The copy is what is checked, so bytes cannot
  /// change behind the check.
  /// @throws Error corruption (checksum, id out of range, file cut or replaced while open),
  /// io_error
  virtual void read(PageId id, std::span<std::byte> out, IoCounters& counters) const = 0;

  /// Compares size, modification time and change time of the file with those at opening, and looks
  /// whether a mapping has lost bytes of its file.
  /// @throws Error corruption  the file was replaced, cut short or written while it was open
  virtual void check_unchanged() const = 0;
};

}  // namespace ptin
