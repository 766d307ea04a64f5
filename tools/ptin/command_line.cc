// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/ptin/command_line.h"

#include <algorithm>
#include <cstdio>
#include <memory>
#include <span>
#include <sstream>
#include <string>
#include <utility>

#include <CLI/CLI.hpp>

#include "engine/error.h"
#include "tools/error_status.h"
#include "tools/facts/human.h"
#include "tools/ptin/cli.h"
#include "tools/ptin/usage_fault.h"

namespace ptin::tools {

namespace {

// No line of help is longer than a terminal of 100 columns.
constexpr std::size_t kHelpColumns = 100;

/// A name on the left, and what it is on the right, from a column on.
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

/// Paragraphs with their lines broken anew. A line that begins with a blank is an example, and stays
/// as it is.
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

/// CLI11's help with its long lines broken between words.
class HelpFormatter : public CLI::Formatter {
 public:
  [[nodiscard]] std::string make_option(const CLI::Option* option,
                                        bool is_positional) const override {
    return in_two_columns(make_option_name(option, is_positional) + make_option_opts(option),
                          make_option_desc(option), get_column_width());
  }
  [[nodiscard]] std::string make_subcommand(const CLI::App* app) const override {
    return in_two_columns(app->get_display_name(true), app->get_description(), get_column_width());
  }
  [[nodiscard]] std::string make_description(const CLI::App* app) const override {
    return reflowed(CLI::Formatter::make_description(app));
  }
  [[nodiscard]] std::string make_footer(const CLI::App* app) const override {
    return reflowed(CLI::Formatter::make_footer(app));
  }
};

/// Whether a list of names between blanks has one.
bool has_name(std::string_view list, std::string_view name) {
  return (" " + std::string(list) + " ").find(" " + std::string(name) + " ") != std::string::npos;
}

/// What help says of a parameter behind its name: "E Excludes: --vertices".
std::string help_of_value(const ask::Parameter& row, const ask::Parameters& rows) {
  std::string text = values_of(row);
  if (!row.default_value.empty()) text += "=" + row.default_value;
  if (row.most_values == ask::kAnyNumberOfValues && !row.metavar.ends_with("...")) text += " ...";
  if (is_at(row.required, ask::Door::kProgram)) text += " REQUIRED";
  std::string needed, excluded;
  for (const ask::Parameter& other : rows) {
    const std::string name = " " + ask::name_at(other, ask::Door::kProgram);
    if (has_name(row.needs, other.name)) needed += name;
    // One of both says that they exclude each other; help tells it at both.
    if (has_name(row.excludes, other.name) || has_name(other.excludes, row.name)) excluded += name;
  }
  if (!needed.empty()) text += " Needs:" + needed;
  if (!excluded.empty()) text += " Excludes:" + excluded;
  return text.starts_with(' ') ? text.substr(1) : text;
}

/// Declares one of `rows`, which outlive `app`.
void declare(CLI::App& app, const ask::Parameter& row, const ask::Parameters& rows,
             ask::Reading& reading) {
  const std::string words =
      row.words.empty() ? "--" + std::string(row.name) : std::string(row.words);
  const std::string help = ask::help_at(row, ask::Door::kProgram);
  CLI::Option* option = nullptr;
  if (ask::is_flag(row)) {
    option = app.add_flag_callback(
        words, [&row, &reading] { reading.take(row, {}); }, help);
  } else {
    option = app.add_option(words, CLI::callback_t([&row, &reading](const CLI::results_t& texts) {
                              reading.take(row, texts);
                              return true;
                            }),
                            help);
    const bool has_any_number = row.repeats || row.most_values == ask::kAnyNumberOfValues;
    // An option has a value behind it, even where a list of JSON may be empty.
    option->expected(static_cast<int>(std::max(row.least_values, 1U)),
                     has_any_number ? -1 : static_cast<int>(row.most_values));
    option->allow_extra_args(!row.repeats && row.most_values > 1);
    option->type_name(values_of(row));
    if (row.splits_at_commas) option->delimiter(',');
  }
  if (is_at(row.required, ask::Door::kProgram)) option->required();
  if (const std::string text = help_of_value(row, rows); !text.empty()) option->option_text(text);
}

/// CLI11 has this flag of itself.
ask::Parameter help_row() {
  return {.name = "help",
          .words = "-h,--help",
          .into = static_cast<bool*>(nullptr),
          .help = "Print help and exit"};
}

/// Adds what every subcommand has.
void add_common(ask::Parameters& rows, Context& context) {
  rows.add("json", &context.json, "", "Print the answer, and an error, as JSON");
  rows.add("quiet", &context.quiet, "", "No progress, report or warning: on stderr errors alone")
      .spelled("-q,--quiet");
}

void declare(CLI::App& app, const ask::Parameters& rows, ask::Reading& reading) {
  for (const ask::Parameter& row : rows) {
    if (row.name != help_row().name) declare(app, row, rows, reading);
  }
}

/// The values of the option with whose name a message of CLI11's begins.
std::vector<std::string> given_in(const CLI::App& app, const std::string& message) {
  for (const CLI::Option* const option : app.get_options()) {
    if (message.starts_with(option->get_name() + ": ")) return option->results();
  }
  return {};
}

}  // namespace

std::vector<std::string> names_of(const ask::Parameter& row) {
  if (row.words.empty()) return {"--" + std::string(row.name)};
  const std::vector<std::string_view> names = ask::parts_of(row.words, ',');
  return {names.begin(), names.end()};
}

bool is_argument(const ask::Parameter& row) {
  return !row.words.empty() && !row.words.starts_with('-');
}

std::string values_of(const ask::Parameter& row) {
  if (ask::is_flag(row)) return {};
  std::string text(row.metavar);
  const char* before = text.empty() ? "{" : ":{";
  for (const std::string_view choice : row.choices) {
    text.append(before).append(choice);
    before = ",";
  }
  if (!row.choices.empty()) text += "}";
  const auto [least, most] = std::pair(row.range.least, row.range.most);
  if (least > NumberRange::kFinite.least && most < NumberRange::kFinite.most) {
    text += " in [" + short_number(least) + " - " + short_number(most) + "]";
  }
  return text;
}

const char* program_summary() noexcept {
  return "Progressive TINs on disk: terrains larger than memory, refined exactly where asked";
}

Declared declared_of(const Command& command, Context& context) {
  Declared declared = command.declare(context);
  declared.parameters.keep(ask::Door::kProgram);
  declared.parameters.insert(declared.parameters.begin(), help_row());
  add_common(declared.parameters, context);
  return declared;
}

void read_words(ask::Parameters rows, const std::vector<std::string>& words) {
  Context context;
  add_common(rows, context);
  CLI::App app;
  declare(app, rows, *context.reading);
  try {
    app.parse(std::vector<std::string>(words.rbegin(), words.rend()));
  } catch (const CLI::ParseError& error) {
    refuse(error.what());
  }
  context.reading->check(rows);
}

ParsedWords parse_words(const std::vector<std::string>& words, Context& context,
                        std::span<const Command> all) {
  CLI::App app{program_summary(), "ptin"};
  app.set_version_flag("--version", std::string("ptin ").append(PTIN_VERSION));
  app.set_help_flag("-h,--help", help_row().help);
  app.require_subcommand(1);
  app.formatter(std::make_shared<HelpFormatter>());
  app.footer(std::string("`ptin SUBCOMMAND --help` tells more and gives examples.\n\n")
                 .append(exit_statuses()));
  CLI::App* asked = &app;
  ParsedWords parsed;
  parsed.words = words;
  parsed.declared.parameters = {help_row()};
  parsed.declared.parameters.add("version", static_cast<bool*>(nullptr), "", "");
  for (const Command& command : all) {
    CLI::App* const sub = app.add_subcommand(command.name, command.summary);
    sub->footer(command.examples);
    if (words.empty() || words[0] != command.name) continue;
    asked = sub;
    parsed.command = &command;
    parsed.declared = declared_of(command, context);
    declare(*sub, parsed.declared.parameters, *context.reading);
  }
  if (words.empty()) {
    std::fputs(app.help().c_str(), stderr);
    parsed.status = status_of(ErrorCode::invalid_argument).exit;
    return parsed;
  }
  const ask::Parameters& rows = parsed.declared.parameters;
  if (const std::string word = one_hyphen_too_few(rows, words); !word.empty()) {
    parsed.fault = word + " has one hyphen; the option is -" + word;
    return parsed;
  }
  try {
    app.parse(
        std::vector<std::string>(words.rbegin(), words.rend()));  // CLI11 wants the last first
    context.reading->check(rows);
  } catch (const CLI::Success& success) {  // --help, --version
    parsed.status = app.exit(success);
  } catch (const CLI::ParseError& error) {
    parsed.fault =
        usage_fault(parsed, error.what(), given_in(*asked, error.what()), asked->remaining());
    if (dynamic_cast<const CLI::RequiredError*>(&error) == nullptr) return parsed;
    try {
      context.reading->check(rows);
    } catch (const Error& missing) {
      parsed.fault = usage_fault(parsed, missing.what());
    }
  } catch (const Error& error) {
    parsed.fault = usage_fault(parsed, error.what());
  }
  return parsed;
}

}  // namespace ptin::tools
