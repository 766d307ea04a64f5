// SPDX-License-Identifier: GPL-3.0-or-later
//
// The manual page and the completion script, made from the rows of the options.
#pragma once

#include <span>
#include <string>

#include "tools/ptin/command.h"

namespace ptin::tools {

/// ptin(1) in the macros of man(7): every subcommand with its options and examples.
[[nodiscard]] std::string man_page(std::span<const Command> all = commands());

/// The completion script of bash.
[[nodiscard]] std::string bash_script(std::span<const Command> all = commands());

}  // namespace ptin::tools
