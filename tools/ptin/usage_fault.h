// SPDX-License-Identifier: GPL-3.0-or-later
//
// The fault of a command line that does not parse, in a sentence.
#pragma once

#include <span>
#include <string>

#include <CLI/CLI.hpp>

namespace ptin::tools {

/// "-of" where --of is an option of `app`, as GDAL's tools write it; else empty. It would be read as
/// `-o f`.
[[nodiscard]] std::string one_hyphen_too_few(const CLI::App& app,
                                             std::span<const std::string> words);

/// The fault of `word` in the place of a subcommand, in a sentence.
[[nodiscard]] std::string unknown_subcommand_sentence(const CLI::App& program,
                                                      const std::string& word);

/// The fault of the words behind a subcommand, or behind `ptin` where there is none.
/// @param app  The one that reads them, as far as it came.
[[nodiscard]] std::string usage_fault(const CLI::App& app, std::span<const std::string> words,
                                      const CLI::ParseError& error);

}  // namespace ptin::tools
