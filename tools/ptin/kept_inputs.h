// SPDX-License-Identifier: GPL-3.0-or-later
//
// An output never takes the place of what it is made from.
#pragma once

#include <CLI/CLI.hpp>

namespace ptin::tools {

/// Compares the file that -o of a parsed subcommand names, if there is one, with every file that
/// its other arguments name: by device and inode, so through links too; "-" is standard input.
/// Looks at the sources of a VRT as well. Any argument counts that is no number and names a file,
/// so that an input cannot be forgotten here.
/// @throws Error invalid_argument  the output is one of them
/// Cost: a look at each argument.
void check_inputs_are_kept(const CLI::App& command);

}  // namespace ptin::tools
