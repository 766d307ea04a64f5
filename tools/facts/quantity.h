// SPDX-License-Identifier: GPL-3.0-or-later
//
// Numbers with a unit, as options take them: 90m, 5.8GHz.
#pragma once

#include <optional>
#include <string>

namespace ptin::tools {

struct Quantity {
  double number = 0.0;  ///< Finite.
  std::string unit;     ///< As written; empty: none was.
};

/// A decimal number, and what stands behind it, blanks between them left out: "90", "90m",
/// "5.8 GHz", "1e3km". None where the text does not begin with a finite number.
[[nodiscard]] std::optional<Quantity> quantity_of(const std::string& text);

/// A length or a height as options take it, of any sign.
struct Length {
  double number = 0.0;  ///< As written.
  double metres = 0.0;  ///< Length of the unit behind it; 0: there was none.

  [[nodiscard]] bool has_unit() const noexcept { return metres > 0; }
  /// The value in a unit of so many metres. The two feet, which differ by two millionths, are one: a
  /// foot is the one of who is asked.  REQUIRES: has_unit().
  [[nodiscard]] double in(double metres_of_unit) const noexcept;
};
/// None where the text is no number, or has a unit behind it that is none of length.
[[nodiscard]] std::optional<Length> length_of(const std::string& text);
/// Units that length_of() knows, for help and refusals: "m, km, ft".
[[nodiscard]] std::string known_length_units();

}  // namespace ptin::tools
