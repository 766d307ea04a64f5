// SPDX-License-Identifier: GPL-3.0-or-later
//
// Points that lie far from all others, as faults do: found while all points are seen once.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "engine/construct/grid/source_warning.h"

namespace ptin {

/// The smallest or largest values of one coordinate, with how many points have each of them and where
/// the first of those lies (by x, then y, then height). A plain value.
struct EndValues {
  static constexpr std::size_t kKept = 4;
  struct Value {
    double value = std::numeric_limits<double>::infinity();
    std::uint64_t points = 0;
    std::array<double, 3> place{};
    std::uint64_t input = 0;  ///< The number of the file that it lies in.
  };
  /// Distinct and rising; of the largest values the negative ones, so that these rise, too.
  std::array<Value, kKept> values;

  void add(const Value& v) noexcept {
    if (v.value <= values.back().value) {
      insert(v);
    }
  }
  void join(const EndValues& other) noexcept;

 private:
  void insert(const Value& v) noexcept;
};

/// Sees points, in any order and in parts, and finds those that lie far from all others. A plain
/// value.
class FarPoints {
 public:
  void add(double x, double y, double z) noexcept {
    const std::array<double, 3> p{x, y, z};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      low_[axis].add({p[axis], 1, p, 0});
      high_[axis].add({-p[axis], 1, p, 0});
    }
  }
  void join(const FarPoints& other) noexcept;
  /// Says in which file all points so far lie.
  void set_input(std::uint64_t input) noexcept;
  /// Warns of up to three values of x, of y or of the height, each of a few points, that lie ten times
  /// as far from the next value as all others reach; and of heights that often stand for none, such
  /// as -9999, where no other height is near.
  /// @param points        How many were seen.
  /// @param files         The source, for the warnings; by the numbers of set_input().
  /// @param are_vertices  They are those of a TIN, which no box cuts.
  [[nodiscard]] SourceWarnings warnings(std::uint64_t points, const std::vector<std::string>& files,
                                        bool are_vertices) const;

 private:
  std::array<EndValues, 3> low_, high_;
};

}  // namespace ptin
