// SPDX-License-Identifier: GPL-3.0-or-later
//
// What happens when a mapped file is cut while it is mapped: reading the bytes that are lost raises
// SIGBUS.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>

namespace ptin {

/// Installs a SIGBUS handler for the whole process, once; later calls do nothing. A library does
/// not take a signal unasked: without this call, reading lost bytes ends the process.
///
/// With it, the handler maps a page of zeros over the lost page, marks the mapping as damaged, and
/// the read goes on; from then on every read from that store fails. Faults elsewhere are handed to
/// the handler that was installed before. A cut inside of a page raises no signal: the rest of that
/// page reads as zeros, and PageStore::check_unchanged() sees the cut.
/// @throws Error io_error
void install_sigbus_guard();

/// Keeps one mapping under guard, from construction to destruction. Does nothing while no handler
/// is installed.
class GuardedMapping {
 public:
  GuardedMapping(const void* address, std::size_t bytes);
  GuardedMapping(const GuardedMapping&) = delete;
  GuardedMapping& operator=(const GuardedMapping&) = delete;
  ~GuardedMapping();

  /// True once a read of this mapping has met lost bytes.
  [[nodiscard]] bool is_damaged() const noexcept {
    return range_->damaged.load(std::memory_order_acquire);
  }

  /// What the handler knows of a mapping.
  struct Range {
    std::atomic<std::uintptr_t> begin{0};
    std::atomic<std::uintptr_t> end{0};
    std::atomic<bool> damaged{false};
    std::atomic<bool> used{false};
    Range* next = nullptr;  ///< Set before the range can be found, then never changed.
  };

 private:
  Range* range_;
};

}  // namespace ptin
