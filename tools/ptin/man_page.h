// SPDX-License-Identifier: GPL-3.0-or-later
//
// The manual page, made from the same table as parsing, help and completion.
#pragma once

#include <string>

namespace ptin::tools {

/// ptin(1) in the macros of man(7): every subcommand with its options and examples.
[[nodiscard]] std::string man_page();

}  // namespace ptin::tools
