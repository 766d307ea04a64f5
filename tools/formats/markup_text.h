// SPDX-License-Identifier: GPL-3.0-or-later
//
// Texts as XML and HTML hold them.
#pragma once

#include <string>
#include <string_view>

namespace ptin::tools {

/// A text as character data, and as an attribute between double quotes; a blank in the place of each
/// control character.
[[nodiscard]] std::string markup_text(std::string_view text);

}  // namespace ptin::tools
