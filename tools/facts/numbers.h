// SPDX-License-Identifier: GPL-3.0-or-later
//
// Checks of options that are numbers. CLI11 puts the name of the option, or of the argument, before
// what they say.
#pragma once

#include <optional>
#include <string>

#include <CLI/CLI.hpp>

#include "engine/number.h"

namespace ptin::tools {

/// Refuses a number with a minus sign: CLI11 would read the count -5 as 2^64 - 5.
[[nodiscard]] inline CLI::Validator counts() {
  return {[](const std::string& text) {
            return text.starts_with('-') ? "a count is no less than 0, and " + text + " is"
                                         : std::string();
          },
          ""};
}

/// The number that an option has where it is given this text; none where CLI11 refuses the text. One
/// that is not finite is one, for its range to refuse. Blanks may stand before it.
[[nodiscard]] inline std::optional<double> given_number(const std::string& text) {
  double number = 0.0;
  return CLI::detail::lexical_cast(text, number) ? std::optional(number) : std::nullopt;
}

/// Refuses a number beyond the range: "--level: must be a finite number, in the height's unit; nan is
/// none". What is no number CLI11 refuses.
/// @param unit  "in map units"; may be empty.
[[nodiscard]] inline CLI::Validator numbers(NumberRange range, const std::string& unit) {
  return {[range, unit](const std::string& text) {
            const std::optional<double> number = given_number(text);
            if (!number || is_in(range, *number)) return std::string();
            return std::string("must be ") + words_of(range) + (unit.empty() ? "" : ", " + unit) +
                   "; " + text + " is none";
          },
          ""};
}

}  // namespace ptin::tools
