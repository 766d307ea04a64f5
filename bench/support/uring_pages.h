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

/// Reads `pages` and hands each to `seen` once, in the order in which they arrive. At most
/// kUringDepth reads are under way at once. Nothing is verified.
/// @throws Error io_error  also: the kernel refuses io_uring, or the program was built without
///                         liburing
void read_with_uring(const std::string& store, const PageSlots& slots,
                     std::span<const PageId> pages,
                     const std::function<void(PageId, std::span<const std::byte>)>& seen);

}  // namespace ptin::bench
