// SPDX-License-Identifier: GPL-3.0-or-later
//
// The CRS that a .prj beside a file states, as ESRI's programs and many others write it.
#pragma once

#include <string>

#include "engine/construct/grid/source_warning.h"

namespace ptin {

/// Sets `crs` from the .prj beside a file that names none. Warns of one that names another CRS than the
/// file, whose own one is believed.
/// @param crs  The one that the file declares, or "".
/// Cost: asks the system for one or two names.
void take_crs_beside(const std::string& path, std::string& crs, SourceWarnings& warnings);

}  // namespace ptin
