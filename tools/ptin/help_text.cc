// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/ptin/help_text.h"

#include <sstream>

#include "tools/facts/human.h"

namespace ptin::tools {

std::string in_two_columns(const std::string& name, const std::string& text, std::size_t column) {
  std::string all;
  std::size_t width = 0;  // of the last line
  for (const std::string& line : wrapped(name, kHelpColumns - 6)) {
    const std::string indented = (all.empty() ? "  " : "\n      ") + line;
    all += indented;
    width = indented.size();
  }
  if (text.empty()) return all + "\n";
  bool is_beside = width + 1 < column;
  for (const std::string& line : wrapped(text, kHelpColumns - column)) {
    all += is_beside ? std::string(column - width, ' ') : "\n" + std::string(column, ' ');
    all += line;
    is_beside = false;
  }
  return all + "\n";
}

std::string reflowed(const std::string& text) {
  std::istringstream lines(text);
  std::string all, paragraph;
  const auto end_paragraph = [&] {
    if (paragraph.empty()) return;
    for (const std::string& line : wrapped(paragraph, kHelpColumns)) all += line + "\n";
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

}  // namespace ptin::tools
