// SPDX-License-Identifier: GPL-3.0-or-later
//
// Things that reach from one y to another, found by y: the sides of a region by those who cut or ask
// at it.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "engine/geometry/interval.h"

namespace ptin {

/// Bins along y, each with the numbers of the things that reach into it, ascending. Threads:
/// immutable.
class BinsAlongY {
 public:
  /// Nothing.
  BinsAlongY() = default;
  /// @param reaches  Where each thing begins and ends, finite, lo <= hi.
  /// Cost: linear in the things, in time and memory: there are as many bins as they are, or fewer
  /// where they are tall.
  explicit BinsAlongY(std::span<const Interval> reaches);

  /// Calls visit(number), once each, for all things that reach from `low` to `high` somewhere, and
  /// for some that are near.
  template <class Visit>
  void visit(double low, double high, const Visit& visit) const {
    if (begin_.empty()) return;
    const std::size_t first = bin_of(low), last = bin_of(high);
    for (std::size_t bin = first; bin <= last; ++bin) {
      for (const std::uint32_t i : in_bin(bin)) {
        // What reaches into several of these bins is met in each, and visited in the first.
        if (std::max<std::size_t>(first_bin_[i], first) == bin) visit(i);
      }
    }
  }
  /// True as soon as test(number) is true of one of the same things, each of which may be asked about
  /// several times.
  template <class Test>
  [[nodiscard]] bool any(double low, double high, const Test& test) const {
    if (begin_.empty()) return false;
    const std::size_t last = bin_of(high);
    for (std::size_t bin = bin_of(low); bin <= last; ++bin) {
      const std::span<const std::uint32_t> numbers = in_bin(bin);
      if (std::any_of(numbers.begin(), numbers.end(), test)) return true;
    }
    return false;
  }
  /// The numbers of all things that reach to `y`, and of some that are near.
  [[nodiscard]] std::span<const std::uint32_t> at(double y) const noexcept {
    return begin_.empty() ? std::span<const std::uint32_t>{} : in_bin(bin_of(y));
  }

 private:
  /// Monotone in y: so things and questions that share a y share a bin, however it is rounded.
  [[nodiscard]] std::size_t bin_of(double y) const noexcept {
    const auto last = static_cast<double>(begin_.size() - 2);
    return static_cast<std::size_t>(std::clamp((y - low_) * bins_per_unit_, 0.0, last));
  }
  [[nodiscard]] std::span<const std::uint32_t> in_bin(std::size_t bin) const noexcept {
    return std::span(numbers_).subspan(begin_[bin], begin_[bin + 1] - begin_[bin]);
  }

  /// Those in bin i are numbers_[begin_[i], begin_[i + 1]); empty when there is nothing.
  std::vector<std::uint32_t> begin_, numbers_;
  std::vector<std::uint32_t> first_bin_;  ///< One for each thing.
  double low_ = 0.0, bins_per_unit_ = 0.0;
};

}  // namespace ptin
