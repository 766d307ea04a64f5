// SPDX-License-Identifier: GPL-3.0-or-later
//
// The one checksum of the format: XXH3, 64 bits, seed 0. Finds damage; no defence against intent.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>

namespace ptin {

[[nodiscard]] std::uint64_t checksum_of(std::span<const std::byte> bytes) noexcept;

/// checksum_of() bytes that come in parts.
class RunningChecksum {
 public:
  RunningChecksum();
  RunningChecksum(const RunningChecksum&) = delete;
  RunningChecksum& operator=(const RunningChecksum&) = delete;
  ~RunningChecksum();

  void add(std::span<const std::byte> part) noexcept;
  [[nodiscard]] std::uint64_t bytes() const noexcept { return bytes_; }  ///< Added so far.
  [[nodiscard]] std::uint64_t value() const noexcept;                    ///< That of all so far.

 private:
  struct State;
  std::unique_ptr<State> state_;
  std::uint64_t bytes_ = 0;
};

/// Checksum of the bytes of a plain structure.
template <class T>
[[nodiscard]] std::uint64_t checksum_of_object(const T& object) noexcept {
  return checksum_of(std::as_bytes(std::span(&object, 1)));
}

}  // namespace ptin
