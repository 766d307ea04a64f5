// SPDX-License-Identifier: GPL-3.0-or-later
//
// Why points of a source are not built from, and how many.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace ptin {

/// The first of these that holds of a point counts.
enum class LeftOutReason : std::uint8_t {
  kInvalid,     ///< Its row of a text is no point (--skip-invalid).
  kWithheld,    ///< LAS says so.
  kClass,       ///< LAS: of a class that is not wanted.
  kReturn,      ///< LAS: of a return that is not wanted.
  kNoHeight,    ///< A layer has none for it.
  kNodata,      ///< Its height is the one that means none.
  kBounds,      ///< Outside of the bounds.
  kBoundary,    ///< Outside of the boundary.
  kNoTriangle,  ///< A vertex of a TIN that no triangle names.
};

/// Points that were left out, by reason. A plain value.
class LeftOutPoints {
 public:
  static constexpr std::size_t kReasons = 9;
  void add(LeftOutReason reason, std::uint64_t points = 1) noexcept {
    counts_[static_cast<std::size_t>(reason)] += points;
  }
  void join(const LeftOutPoints& other) noexcept {
    for (std::size_t i = 0; i < kReasons; ++i) {
      counts_[i] += other.counts_[i];
    }
  }
  [[nodiscard]] std::uint64_t of(LeftOutReason reason) const noexcept {
    return counts_[static_cast<std::size_t>(reason)];
  }
  [[nodiscard]] std::uint64_t total() const noexcept {
    std::uint64_t all = 0;
    for (const std::uint64_t count : counts_) {
      all += count;
    }
    return all;
  }

 private:
  std::array<std::uint64_t, kReasons> counts_{};
};

}  // namespace ptin
