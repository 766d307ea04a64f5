// SPDX-License-Identifier: GPL-3.0-or-later
//
// Checks of the options of `build` that are numbers. CLI11 puts the name of the option, or of the
// argument, before what they say.
#pragma once

#include <cstdlib>
#include <string>

#include <CLI/CLI.hpp>

#include "tools/ask/parameter.h"

namespace ptin::tools {

/// Refuses a number with a minus sign: CLI11 would read the count -5 as 2^64 - 5.
[[nodiscard]] inline CLI::Validator counts() {
  return {[](const std::string& text) {
            return text.starts_with('-') ? "a count is no less than 0, and " + text + " is"
                                         : std::string();
          },
          ""};
}

/// Refuses a number beyond the range: "--level: must be a finite number, in the height's unit; nan is
/// none". What is no number CLI11 refuses.
/// @param unit  "in map units"; may be empty.
[[nodiscard]] inline CLI::Validator numbers(const ask::Range& range, const std::string& unit) {
  return {[range, unit](const std::string& text) {
            char* end = nullptr;
            const double number = std::strtod(text.c_str(), &end);
            const bool is_number = end != text.c_str() && *end == '\0';
            if (!is_number || range.holds(number)) return std::string();
            return "must be " + ask::words_of(range) + (unit.empty() ? "" : ", " + unit) + "; " +
                   text + " is none";
          },
          ""};
}

/// The check of a length or a height that must be a plain number, since it is asked for before anybody
/// knows the source's units.
/// @param unit  "in CRS units".
[[nodiscard]] inline CLI::Validator plain_measure(const ask::Range& range,
                                                  const std::string& unit) {
  return {[range, unit](const std::string& text) {
            const std::optional<Length> length = length_of(text);
            const std::optional<double> number =
                length ? std::optional(length->number) : ask::number_in(text);
            if (!number || !range.holds(*number)) {
              return "must be " + ask::words_of(range) + ", " + unit + "; " + text + " is none";
            }
            if (!length || !length->has_unit()) return std::string();
            return "must be a plain number, " + unit +
                   ": those of the source are not known before it is read; " + text + " has a unit";
          },
          ""};
}

}  // namespace ptin::tools
