// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/ptin/usage_fault.h"

#include <algorithm>
#include <array>
#include <string_view>
#include <utility>
#include <vector>

#include "tools/facts/nearest_name.h"

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

std::string option_name(const ask::Parameter& row) {
  return ask::name_at(row, ask::Door::kProgram);
}

bool has_option(const ask::Parameters& rows, const std::string& name) {
  return std::any_of(rows.begin(), rows.end(), [&](const ask::Parameter& row) {
    const std::vector<std::string> names = names_of(row);
    return std::find(names.begin(), names.end(), name) != names.end();
  });
}

/// The first word that can only be meant as an option and is none; else empty. A number below 0 and
/// a single hyphen are values.
std::string unknown_option(const ParsedWords& usage) {
  for (const std::string& word : usage.words) {
    if (word == "--") break;
    const bool is_number = word.size() > 1 && word[1] >= '0' && word[1] <= '9';
    if (word.size() < 2 || word[0] != '-' || is_number) continue;
    const bool is_long = word[1] == '-';
    const std::string name = is_long ? word.substr(0, word.find('=')) : word.substr(0, 2);
    if (!has_option(usage.declared.parameters, name)) return is_long ? name : word;
  }
  return {};
}

std::string nearest_option(const ParsedWords& usage, const std::string& word) {
  std::vector<std::string> names;
  for (const ask::Parameter& row : usage.declared.parameters) {
    for (const std::string& name : names_of(row)) {
      if (name.starts_with("--")) names.push_back(name);
    }
  }
  return word.starts_with("--") ? nearest_name(word, names) : std::string();
}

std::string joined(const std::vector<std::string>& words) {
  std::string all;
  for (const std::string& word : words) all += (all.empty() ? "" : " ") + word;
  return all;
}

/// Names of the values of an option: "X Y" of the argument X_Y and of --point.
std::string names_of_values(const ask::Parameter& row) {
  const std::string values = values_of(row);
  const bool has_names = !is_argument(row) || values.find(' ') != std::string::npos;
  std::string names = has_names ? values : option_name(row);
  std::replace(names.begin(), names.end(), '_', ' ');
  return names;
}

/// "X Y are 2 numbers with a space between".
std::string values_wanted(const ask::Parameter& row) {
  const std::uint32_t count = row.least_values;
  const std::string names = names_of_values(row);
  std::string text = is_argument(row) ? names : option_name(row);
  if (count == 1 && (row.repeats || row.most_values > 1)) return text + " takes one value or more";
  if (count <= 1) return text + " takes one value" + (names == text ? "" : ", " + names);
  const std::string how_many = std::to_string(count) + (count == 2 ? " values with a space between"
                                                                   : " values with spaces between");
  return is_argument(row) ? text + " are " + how_many : text + " takes " + how_many + ", " + names;
}

/// "1,2" where two values are wanted is one word: tells how to write it.
std::string without_commas(const std::string& word, std::uint32_t count) {
  const auto commas = std::count(word.begin(), word.end(), ',');
  if (commas + 1 != count) return {};
  std::string apart = word;
  std::replace(apart.begin(), apart.end(), ',', ' ');
  return "; write " + apart;
}

std::string wrong_count(const ask::Parameter& row, const std::vector<std::string>& given) {
  std::string text = values_wanted(row);
  if (given.empty()) return text + ", and fewer were given";
  text += ", and " + std::to_string(given.size()) + (given.size() == 1 ? " was" : " were") +
          " given: " + joined(given);
  return given.size() == 1 ? text + without_commas(given[0], row.least_values) : text;
}

/// The row whose name a message of CLI11's begins with.
const ask::Parameter* row_in(const ParsedWords& usage, const std::string& message) {
  for (const ask::Parameter& row : usage.declared.parameters) {
    if (message.starts_with(option_name(row) + ": ")) return &row;
  }
  return nullptr;
}

/// "FILE X_Y" of `ptin locate FILE X Y`.
std::string arguments_of(const ParsedWords& usage) {
  std::string all;
  for (const ask::Parameter& row : usage.declared.parameters) {
    if (is_argument(row)) all += " " + names_of_values(row);
  }
  return all;
}

std::string too_many_words(const ParsedWords& usage, const std::string& message,
                           const std::vector<std::string>& extra) {
  const std::string words = extra.empty() ? message.substr(message.find(": ") + 2) : joined(extra);
  return words + (extra.size() == 1 ? " is a word" : " are words") + " too many: ptin" +
         (usage.command == nullptr ? "" : std::string(" ") + usage.command->name) + " takes" +
         arguments_of(usage) + " and options; what has blanks in it wants quotes";
}

/// A message of CLI11's in our words; those that are sentences stay as they are.
std::string in_our_words(const ParsedWords& usage, const std::string& message,
                         const std::vector<std::string>& given,
                         const std::vector<std::string>& extra) {
  if (message.find(" not expected: ") != std::string::npos) {
    return too_many_words(usage, message, extra);
  }
  const ask::Parameter* const row = row_in(usage, message);
  const bool is_count = message.find(" required ") != std::string::npos;
  if (row != nullptr && is_count) return wrong_count(*row, given);
  return message;
}

}  // namespace

std::string one_hyphen_too_few(const ask::Parameters& rows, std::span<const std::string> words) {
  for (const std::string& word : words) {
    const std::string name = word.substr(0, word.find('='));
    if (name.size() > 2 && name[0] == '-' && name[1] != '-' && has_option(rows, "-" + name))
      return name;
  }
  return {};
}

std::string unknown_subcommand_sentence(const std::string& word) {
  std::vector<std::string> names;
  for (const Command& command : commands()) names.emplace_back(command.name);
  names.emplace_back("help");
  const auto* const other = std::find_if(kOtherNames.begin(), kOtherNames.end(),
                                         [&](const auto& pair) { return pair.first == word; });
  return "there is no subcommand " + word +
         did_you_mean(other != kOtherNames.end() ? std::string(other->second)
                                                 : nearest_name(word, names));
}

std::string usage_fault(const ParsedWords& usage, std::string message,
                        const std::vector<std::string>& given,
                        const std::vector<std::string>& extra) {
  // CLI11 takes an option that it does not know, and what follows it, for further values of other
  // options: so those are looked for first.
  if (const std::string word = unknown_option(usage); !word.empty())
    return "there is no option " + word + did_you_mean(nearest_option(usage, word));
  message = in_our_words(usage, message, given, extra);
  std::replace(message.begin(), message.end(), '\n', ' ');
  return message;
}

}  // namespace ptin::tools
