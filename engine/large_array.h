// SPDX-License-Identifier: GPL-3.0-or-later
//
// Arrays that are filled at once: large ones are given large pages, where the system has them.
#pragma once

#include <cstddef>
#include <vector>

namespace ptin {

/// Advises the system to back [begin, begin + bytes) with large pages. A hint: never fails, and
/// does nothing for ranges below 4 MiB and on systems other than Linux. For fresh memory only,
/// since pages that were touched stay as they are. Without it, first touches of 4 KiB pages take a
/// fifth of the time of a refinement of 176 000 splits.
void advise_large_pages(void* begin, std::size_t bytes) noexcept;

/// Reserves room for `capacity` elements, and advises large pages for what is free of it.
template <typename T>
void reserve_large(std::vector<T>& v, std::size_t capacity) {
  if (capacity > v.capacity()) {
    v.reserve(capacity);
    advise_large_pages(v.data() + v.size(), (v.capacity() - v.size()) * sizeof(T));
  }
}

}  // namespace ptin
