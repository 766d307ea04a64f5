// SPDX-License-Identifier: GPL-3.0-or-later
//
// Whether a process sees what the one that directs the build sees.
#pragma once

#include <string>
#include <vector>

#include "engine/construct/build.h"
#include "engine/construct/tasks/task_messages.h"

namespace ptin::build_internal {

/// @throws Error invalid_argument  this process sees other inputs than the one that directs it
const BuildNote& require_same_inputs(const BuildNote& note, const std::vector<std::string>& inputs,
                                     const BuildOptions& options);

/// Waits, as long as the resources say, for the folders of the build.
/// @throws Error invalid_argument  this process does not see what the others write
const BuildNote& require_shared_folders(const BuildNote& note, const BuildResources& resources);

}  // namespace ptin::build_internal
