// SPDX-License-Identifier: GPL-3.0-or-later
//
// What a mesh on its way out says of its CRS.
#pragma once

#include "engine/crs/crs_facts.h"
#include "tools/formats/mesh.h"

namespace ptin::tools {

/// Fills in the names of the CRS, and the lengths of its units at the middle of the mesh.
void set_crs(Mesh& mesh, const CrsFacts& crs);

}  // namespace ptin::tools
