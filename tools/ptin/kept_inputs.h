// SPDX-License-Identifier: GPL-3.0-or-later
//
// An output never takes the place of what it is made from.
#pragma once

#include "tools/ask/parameter.h"

namespace ptin::tools {

/// Compares the file that -o of a subcommand names, if it is there, with every file that its
/// other arguments name. Files are compared by device and inode, so through links too; "-" is
/// standard input, and the files behind a VRT are compared as well. Every argument counts that
/// names a file and is no number: so no option that takes an input can be forgotten here.
/// @throws Error invalid_argument  the output is one of these files
/// Cost: a look at each argument.
void check_inputs_are_kept(const ask::Reading& reading);

}  // namespace ptin::tools
