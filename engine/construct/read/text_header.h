// SPDX-License-Identifier: GPL-3.0-or-later
//
// Decisions from the first lines of a text: what separates fields, and which line names columns.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace ptin {

/// Characters around a field that are no part of it: blanks, ends of lines and of pages, and the
/// mark that ends texts of DOS.
inline constexpr std::string_view kBlanks = " \t\r\n\f\v\x1a";

[[nodiscard]] constexpr bool is_blank_character(char c) noexcept {
  return kBlanks.find(c) != std::string_view::npos;
}

/// The text without the blanks around it.
[[nodiscard]] std::string_view trimmed(std::string_view text, std::string_view blanks = kBlanks);

/// Where the quoted field that begins at `at` ends: behind its last quote; npos when it does not.
[[nodiscard]] std::size_t end_of_quoted(std::string_view row, std::size_t at);

/// True for a number, and for a field that was meant as one: with a unit or a decimal comma.
[[nodiscard]] bool begins_as_number(std::string_view field);

/// True when two words of a text, set apart by blanks, begin as numbers do.
[[nodiscard]] bool has_two_numbers(std::string_view text);

/// The separator of a row, ' ' for blanks: what stands outside of its quoted fields decides.
[[nodiscard]] char separator_of(std::string_view row);

/// The length of the mark by which a line says that it is a comment: of '#', '%', '!', '>' and "//",
/// once or more; 0 where it has none.
/// @param line  Without blanks before it.
[[nodiscard]] std::size_t comment_mark(std::string_view line);

/// True for the line that gives Excel the separator: "sep=;". The lines below show it, too.
[[nodiscard]] bool tells_separator(std::string_view line);

/// Joins a unit in brackets to the name before it, where a blank between them made it a field of its
/// own: "z", "(m)".
void join_units(std::vector<std::string>& names);

/// True where a row of these fields is a header: none of them begins as a number does, or they name
/// a column for x and one for y.
[[nodiscard]] bool is_header(std::span<const std::string> names);

/// The names of the columns, where a comment before the first row gives them: the last one that
/// names columns for x and y, from the left, and no more columns than there are. Words behind the
/// names of x, y and z of all columns are taken for a remark.
/// @param comments  The lines before the first row, with their marks.
/// @param count     Number of the columns.
/// @return  So many names, those that are not given empty; none where no comment gives any.
[[nodiscard]] std::optional<std::vector<std::string>> header_in_comments(
    std::span<const std::string> comments, std::size_t count);

}  // namespace ptin
