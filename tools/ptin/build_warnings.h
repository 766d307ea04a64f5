// SPDX-License-Identifier: GPL-3.0-or-later
//
// Warnings of a build: one list, in words and in JSON.
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "engine/construct/build.h"
#include "engine/construct/grid/source_warning.h"
#include "tools/ptin/build_command.h"
#include "tools/ptin/command.h"

namespace ptin::tools {

/// Those of the readers, then those of what came of the whole: far merged heights, inputs without a
/// point, no surface.
[[nodiscard]] SourceWarnings build_warnings(const BuildCommand& command, const BuildReport& report);

/// A line each on stderr; nothing with --json or -q.
void print_warnings(const SourceWarnings& warnings, const Context& context);

/// tools/API.md, "JSON": `warnings` of `build`.
[[nodiscard]] nlohmann::json warnings_json(const SourceWarnings& warnings);

}  // namespace ptin::tools
