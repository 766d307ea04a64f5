// SPDX-License-Identifier: GPL-3.0-or-later
//
// What LAS files declare.
#include "tests/tools/declarations/declaration.h"

namespace ptin::tools::testing {

std::vector<Declaration> las_declarations() { return {}; }

}  // namespace ptin::tools::testing
