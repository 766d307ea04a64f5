// SPDX-License-Identifier: GPL-3.0-or-later
//
// The words of a command line taken apart, by CLI11: its header, which is slow to compile, is behind
// this one.
#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "tools/ptin/command.h"

namespace ptin::tools {

/// An option or an argument as it is told: in help, by the completion script, in the manual page, and
/// in sentences about wrong use.
struct OptionFacts {
  std::vector<std::string> names;  ///< "-o", "--output"; of an argument its name alone.
  bool is_argument = false;
  std::string metavar;  ///< Of its values; empty: a flag, or an argument with no other name.
  int least_values = 0, most_values = 0;
  std::string help;
  std::vector<std::string> given;  ///< Its values, once words were read.

  /// The first long name, or else the only one: "--output", "-k", "FILE".
  [[nodiscard]] const std::string& name() const {
    for (const std::string& name : names) {
      if (name.starts_with("--")) return name;
    }
    return names.front();
  }
};
/// Puts the words behind a subcommand that has these parameters where its rows say.
/// @throws Error invalid_argument  they mean nothing
void read_words(const ask::Parameters& rows, const std::vector<std::string>& words);
/// One line about the program.
[[nodiscard]] const char* program_summary() noexcept;

/// A command line: subcommands with their options.
class CommandLine {
 public:
  /// @param all  Outlive this, as does `context`.
  explicit CommandLine(Context& context, std::span<const Command> all = commands());
  ~CommandLine();
  CommandLine(const CommandLine&) = delete;
  CommandLine& operator=(const CommandLine&) = delete;

  /// The help of the program.
  [[nodiscard]] std::string help() const;
  /// What became of words.
  struct Parsed {
    int command = -1;           ///< Its number among the subcommands.
    std::string fault;          ///< Not empty: why the words mean nothing.
    std::optional<int> status;  ///< Help or the version was printed.
  };
  /// Reads words; their values go where the options of the subcommand have them.
  [[nodiscard]] Parsed parse(const std::vector<std::string>& words);
  /// The options of a subcommand in the order of its help, with what was given; -1: of the program.
  [[nodiscard]] std::vector<OptionFacts> options_of(int command) const;
  /// Runs a subcommand whose words were read.  @throws Error
  int run(int command) const;

 private:
  struct Inside;
  std::unique_ptr<Inside> inside_;
};

}  // namespace ptin::tools
