// SPDX-License-Identifier: GPL-3.0-or-later
//
// The words of a command line taken apart, by CLI11: its header, which is slow to compile, is behind
// this one.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "tools/ptin/command.h"

namespace ptin::tools {

/// The names of a parameter: "-o" and "--output"; of an argument its name alone.
[[nodiscard]] std::vector<std::string> names_of(const ask::Parameter& row);
[[nodiscard]] bool is_argument(const ask::Parameter& row);
/// The value's name and which values there are: "TEXT:{stars,splits}", "N in [1 - 1024]"; empty of a
/// flag, and of an argument with no other name.
[[nodiscard]] std::string values_of(const ask::Parameter& row);
/// One line about the program.
[[nodiscard]] const char* program_summary() noexcept;

/// A subcommand with the parameters of the command line that it has and that every one has: --help
/// first, --json and --quiet last.
/// @param context  Outlives what is declared.
[[nodiscard]] Declared declared_of(const Command& command, Context& context);
/// Puts the words behind a subcommand that has these parameters where its rows say.
/// @throws Error invalid_argument  they mean nothing
void read_words(ask::Parameters rows, const std::vector<std::string>& words);

/// What became of the words of a command line.
struct ParsedWords {
  std::span<const std::string> words{};
  const Command* command = nullptr;  ///< Null: they name none.
  Declared declared;                 ///< Its values are where its rows have them.
  std::string fault;                 ///< Not empty: why the words mean nothing.
  std::optional<int> status;         ///< Help or the version was printed.
};
[[nodiscard]] ParsedWords parse_words(const std::vector<std::string>& words, Context& context,
                                      std::span<const Command> all = commands());

}  // namespace ptin::tools
