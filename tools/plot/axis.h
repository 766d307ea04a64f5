// SPDX-License-Identifier: GPL-3.0-or-later
//
// Round numbers on axes, and the units beside them.
#pragma once

#include <string>
#include <vector>

namespace ptin::tools {

/// Multiples of one step, which is 1, 2 or 5 times a power of ten.
struct Ticks {
  double step = 1.0;
  std::vector<double> at;  ///< Ascending, all within the range.
};
/// The finest ticks within [low, high] of which there are at most `most`.
/// REQUIRES: finite, low <= high, most > 1.
[[nodiscard]] Ticks round_ticks(double low, double high, int most);
/// A tick as text: as many decimals as its step needs.
[[nodiscard]] std::string tick_text(double value, double step);
/// The largest of 1, 2, 5, 10 ... that is not above `value`.  REQUIRES: value > 0, finite.
[[nodiscard]] double round_below(double value);

/// "m", "ft", "km" of a unit's name; empty when it is unknown, else the name itself.
[[nodiscard]] std::string short_unit(const std::string& name);

/// The unit that lengths are shown in.
struct ShownUnit {
  double size = 1.0;  ///< In the unit that the lengths have.
  std::string name;   ///< Short; may be empty.
  /// "what, unit".
  [[nodiscard]] std::string title(const std::string& what) const;
  /// A number and its unit; in metres what is shorter than the kilometre.
  [[nodiscard]] std::string text(double length) const;
};
/// Kilometres for lengths in metres that reach 10 km, else the unit itself.
[[nodiscard]] ShownUnit shown_unit(const std::string& unit_name, double longest);

}  // namespace ptin::tools
