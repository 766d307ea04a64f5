// SPDX-License-Identifier: GPL-3.0-or-later
//
// One atomic bit for each page or node: seen and found sound.
#pragma once

#include <atomic>
#include <cstdint>
#include <cstdlib>
#include <memory>
#include <new>

namespace ptin {

/// Bits that are set once and never cleared. The system gives the memory zeroed, an eighth of a
/// byte for each bit, so that many bits cost nothing before they are touched. Threads: all
/// functions may be called at once. A thread that sees a bit by test() sees all that came before
/// its set().
class TouchBits {
 public:
  /// @throws std::bad_alloc
  explicit TouchBits(std::uint64_t count)
      : words_(static_cast<std::uint64_t*>(std::calloc(count / 64 + 1, sizeof(std::uint64_t))),
               &std::free) {
    if (!words_) {
      throw std::bad_alloc();
    }
  }
  [[nodiscard]] bool test(std::uint64_t i) const noexcept {
    return ((std::atomic_ref(words_[i / 64]).load(std::memory_order_acquire) >> (i % 64)) & 1U) !=
           0;
  }
  void set(std::uint64_t i) const noexcept {
    std::atomic_ref(words_[i / 64])
        .fetch_or(std::uint64_t{1} << (i % 64), std::memory_order_release);
  }

 private:
  std::unique_ptr<std::uint64_t[], decltype(&std::free)> words_;
};

}  // namespace ptin
