// SPDX-License-Identifier: GPL-3.0-or-later
//
// The look of --help: no line is longer than a terminal of 100 columns.
#pragma once

#include <string>

#include <CLI/CLI.hpp>

namespace ptin::tools {

/// CLI11's help with its long lines broken between words. Lines of a footer that begin with a blank
/// are examples, and stay as they are.
class HelpText : public CLI::Formatter {
 public:
  static constexpr std::size_t kColumns = 100;

  [[nodiscard]] std::string make_option(const CLI::Option* option,
                                        bool is_positional) const override;
  [[nodiscard]] std::string make_subcommand(const CLI::App* app) const override;
  [[nodiscard]] std::string make_description(const CLI::App* app) const override;
  [[nodiscard]] std::string make_footer(const CLI::App* app) const override;
};

}  // namespace ptin::tools
