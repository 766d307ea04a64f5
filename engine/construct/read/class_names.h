// SPDX-License-Identifier: GPL-3.0-or-later
//
// Classes of LAS points as people write them: numbers, ranges, names, and those to leave out.
#pragma once

#include <string>
#include <vector>

namespace ptin {

/// The classes that some words name, in their order. A word holds items between commas: a number
/// (9), a range (8-12), or a name of ASPRS's in any case (ground; vegetation and noise are several
/// classes). Of a word, what comes behind `!` is left out; where all words only leave out, the other
/// classes of 0 .. 255 are kept.
/// @throws Error invalid_argument  an item is none of these, or no class is left
[[nodiscard]] std::vector<int> classes_of(const std::vector<std::string>& words);

}  // namespace ptin
