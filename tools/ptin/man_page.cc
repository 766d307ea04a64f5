// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/ptin/man_page.h"

#include "tools/ptin/cli.h"
#include "tools/ptin/command_line.h"

namespace ptin::tools {

namespace {

/// Text as roff prints it: backslashes and hyphens literal, no line taken for a request.
std::string escaped(const std::string& text) {
  std::string roff;
  bool at_start = true;
  for (const char c : text) {
    if (at_start && (c == '.' || c == '\'')) roff += "\\&";
    if (c == '\\') {
      roff += "\\e";
    } else if (c == '-') {
      roff += "\\-";
    } else {
      roff += c;
    }
    at_start = c == '\n';
  }
  return roff;
}

/// The text without line breaks: help breaks lines where a terminal would, a page breaks them
/// itself.
std::string on_one_line(std::string text) {
  for (char& c : text) {
    if (c == '\n') c = ' ';
  }
  return text;
}

void add_option(const ask::Parameter& row, std::string& page) {
  std::string names;
  for (const std::string& name : names_of(row)) names += (names.empty() ? "" : ", ") + name;
  page.append(".TP\n.B ").append(escaped(names));
  if (const std::string values = values_of(row); !values.empty() && !is_argument(row)) {
    page.append(" \\fI").append(escaped(values)).append("\\fR");
  }
  page.append("\n")
      .append(escaped(on_one_line(ask::help_at(row, ask::Door::kProgram))))
      .append("\n");
}

/// Adds the footer of a subcommand: paragraphs, then examples line by line.
void add_footer(const std::string& footer, std::string& page) {
  const std::size_t examples = footer.find("Example");
  const std::string before = footer.substr(0, examples);
  if (!before.empty()) page.append(".PP\n").append(escaped(on_one_line(before))).append("\n");
  if (examples == std::string::npos) return;
  page.append(".PP\n.nf\n").append(escaped(footer.substr(examples)));
  if (!page.ends_with('\n')) page += '\n';
  page.append(".fi\n");
}

}  // namespace

std::string man_page(std::span<const Command> all) {
  Context context;
  std::string page = ".TH PTIN 1 \"\" \"ptin " PTIN_VERSION "\" \"User Commands\"\n";
  page.append(".SH NAME\nptin \\- ").append(escaped(program_summary())).append("\n");
  page.append(".SH SYNOPSIS\n.B ptin\n\\fISUBCOMMAND\\fR [\\fIOPTION\\fR...]\n");
  page.append(".SH DESCRIPTION\n");
  for (const Command& command : all) {
    page.append(".TP\n.B ").append(escaped(command.name)).append("\n");
    page.append(escaped(command.summary)).append("\n");
  }
  for (const Command& command : all) {
    page.append(".SH \"PTIN ");
    for (const char* c = command.name; *c != '\0'; ++c)
      page += *c >= 'a' && *c <= 'z' ? static_cast<char>(*c - 'a' + 'A') : *c;
    page.append("\"\n").append(escaped(command.summary)).append(".\n");
    const Declared declared = declared_of(command, context);
    for (const ask::Parameter& row : declared.parameters) add_option(row, page);
    add_footer(command.examples, page);
  }
  page.append(".SH \"EXIT STATUS\"\n").append(escaped(on_one_line(exit_statuses()))).append("\n");
  return page;
}

}  // namespace ptin::tools
