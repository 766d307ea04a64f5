// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/ptin/command_line.h"

#include <algorithm>
#include <span>
#include <string>
#include <utility>

#include <CLI/CLI.hpp>

#include "engine/error.h"
#include "tools/facts/human.h"
#include "tools/ptin/cli.h"
#include "tools/ptin/help_text.h"
#include "tools/ptin/usage_fault.h"

namespace ptin::tools {

namespace {

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

/// The value's name and which values there are: "TEXT:{stars,splits}", "N in [1 - 1024]".
std::string values_of(const ask::Parameter& row) {
  std::string text(row.metavar);
  const char* before = text.empty() ? "{" : ":{";
  for (const std::string_view choice : row.choices) {
    text.append(before).append(choice);
    before = ",";
  }
  if (!row.choices.empty()) text += "}";
  const auto [least, most] = std::pair(row.range.least, row.range.most);
  if (least > ask::kFinite.least && most < ask::kFinite.most) {
    text += " in [" + short_number(least) + " - " + short_number(most) + "]";
  }
  return text;
}

/// What help says of a parameter behind its name: "E Excludes: --vertices".
std::string help_of_value(const ask::Parameter& row, const ask::Parameters& rows) {
  std::string text = values_of(row);
  const std::string by_default = row.shows_default ? ask::default_of(row) : std::string();
  if (!by_default.empty()) text += "=" + by_default;
  if (row.most_values == ask::kAnyNumberOfValues && !row.metavar.ends_with("...")) text += " ...";
  if (is_at(row.required, ask::Door::kProgram)) text += " REQUIRED";
  std::string needed, excluded;
  for (const ask::Parameter& other : rows) {
    if (!is_at(other.doors, ask::Door::kProgram)) continue;
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
    option->expected(static_cast<int>(row.least_values),
                     has_any_number ? -1 : static_cast<int>(row.most_values));
    option->allow_extra_args(!row.repeats && row.most_values > 1);
    option->type_name(values_of(row));
    if (row.splits_at_commas) option->delimiter(',');
  }
  if (is_at(row.required, ask::Door::kProgram)) option->required();
  if (const std::string text = help_of_value(row, rows); !text.empty()) option->option_text(text);
}

/// Declares parameters, and what holds for every subcommand; last, so that --help ends with it.
void declare(CLI::App& app, const ask::Parameters& rows, Context& context) {
  for (const ask::Parameter& row : rows) {
    if (is_at(row.doors, ask::Door::kProgram)) declare(app, row, rows, *context.reading);
  }
  app.add_flag("--json", context.json, "Print the answer, and an error, as JSON");
  app.add_flag("-q,--quiet", context.quiet,
               "No progress, report or warning: on stderr errors alone");
}

OptionFacts facts_of(const CLI::Option& option) {
  OptionFacts facts;
  for (const std::string& name : option.get_snames()) facts.names.push_back("-" + name);
  for (const std::string& name : option.get_lnames()) facts.names.push_back("--" + name);
  facts.is_argument = facts.names.empty();
  if (facts.is_argument) facts.names.push_back(option.get_name());
  if (option.get_type_size() != 0) facts.metavar = option.get_type_name();
  facts.least_values = option.get_items_expected_min();
  facts.most_values = option.get_items_expected_max();
  facts.help = option.get_description();
  facts.given = option.results();
  return facts;
}

}  // namespace

struct CommandLine::Inside {
  std::span<const Command> commands;
  CLI::App app{program_summary(), "ptin"};
  std::vector<Declared> declared;
  ask::Reading* reading = nullptr;
};

void read_words(const ask::Parameters& rows, const std::vector<std::string>& words) {
  Context context;
  CLI::App app;
  declare(app, rows, context);
  try {
    app.parse(std::vector<std::string>(words.rbegin(), words.rend()));
  } catch (const CLI::ParseError& error) {
    refuse(error.what());
  }
  context.reading->check(rows);
}

const char* program_summary() noexcept {
  return "Progressive TINs on disk: terrains larger than memory, refined exactly where asked";
}

CommandLine::CommandLine(Context& context, std::span<const Command> all)
    : inside_(std::make_unique<Inside>()) {
  CLI::App& app = inside_->app;
  inside_->commands = all;
  inside_->declared.reserve(all.size());  // Options point at the rows.
  inside_->reading = context.reading.get();
  app.set_version_flag("--version", std::string("ptin ").append(PTIN_VERSION));
  app.set_help_flag("-h,--help", "Print help and exit");
  app.require_subcommand(1);
  app.formatter(std::make_shared<HelpFormatter>());
  app.footer(std::string("`ptin SUBCOMMAND --help` tells more and gives examples.\n\n")
                 .append(exit_statuses()));
  for (const Command& command : all) {
    CLI::App* const sub = app.add_subcommand(command.name, command.summary);
    sub->footer(command.examples);
    inside_->declared.push_back(command.declare(context));
    declare(*sub, inside_->declared.back().parameters, context);
  }
}

CommandLine::~CommandLine() = default;

std::string CommandLine::help() const { return inside_->app.help(); }

std::vector<OptionFacts> CommandLine::options_of(int command) const {
  const CLI::App& app =
      command < 0
          ? inside_->app
          : *inside_->app.get_subcommand(inside_->commands[static_cast<std::size_t>(command)].name);
  std::vector<OptionFacts> all;
  for (const CLI::Option* option : app.get_options()) all.push_back(facts_of(*option));
  return all;
}

CommandLine::Parsed CommandLine::parse(const std::vector<std::string>& words) {
  CLI::App& app = inside_->app;
  Parsed parsed;
  std::string name;
  ask::Parameters rows;
  for (std::size_t i = 0; i < inside_->commands.size(); ++i) {
    if (words.empty() || words[0] != inside_->commands[i].name) continue;
    parsed.command = static_cast<int>(i);
    name = words[0];
    rows = inside_->declared[i].parameters;
  }
  const UsageOf usage{name, options_of(parsed.command), words};
  if (const std::string word = one_hyphen_too_few(usage); !word.empty()) {
    parsed.fault = word + " has one hyphen; the option is -" + word;
    return parsed;
  }
  try {
    app.parse(
        std::vector<std::string>(words.rbegin(), words.rend()));  // CLI11 wants the last first
    inside_->reading->check(rows);
  } catch (const CLI::Success& success) {  // --help, --version
    parsed.status = app.exit(success);
  } catch (const CLI::ParseError& error) {
    const CLI::App& of = parsed.command < 0 ? app : *app.get_subcommand(name);
    parsed.fault =
        usage_fault({name, options_of(parsed.command), words}, error.what(), of.remaining());
    if (dynamic_cast<const CLI::RequiredError*>(&error) == nullptr) return parsed;
    try {
      inside_->reading->check(rows);
    } catch (const Error& missing) {
      parsed.fault = usage_fault(usage, missing.what(), {});
    }
  } catch (const Error& error) {
    parsed.fault = usage_fault(usage, error.what(), {});
  }
  return parsed;
}

int CommandLine::run(int command) const {
  return inside_->declared[static_cast<std::size_t>(command)].run();
}

}  // namespace ptin::tools
