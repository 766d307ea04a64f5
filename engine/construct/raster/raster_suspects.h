// SPDX-License-Identifier: GPL-3.0-or-later
//
// Values that often stand for no height, in a raster that does not say so.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <vector>

namespace ptin {

/// Looks for values that programs write where there is no height (-9999, -32768, 1e20 and their
/// like) among stored values that count as heights. One of them is suspect where it lies apart from
/// all other values: a depth of 9999 m lies among others. A plain value.
class RasterSuspects {
 public:
  static constexpr std::size_t kKinds = 13;
  /// One value, or all huge ones of one sign; where it is first, row by row from the north.
  struct Suspect {
    std::uint64_t count = 0;
    std::uint64_t first = std::numeric_limits<std::uint64_t>::max();
    double value = 0.0;  ///< The first one's.
  };

  /// Adds values of which the smallest and the largest are known: a look at each is needed only where
  /// these reach as far as a suspect does.
  /// @param place_of  The place in the raster of the i-th value, row by row from the north.
  template <class T, class Place>
  void add(std::span<const T> values, std::span<const std::uint8_t> valid, double low, double high,
           const Place& place_of) {
    if (!may_hold_some(low, high)) {
      add_others(low, high);
      return;
    }
    for (std::size_t i = 0; i < values.size(); ++i) {
      if (valid[i] != 0) {
        add(static_cast<double>(values[i]), place_of(i));
      }
    }
  }
  void join(const RasterSuspects& other);
  /// Those that are suspect, when all values have been seen.
  [[nodiscard]] std::vector<Suspect> apart() const;

 private:
  [[nodiscard]] static bool may_hold_some(double low, double high) noexcept;
  [[nodiscard]] static std::optional<std::size_t> kind_of(double value) noexcept;
  void add_others(double low, double high) noexcept;
  void add(double value, std::uint64_t place);

  std::array<Suspect, kKinds> kinds_{};
  double low_ = std::numeric_limits<double>::infinity();  ///< The least of all other values.
  double high_ = -std::numeric_limits<double>::infinity();
};

}  // namespace ptin
