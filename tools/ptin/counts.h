// SPDX-License-Identifier: GPL-3.0-or-later
//
// What holds for options that count.
#pragma once

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

}  // namespace ptin::tools
