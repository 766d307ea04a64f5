// SPDX-License-Identifier: GPL-3.0-or-later
//
// How many of their cases the tests look at that repeat one thing very often.
#pragma once

#include <cstdlib>

namespace ptin::test {

/// `n`: look at each n-th case, or at an n-th of them. 1 where the environment has PTIN_ALL_CASES.
inline int share_of_cases(int n) { return std::getenv("PTIN_ALL_CASES") != nullptr ? 1 : n; }

}  // namespace ptin::test
