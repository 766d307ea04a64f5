// SPDX-License-Identifier: GPL-3.0-or-later
//
// What holds for options that count.
#pragma once

#include <cstdlib>
#include <string>

#include <CLI/CLI.hpp>

namespace ptin::tools {

/// Refuses a sign, which CLI11 would turn from -5 into 2^64 - 5.
[[nodiscard]] inline CLI::Validator counts() {
  return {[](const std::string& text) {
            return text.starts_with('-') ? "a count is no less than 0, and " + text + " is"
                                         : std::string();
          },
          ""};
}

/// Refuses what lies below 0, in fewer words than CLI11, whose sentence holds its 300 digits of the
/// largest number.
[[nodiscard]] inline CLI::Validator not_negative() {
  return {[](const std::string& text) {
            return std::strtod(text.c_str(), nullptr) < 0
                       ? "a number no less than 0 is wanted, and " + text + " is less"
                       : std::string();
          },
          ""};
}

}  // namespace ptin::tools
