// SPDX-License-Identifier: GPL-3.0-or-later
//
// Where the record pages lie in the file. A writer writes them before it knows how long the front
// of the file is. Then it moves only those pages to the end whose place the front takes. So the
// page in the first slot need not be page 0.
#pragma once

#include <cstdint>

#include "storage/page_store.h"

namespace ptin {

struct PageSlots {
  std::uint64_t pages = 0;
  std::uint64_t first_page = 0;  ///< The page in slot 0; below `pages`, or 0 when there is none.
  std::uint64_t offset = 0;      ///< Place of slot 0 in the file.
  std::uint32_t page_bytes = 0;

  /// REQUIRES: id < pages.
  [[nodiscard]] std::uint64_t slot_of(PageId id) const noexcept {
    const std::uint64_t i = index_of(id);
    return i >= first_page ? i - first_page : i + (pages - first_page);
  }
  /// Byte offset of a page in the file. REQUIRES: id < pages.
  [[nodiscard]] std::uint64_t offset_of(PageId id) const noexcept {
    return offset + slot_of(id) * page_bytes;
  }
};

}  // namespace ptin
