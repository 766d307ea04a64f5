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

/// A length as options take it.
struct Length {
  double number = 0.0;  ///< > 0; metres where it is one over ground.
  bool is_on_ground =
      false;  ///< It was given in m, km or ft: over ground, whatever the map unit is.
};
/// None where the text is no number above 0, or has another unit behind it.
[[nodiscard]] std::optional<Length> length_of(const std::string& text);

}  // namespace ptin::tools
