// SPDX-License-Identifier: GPL-3.0-or-later
//
// What tests of bad input share.
#pragma once

#include <string>

#include "tests/tools/program.h"

namespace ptin::tools::testing {

/// One sentence on stderr with `words` in it, and nothing on stdout.
void expect_refusal(const Outcome& outcome, int status, const std::string& words);

/// Makes `hills.tif` in the folder, and builds `hills.ptin` of it; returns the store's path.
[[nodiscard]] std::string small_store(const TestFolder& folder);

}  // namespace ptin::tools::testing
