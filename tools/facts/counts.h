// SPDX-License-Identifier: GPL-3.0-or-later
//
// Checks of options that are counts, or numbers that are not negative.
#pragma once

#include <cstdlib>
#include <string>

#include <CLI/CLI.hpp>

namespace ptin::tools {

/// Refuses a number with a minus sign: CLI11 would read the count -5 as 2^64 - 5.
[[nodiscard]] inline CLI::Validator counts() {
  return {[](const std::string& text) {
            return text.starts_with('-') ? "a count is no less than 0, and " + text + " is"
                                         : std::string();
          },
          ""};
}

/// Refuses a number below 0. The message is shorter than that of CLI11's own check, which holds the
/// 300 digits of the largest number.
[[nodiscard]] inline CLI::Validator not_negative() {
  return {[](const std::string& text) {
            return std::strtod(text.c_str(), nullptr) < 0
                       ? "a number no less than 0 is wanted, and " + text + " is less"
                       : std::string();
          },
          ""};
}

}  // namespace ptin::tools
