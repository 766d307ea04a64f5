// SPDX-License-Identifier: GPL-3.0-or-later
//
// Stores that the builder made of the small real terrains in tests/data, one of each a process.
#pragma once

#include <string>

#include "engine/query/questions.h"

namespace ptin::reference {

/// @param name       A file of tests/data.
/// @param max_error  As BuildOptions: what the file leaves out.
[[nodiscard]] const Terrain& built_terrain(const std::string& name, double max_error = 0.0);

}  // namespace ptin::reference
