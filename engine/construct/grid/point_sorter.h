// SPDX-License-Identifier: GPL-3.0-or-later
//
// Points to be sorted along a curve, by ExternalSorter.
#pragma once

#include <cstdint>

namespace ptin {

/// A point to be sorted along the curve; points that fall together are sorted by height.
struct KeyedHeight {
  std::uint64_t key = 0;  ///< PointOrder::key() of its position.
  double height = 0.0;    ///< As PointGrid::height() has it; no NaN.
  friend bool operator==(const KeyedHeight&, const KeyedHeight&) = default;
  friend bool operator<(const KeyedHeight& a, const KeyedHeight& b) noexcept {
    return a.key != b.key ? a.key < b.key : a.height < b.height;
  }
};

/// A point that knows its place in the source: those that fall together are sorted by it.
struct NumberedHeight {
  std::uint64_t key = 0;
  double height = 0.0;
  std::uint64_t number = 0;  ///< How many points of the source come before it.
  friend bool operator<(const NumberedHeight& a, const NumberedHeight& b) noexcept {
    return a.key != b.key ? a.key < b.key : a.number < b.number;
  }
};

}  // namespace ptin
