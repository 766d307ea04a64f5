// SPDX-License-Identifier: GPL-3.0-or-later
//
// A test program whose every allocation is asked about first. To be included by one source of a
// program: it replaces operator new and delete there, of libraries too. Under a sanitizer, which
// allocates by itself, it replaces nothing and PTIN_TEST_ALLOCATES is not defined.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <cstdlib>
#include <new>

namespace ptin::test {

/// Asked at every allocation, on any thread, while there is one: true when it is to fail. Must not
/// allocate.
inline std::atomic<bool (*)()> allocation_fails{nullptr};

/// Has a function asked for as long as it lives.
class AskedAllocations {
 public:
  explicit AskedAllocations(bool (*fails)()) { allocation_fails = fails; }
  AskedAllocations(const AskedAllocations&) = delete;
  AskedAllocations& operator=(const AskedAllocations&) = delete;
  ~AskedAllocations() { allocation_fails = nullptr; }
};

[[maybe_unused]] inline void* allocate_if_asked(std::size_t bytes, std::size_t alignment) {
  bool (*const fails)() = allocation_fails.load(std::memory_order_relaxed);
  if (fails != nullptr && fails()) {
    if (const std::new_handler handler = std::get_new_handler()) {
      handler();  // as the library's operator new; it may throw
    }
    throw std::bad_alloc();
  }
  bytes = std::max<std::size_t>(bytes, 1);
  void* const memory =
      alignment == 0
          ? std::malloc(bytes)
          : std::aligned_alloc(alignment, (bytes + alignment - 1) / alignment * alignment);
  if (memory == nullptr) {
    throw std::bad_alloc();
  }
  return memory;
}

}  // namespace ptin::test

#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
#define PTIN_TEST_ALLOCATES

// The array and nothrow forms call these.
void* operator new(std::size_t bytes) { return ptin::test::allocate_if_asked(bytes, 0); }
void* operator new(std::size_t bytes, std::align_val_t alignment) {
  return ptin::test::allocate_if_asked(bytes, static_cast<std::size_t>(alignment));
}
[[gnu::noinline]] void operator delete(void* memory) noexcept { std::free(memory); }
[[gnu::noinline]] void operator delete(void* memory, std::size_t) noexcept { std::free(memory); }
[[gnu::noinline]] void operator delete(void* memory, std::align_val_t) noexcept {
  std::free(memory);
}
[[gnu::noinline]] void operator delete(void* memory, std::size_t, std::align_val_t) noexcept {
  std::free(memory);
}
#endif
