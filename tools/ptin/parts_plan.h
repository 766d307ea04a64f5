// SPDX-License-Identifier: GPL-3.0-or-later
//
// The plan of a build in parts: a file that tells each job what the build was asked, and how many
// parts there are.
#pragma once

#include <string>
#include <vector>

#include "engine/construct/grid/source_warning.h"
#include "tools/ptin/build_command.h"

namespace ptin::tools {

struct PartsPlan {
  BuildCommand command;  ///< As it was given to `ptin build`, its options complete.
  std::string note;      ///< What begin_parts() says.
  std::string folder;    ///< In which the names of files are to be understood.
};

/// Begins a build in parts, and writes its plan.
/// @param arguments  Of `ptin build`, as they were given.
/// @return  What reading the source gave to be warned of.
/// @throws Error as begin_parts(); io_error, resource_exhausted
SourceWarnings write_parts_plan(const BuildCommand& command,
                                const std::vector<std::string>& arguments,
                                const BuildResources& resources);

/// @throws Error not_found, io_error; invalid_argument  the file is no plan, or one of another version
///     of the program
[[nodiscard]] PartsPlan read_parts_plan(const std::string& path);

}  // namespace ptin::tools
