// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/large_array.h"

#include <cstdint>

#ifdef __linux__
#include <sys/mman.h>
#endif

namespace ptin {

void advise_large_pages([[maybe_unused]] void* begin, [[maybe_unused]] std::size_t bytes) noexcept {
#if defined(__linux__) && defined(MADV_HUGEPAGE)
  constexpr std::size_t kWorthwhile = std::size_t{4}
                                      << 20;  // two large pages: less than half of it is wasted
  constexpr std::uintptr_t kPage = 4096;
  if (bytes < kWorthwhile) {
    return;
  }
  const auto at = reinterpret_cast<std::uintptr_t>(begin);
  const std::uintptr_t first = (at + kPage - 1) & ~(kPage - 1);
  const std::uintptr_t last = (at + bytes) & ~(kPage - 1);
  static_cast<void>(
      ::madvise(static_cast<std::byte*>(begin) + (first - at), last - first, MADV_HUGEPAGE));
#endif
}

}  // namespace ptin
