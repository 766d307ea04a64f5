// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/read/text_header.h"

#include <algorithm>
#include <array>
#include <utility>

#include "engine/construct/grid/decimal.h"
#include "engine/construct/read/column_names.h"

namespace ptin {
namespace {

/// True where blanks separate numbers in the row though it has tabs too.
bool has_numbers_between_tabs(std::string_view row) {
  for (std::size_t i = 0; i <= row.size();) {
    const std::size_t end = std::min(row.find('\t', i), row.size());
    if (has_two_numbers(row.substr(i, end - i))) {
      return true;
    }
    i = end + 1;
  }
  return false;
}

bool is_in_brackets(std::string_view text) {
  return text.size() > 2 && ((text.front() == '(' && text.back() == ')') ||
                             (text.front() == '[' && text.back() == ']'));
}

/// The words of a comment, at its own separator.
std::vector<std::string> names_in(std::string_view comment) {
  const char separator = separator_of(comment);
  const std::string_view ends = separator == ' ' ? kBlanks : std::string_view(&separator, 1);
  std::vector<std::string> names;
  for (std::size_t i = 0; i <= comment.size();) {
    const std::size_t end = std::min(comment.find_first_of(ends, i), comment.size());
    std::string_view name = trimmed(comment.substr(i, end - i));
    if (name.size() > 1 && name.front() == '"' && name.back() == '"') {
      name = trimmed(name.substr(1, name.size() - 2));
    }
    if (!name.empty() || separator != ' ') {
      names.emplace_back(name);
    }
    i = end + 1;
  }
  if (separator == ' ') {
    join_units(names);
  }
  return names;
}

/// True where x and y are named, with nothing but coordinates between them: a remark that has both
/// words somewhere names no columns.
bool names_a_place(std::span<const std::string> names, int end) {
  const std::size_t x = find_column(names, {Coordinate::kX, end});
  const std::size_t y = find_column(names, {Coordinate::kY, end});
  if (x == names.size() || y == names.size()) {
    return false;
  }
  const auto [first, last] = std::minmax(x, y);
  return std::all_of(names.begin() + static_cast<std::ptrdiff_t>(first),
                     names.begin() + static_cast<std::ptrdiff_t>(last),
                     [](const std::string& name) { return is_coordinate_name(name); });
}

std::optional<std::vector<std::string>> header_in(std::string_view comment, std::size_t count) {
  std::vector<std::string> names = names_in(comment);
  if (names.size() > count) {
    names.resize(count);
    if (!std::all_of(names.begin(), names.end(),
                     [](const std::string& name) { return is_coordinate_name(name); })) {
      return std::nullopt;
    }
  }
  if (!names_a_place(names, 0) && !names_a_place(names, 1)) {
    return std::nullopt;
  }
  names.resize(count);
  return names;
}

}  // namespace

std::string_view trimmed(std::string_view text, std::string_view blanks) {
  const std::size_t first = text.find_first_not_of(blanks);
  if (first == std::string_view::npos) {
    return text.substr(text.size());
  }
  return text.substr(first, text.find_last_not_of(blanks) - first + 1);
}

std::size_t end_of_quoted(std::string_view row, std::size_t at) {
  for (at = row.find('"', at + 1); at != std::string_view::npos; at = row.find('"', at + 2)) {
    if (at + 1 == row.size() || row[at + 1] != '"') {
      return at + 1;
    }
  }
  return at;
}

bool begins_as_number(std::string_view field) {
  Decimal ignored;
  const std::size_t digit = field.find_first_not_of("'+-.");
  return parse_number(field, ignored) != NumberKind::kNoNumber ||
         (digit != std::string_view::npos && field[digit] >= '0' && field[digit] <= '9');
}

bool has_two_numbers(std::string_view text) {
  int numbers = 0;
  for (std::size_t i = 0; i < text.size();) {
    const std::size_t end = std::min(text.find_first_of(kBlanks, i), text.size());
    numbers += begins_as_number(text.substr(i, end - i)) ? 1 : 0;
    i = end + 1;
  }
  return numbers > 1;
}

char separator_of(std::string_view row) {
  bool has_comma = false, has_tab = false;
  bool is_begin = true;  // of a field, or of a word of one
  for (std::size_t i = 0; i < row.size(); ++i) {
    if (row[i] == '"' && is_begin) {
      i = end_of_quoted(row, i);
      if (i == std::string_view::npos) {
        break;
      }
      --i;
      is_begin = false;
      continue;
    }
    if (row[i] == ';') {
      return ';';
    }
    has_comma = has_comma || row[i] == ',';
    has_tab = has_tab || row[i] == '\t';
    is_begin = row[i] == ',' || is_blank_character(row[i]);
  }
  return has_comma ? ',' : has_tab && !has_numbers_between_tabs(row) ? '\t' : ' ';
}

std::size_t comment_mark(std::string_view line) {
  const std::size_t count = std::min(line.find_first_not_of("#%!>"), line.size());
  if (count > 0 || !line.starts_with("//")) {
    return count;
  }
  return std::min(line.find_first_not_of('/'), line.size());
}

bool tells_separator(std::string_view line) {
  constexpr std::string_view kKey = "sep=";
  return line.size() <= kKey.size() + 1 && equal_in_any_case(line.substr(0, kKey.size()), kKey);
}

void join_units(std::vector<std::string>& names) {
  std::vector<std::string> joined;
  for (std::string& name : names) {
    if (!joined.empty() && is_in_brackets(name) && !is_in_brackets(joined.back())) {
      joined.back().append(" ").append(name);
    } else {
      joined.push_back(std::move(name));
    }
  }
  names = std::move(joined);
}

bool is_header(std::span<const std::string> names) {
  return std::none_of(names.begin(), names.end(), begins_as_number) ||
         (find_column(names, {Coordinate::kX}) != names.size() &&
          find_column(names, {Coordinate::kY}) != names.size());
}

std::optional<std::vector<std::string>> header_in_comments(std::span<const std::string> comments,
                                                           std::size_t count) {
  for (std::size_t i = comments.size(); i-- > 0;) {
    const std::string_view line = comments[i];
    const std::string_view text = trimmed(line.substr(comment_mark(line)));
    if (auto names = header_in(text, count)) {
      return names;
    }
    // "Columns: x y z"
    const std::size_t colon = text.find(':');
    if (colon == std::string_view::npos) {
      continue;
    }
    if (auto names = header_in(trimmed(text.substr(colon + 1)), count)) {
      return names;
    }
  }
  return std::nullopt;
}

}  // namespace ptin
