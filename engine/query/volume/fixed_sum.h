// SPDX-License-Identifier: GPL-3.0-or-later
//
// Sums that do not depend on the order of their terms.
#pragma once

#include <cmath>
#include <cstdint>

namespace ptin {

/// A sum in fixed point, of 126 bits below a bound that is known before. Terms are cut off at the
/// last bit; the rest is exact, so that terms may come in any order and from any number of threads,
/// and a sum of 2^32 terms is good to 2^-93 of the bound.
class FixedSum {
 public:
  /// @param bound  No partial sum is larger in absolute value; finite, >= 0.
  explicit FixedSum(double bound = 0.0) noexcept
      : shift_(bound > 0 ? kBits - 1 - std::ilogb(bound) : 0) {}

  /// REQUIRES: finite, and partial sums within the bound.
  void add(double term) noexcept { sum_ += static_cast<Int128>(std::ldexp(term, shift_)); }
  /// Adds what another sum of the same bound holds.
  void add(const FixedSum& other) noexcept { sum_ += other.sum_; }
  [[nodiscard]] double value() const noexcept {
    return std::ldexp(static_cast<double>(sum_), -shift_);
  }

 private:
  __extension__ using Int128 = __int128;
  static constexpr int kBits = 126;
  int shift_;
  Int128 sum_ = 0;
};

}  // namespace ptin
