// SPDX-License-Identifier: GPL-3.0-or-later
//
// What layers that OGR reads declare.
#include "tests/tools/declarations/declaration.h"

namespace ptin::tools::testing {

std::vector<Declaration> layer_declarations() { return {}; }

}  // namespace ptin::tools::testing
