// SPDX-License-Identifier: GPL-3.0-or-later
//
// An output never takes the place of what it is made from.
#pragma once

#include "tools/ask/parameter.h"

namespace ptin::tools {

/// ptin::check_inputs_are_kept() of the file that -o of a subcommand names and of every file that its other
/// arguments name. Every argument counts that is no number: so no option that takes an input can be
/// forgotten here.
/// @throws as that
void check_inputs_are_kept(const ask::Reading& reading);

}  // namespace ptin::tools
