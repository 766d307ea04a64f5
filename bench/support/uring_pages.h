// SPDX-License-Identifier: GPL-3.0-or-later
//
// Record pages read through io_uring: many reads under way at once, from one thread.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <string>

#include "storage/page_slots.h"

namespace ptin::bench {

/// Where the record pages of a store lie, from its header.  @throws Error as StoreFile::open
[[nodiscard]] PageSlots page_slots_of(const std::string& store);

inline constexpr unsigned kUringDepth = 64;

/// Whether this program was built with liburing.
[[nodiscard]] bool has_uring() noexcept;

/// Reads the pages in whatever order they arrive, at most kUringDepth under way, and hands each to
/// `seen` once.
/// @throws Error io_error  also where the kernel refuses io_uring, or without liburing
void read_with_uring(const std::string& store, const PageSlots& slots,
                     std::span<const PageId> pages,
                     const std::function<void(PageId, std::span<const std::byte>)>& seen);

}  // namespace ptin::bench
