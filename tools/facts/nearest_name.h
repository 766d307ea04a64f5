// SPDX-License-Identifier: GPL-3.0-or-later
//
// The name that was meant by one that there is not.
#pragma once

#include <span>
#include <string>

namespace ptin::tools {

/// The name that differs from `word` in the fewest letters (left out, too many, other, or exchanged
/// with the next one), the first of equals; empty where each differs in more than a third of the
/// word. A name of which `word` is the beginning, of three letters or more, is as near as one letter.
[[nodiscard]] std::string nearest_name(const std::string& word, std::span<const std::string> names);

}  // namespace ptin::tools
