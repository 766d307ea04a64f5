// SPDX-License-Identifier: GPL-3.0-or-later
//
// What TINs: PLY, OBJ, 2DM and LandXML declare.
#include "tests/tools/declarations/declaration.h"

namespace ptin::tools::testing {

std::vector<Declaration> mesh_declarations() { return {}; }

}  // namespace ptin::tools::testing
