// SPDX-License-Identifier: GPL-3.0-or-later
//
// The fault of a command line that does not parse, in a sentence.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "tools/ptin/command_line.h"

namespace ptin::tools {

/// "-of" where --of is an option, as GDAL's tools write it; else empty. It would be read as `-o f`.
[[nodiscard]] std::string one_hyphen_too_few(const ask::Parameters& rows,
                                             std::span<const std::string> words);

/// The fault of `word` in the place of a subcommand, in a sentence.
[[nodiscard]] std::string unknown_subcommand_sentence(const std::string& word);

/// The fault of words that do not parse, in a sentence.
/// @param usage    What was parsed of the words.
/// @param message  CLI11's, or a sentence.
/// @param given    The values of the option that a message begins with.
/// @param extra    Words that nothing takes.
[[nodiscard]] std::string usage_fault(const ParsedWords& usage, std::string message,
                                      const std::vector<std::string>& given = {},
                                      const std::vector<std::string>& extra = {});

}  // namespace ptin::tools
