// SPDX-License-Identifier: GPL-3.0-or-later
//
// Lines of a header of text that state CRS and units, as `ptin build` reads it again (tools/API.md, "What a
// source declares").
#pragma once

#include <string>

#include "engine/crs/crs_facts.h"

namespace ptin::tools {

/// Lines such as "crs: EPSG:25832", each behind `mark` and with its end. Without a CRS units are
/// given for plane and heights, with one that of the heights where no vertical CRS gives it.
[[nodiscard]] std::string crs_lines(const CrsFacts& crs, const std::string& mark);

}  // namespace ptin::tools
