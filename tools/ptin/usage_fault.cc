// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/ptin/usage_fault.h"

#include <algorithm>
#include <array>
#include <string_view>
#include <utility>
#include <vector>

#include "tools/facts/numbers.h"
#include "tools/ptin/nearest_name.h"

namespace ptin::tools {

namespace {

/// Names by which other programs call our subcommands.
constexpr auto kOtherNames = std::to_array<std::pair<std::string_view, std::string_view>>({
    {"contour", "isoline"},
    {"contours", "isoline"},
    {"elevation", "locate"},
    {"height", "locate"},
    {"los", "sight"},
    {"peak", "highest"},
    {"simplify", "refine"},
    {"translate", "export"},
    {"convert", "export"},
});

std::string did_you_mean(const std::string& name) {
  return name.empty() ? "" : "; did you mean " + name + "?";
}

bool has_option(const CLI::App& app, const std::string& name) {
  return app.get_option_no_throw(name) != nullptr;
}

/// The first word that can only be meant as an option and is none; else empty. A number below 0 and
/// a single hyphen are values.
std::string unknown_option(const CLI::App& app, std::span<const std::string> words) {
  for (const std::string& word : words) {
    if (word == "--") break;
    const bool is_number = word.size() > 1 && word[1] >= '0' && word[1] <= '9';
    if (word.size() < 2 || word[0] != '-' || is_number) continue;
    const bool is_long = word[1] == '-';
    const std::string name = is_long ? word.substr(0, word.find('=')) : word.substr(0, 2);
    if (!has_option(app, name)) return is_long ? name : word;
  }
  return {};
}

std::string nearest_option(const CLI::App& app, const std::string& word) {
  std::vector<std::string> names;
  for (const CLI::Option* option : app.get_options()) {
    for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
  }
  return word.starts_with("--") ? nearest_name(word, names) : std::string();
}

std::string joined(const std::vector<std::string>& words) {
  std::string all;
  for (const std::string& word : words) all += (all.empty() ? "" : " ") + word;
  return all;
}

/// Names of the values of an option: "X Y" of the argument X_Y and of --point.
std::string names_of_values(const CLI::Option& option) {
  const std::string type = option.get_type_name();
  const bool has_names = !option.get_positional() || type.find(' ') != std::string::npos;
  std::string names = has_names ? type : option.get_name();
  std::replace(names.begin(), names.end(), '_', ' ');
  return names;
}

/// "X Y are 2 numbers with a space between".
std::string values_wanted(const CLI::Option& option) {
  const int count = option.get_items_expected_min();
  const std::string names = names_of_values(option);
  std::string text = option.get_positional() ? names : option.get_name();
  if (count == 1 && option.get_items_expected_max() > 1) return text + " takes one value or more";
  if (count <= 1) return text + " takes one value" + (names == text ? "" : ", " + names);
  const std::string how_many = std::to_string(count) + (count == 2 ? " values with a space between"
                                                                   : " values with spaces between");
  return option.get_positional() ? text + " are " + how_many
                                 : text + " takes " + how_many + ", " + names;
}

/// "1,2" where two values are wanted is one word: tells how to write it.
std::string without_commas(const std::string& word, int count) {
  const auto commas = std::count(word.begin(), word.end(), ',');
  if (commas + 1 != count) return {};
  std::string apart = word;
  std::replace(apart.begin(), apart.end(), ',', ' ');
  return "; write " + apart;
}

std::string wrong_count(const CLI::Option& option) {
  const std::vector<std::string>& given = option.results();
  std::string text = values_wanted(option);
  if (given.empty()) return text + ", and fewer were given";
  text += ", and " + std::to_string(given.size()) + (given.size() == 1 ? " was" : " were") +
          " given: " + joined(given);
  return given.size() == 1 ? text + without_commas(given[0], option.get_items_expected_min())
                           : text;
}

/// The option whose name a message of CLI11's begins with, or has before " = ".
const CLI::Option* option_in(const CLI::App& app, const std::string& message,
                             const std::string& behind) {
  for (const CLI::Option* option : app.get_options()) {
    if (message.starts_with(option->get_name() + behind)) return option;
  }
  return nullptr;
}

/// "FILE X_Y" of `ptin locate FILE X Y`.
std::string arguments_of(const CLI::App& app) {
  std::string all;
  for (const CLI::Option* option : app.get_options()) {
    if (option->get_positional()) all += " " + names_of_values(*option);
  }
  return all;
}

std::string too_many_words(const CLI::App& app, const std::string& message) {
  const std::vector<std::string> extra = app.remaining();
  const std::string words = extra.empty() ? message.substr(message.find(": ") + 2) : joined(extra);
  const std::string name = app.get_parent() == nullptr ? "ptin" : "ptin " + app.get_name();
  return words + (extra.size() == 1 ? " is a word" : " are words") + " too many: " + name +
         " takes" + arguments_of(app) + " and options; what has blanks in it wants quotes";
}

std::string no_number(const std::string& rest) {
  const std::size_t sign = rest.find(" = ");
  const std::string name = rest.substr(0, sign), value = rest.substr(sign + 3);
  return name + ": " + value +
         (given_number(value) ? " is no whole number that it can take" : " is no number");
}

/// "--by: x not in {stars,splits}".
std::string none_of(const std::string& message) {
  const std::size_t begin = message.find(" not in {");
  std::string allowed = message.substr(begin + 9);
  allowed.erase(allowed.find_last_of('}'));
  std::vector<std::string> names;
  for (std::size_t at = 0; at <= allowed.size();) {
    const std::size_t end = std::min(allowed.find(',', at), allowed.size());
    names.push_back(allowed.substr(at, end - at));
    at = end + 1;
  }
  const std::string before = message.substr(0, begin);
  std::string list;
  for (const std::string& name : names) list += (list.empty() ? "" : ", ") + name;
  const std::size_t colon = before.find(": ");
  const std::string word = colon == std::string::npos ? "" : before.substr(colon + 2);
  return before + " is none of " + list + did_you_mean(nearest_name(word, names));
}

/// A message of CLI11's in our words; those that are sentences stay as they are.
std::string in_our_words(const CLI::App& app, const std::string& message) {
  constexpr std::string_view kNoConversion = "Could not convert: ";
  if (message.starts_with(kNoConversion)) return no_number(message.substr(kNoConversion.size()));
  if (message.find(" not expected: ") != std::string::npos) return too_many_words(app, message);
  if (message.find(" not in {") != std::string::npos) return none_of(message);
  const CLI::Option* const option = option_in(app, message, ": ");
  const bool is_count = message.find(" required ") != std::string::npos;
  if (option != nullptr && is_count) return wrong_count(*option);
  return message;
}

}  // namespace

std::string one_hyphen_too_few(const CLI::App& app, std::span<const std::string> words) {
  for (const std::string& word : words) {
    const std::string name = word.substr(0, word.find('='));
    if (name.size() > 2 && name[0] == '-' && name[1] != '-' && has_option(app, "-" + name))
      return name;
  }
  return {};
}

std::string unknown_subcommand_sentence(const CLI::App& program, const std::string& word) {
  std::vector<std::string> names;
  for (const CLI::App* app : program.get_subcommands({})) names.push_back(app->get_name());
  names.emplace_back("help");
  const auto* const other = std::find_if(kOtherNames.begin(), kOtherNames.end(),
                                         [&](const auto& pair) { return pair.first == word; });
  return "there is no subcommand " + word +
         did_you_mean(other != kOtherNames.end() ? std::string(other->second)
                                                 : nearest_name(word, names));
}

std::string usage_fault(const CLI::App& app, std::span<const std::string> words,
                        const CLI::ParseError& error) {
  // CLI11 takes an option that it does not know, and what follows it, for further values of other
  // options: so those are looked for first.
  if (const std::string word = unknown_option(app, words); !word.empty())
    return "there is no option " + word + did_you_mean(nearest_option(app, word));
  std::string message = in_our_words(app, error.what());
  std::replace(message.begin(), message.end(), '\n', ' ');
  return message;
}

}  // namespace ptin::tools
