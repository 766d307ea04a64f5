// SPDX-License-Identifier: GPL-3.0-or-later
//
// The look of --help: no line is longer than a terminal of 100 columns.
#pragma once

#include <cstddef>
#include <string>

namespace ptin::tools {

inline constexpr std::size_t kHelpColumns = 100;

/// A name on the left, and what it is on the right, from a column on.
[[nodiscard]] std::string in_two_columns(const std::string& name, const std::string& text,
                                         std::size_t column);
/// Paragraphs with their lines broken anew. A line that begins with a blank is an example, and stays
/// as it is.
[[nodiscard]] std::string reflowed(const std::string& text);

}  // namespace ptin::tools
