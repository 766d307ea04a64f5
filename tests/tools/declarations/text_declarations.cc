// SPDX-License-Identifier: GPL-3.0-or-later
//
// What points as text declare.
#include "tests/tools/declarations/declaration.h"

namespace ptin::tools::testing {

std::vector<Declaration> text_declarations() { return {}; }

}  // namespace ptin::tools::testing
