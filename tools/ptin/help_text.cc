// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/ptin/help_text.h"

#include <sstream>

#include "tools/facts/human.h"

namespace ptin::tools {

namespace {

/// A name on the left, and what it is on the right, from a column on.
std::string in_two_columns(const std::string& name, const std::string& text, std::size_t column) {
  std::string all;
  std::size_t width = 0;  // of the last line
  for (const std::string& line : wrapped(name, HelpText::kColumns - 6)) {
    const std::string indented = (all.empty() ? "  " : "\n      ") + line;
    all += indented;
    width = indented.size();
  }
  if (text.empty()) return all + "\n";
  bool is_beside = width + 1 < column;
  for (const std::string& line : wrapped(text, HelpText::kColumns - column)) {
    all += is_beside ? std::string(column - width, ' ') : "\n" + std::string(column, ' ');
    all += line;
    is_beside = false;
  }
  return all + "\n";
}

/// Paragraphs with their lines broken anew. A line that begins with a blank stays as it is.
std::string reflowed(const std::string& text) {
  std::istringstream lines(text);
  std::string all, paragraph;
  const auto end_paragraph = [&] {
    if (paragraph.empty()) return;
    for (const std::string& line : wrapped(paragraph, HelpText::kColumns)) all += line + "\n";
    paragraph.clear();
  };
  for (std::string line; std::getline(lines, line);) {
    if (line.empty() || line.front() == ' ') {
      end_paragraph();
      all += line + "\n";
    } else {
      paragraph += (paragraph.empty() ? "" : " ") + line;
    }
  }
  end_paragraph();
  return all;
}

}  // namespace

std::string HelpText::make_option(const CLI::Option* option, bool is_positional) const {
  return in_two_columns(make_option_name(option, is_positional) + make_option_opts(option),
                        make_option_desc(option), get_column_width());
}

std::string HelpText::make_subcommand(const CLI::App* app) const {
  return in_two_columns(app->get_display_name(true), app->get_description(), get_column_width());
}

std::string HelpText::make_description(const CLI::App* app) const {
  return reflowed(CLI::Formatter::make_description(app));
}

std::string HelpText::make_footer(const CLI::App* app) const {
  return reflowed(CLI::Formatter::make_footer(app));
}

}  // namespace ptin::tools
