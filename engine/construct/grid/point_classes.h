// SPDX-License-Identifier: GPL-3.0-or-later
//
// How many points of a source are of which class.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <string>

namespace ptin {

/// Points that LAS does not withhold, by class, whether they are chosen or not. A plain value; all 0
/// for a source without classes.
struct PointClasses {
  std::array<std::uint64_t, 256> points{};
  std::uint64_t overlap = 0;  ///< Of these, those marked as lying where flight lines overlap.

  void join(const PointClasses& other) noexcept {
    for (std::size_t i = 0; i < points.size(); ++i) {
      points[i] += other.points[i];
    }
    overlap += other.overlap;
  }
  [[nodiscard]] bool are_known() const noexcept {
    return std::any_of(points.begin(), points.end(), [](std::uint64_t n) { return n > 0; });
  }
  /// "1, 2, 65": those that there are points of.
  [[nodiscard]] std::string names() const {
    std::string text;
    for (std::size_t i = 0; i < points.size(); ++i) {
      if (points[i] > 0) {
        text += (text.empty() ? "" : ", ") + std::to_string(i);
      }
    }
    return text;
  }
};

}  // namespace ptin
