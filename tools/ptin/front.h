// SPDX-License-Identifier: GPL-3.0-or-later
//
// Which command lines the front program answers (tools/README.md, "Two programs").
#pragma once

#include "tools/ptin/command.h"

namespace ptin::tools {

/// Whether a subcommand is likely to need nothing of GDAL, PROJ and libcurl with the values that it
/// was given. It must be false of what reads standard input, which cannot be read twice.
[[nodiscard]] bool is_for_front(const Command& command, const ask::Reading& reading);

}  // namespace ptin::tools
