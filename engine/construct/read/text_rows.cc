// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/read/text_rows.h"

#include <algorithm>
#include <numeric>
#include <utility>

#include "engine/error.h"
#include "engine/number.h"

namespace ptin {
namespace {

/// So many rows show that a column counts; one or two may do so by chance.
constexpr std::uint64_t kFewestCounted = 3;
/// In so many rows no number of a column that numbers them comes twice.
constexpr std::uint64_t kRowsCompared = 1 << 16;
/// Fewer columns are no coordinates with a number before them.
constexpr std::size_t kFewestNumbered = 3;

/// "x, y and z".
std::string listed(std::span<const ColumnRole> roles) {
  std::string text;
  for (std::size_t i = 0; i < roles.size(); ++i) {
    text.append(i == 0 ? "" : i + 1 == roles.size() ? " and " : ", ").append(name_of(roles[i]));
  }
  return text;
}

/// What could be said instead: "--columns id x y z"; without `before` "--columns x y z".
std::string example_of(std::span<const ColumnRole> roles, const std::string& before = " id") {
  std::string text = "--columns" + before;
  for (const ColumnRole role : roles) {
    text.append(" ").append(name_of(role));
  }
  return text;
}

/// A whole number that is not negative, also as "7.0"; -1 where the field is none.
std::int64_t whole_number(std::string_view field) {
  const std::size_t point = std::min(field.find('.'), field.size());
  if (field.find_first_not_of('0', std::min(point + 1, field.size())) != std::string_view::npos) {
    return -1;
  }
  return parse_number<std::int64_t>(field.substr(0, point)).value_or(-1);
}

}  // namespace

void RowNumbering::join(const RowNumbering& next) noexcept {
  if (next.rows == 0) {
    return;
  }
  if (rows == 0) {
    *this = next;
    return;
  }
  may_be = may_be && next.may_be;
  by_one = by_one && next.by_one && next.first - 1 == last;
  has_repeats = has_repeats || next.has_repeats;
  has_decimals = has_decimals || next.has_decimals;
  last = next.last;
  rows += next.rows;
}

std::optional<std::string> fault_of(const RowNumbering& numbering,
                                    std::span<const ColumnRole> roles) {
  const bool is_numbering = numbering.is_guess ? numbering.by_one || numbering.has_decimals
                                               : numbering.by_one && numbering.has_decimals;
  if (!numbering.may_be || numbering.rows < kFewestCounted || !is_numbering ||
      numbering.has_repeats) {
    return std::nullopt;
  }
  const std::string manner =
      numbering.by_one ? "one by one to " : "none of them twice, the last as ";
  return "the first column numbers the lines, " + manner + std::to_string(numbering.last) +
         ", and would be taken for " + name_of(roles[0]) +
         ", since there is no header; name the columns with --columns, as in " +
         (numbering.is_guess ? example_of(roles) : example_of(roles, "") + " if they are these");
}

TextRows::TextRows(TextTable& table, std::span<const ColumnRole> roles,
                   std::vector<std::string> columns)
    : table_(table), roles_(roles.begin(), roles.end()), given_(std::move(columns)) {
  if (!given_.empty()) {
    columns_ = columns_of(given_, roles_);
  }
}

/// Finds the columns, once the first row is known.
void TextRows::begin() {
  begun_ = true;
  const std::vector<std::string>& header = table_.header();
  if (table_.line() == 0 || table_.field_count() == 0) {
    return;  // an empty text
  }
  const std::size_t count = table_.field_count();
  if (!given_.empty()) {
    if (given_.size() > count) {
      table_.refuse("--columns names " + std::to_string(given_.size()) +
                    " columns, and the first line has " + std::to_string(count) + hint_of_bars());
    }
    let_last_go_on(given_.size());
    return;
  }
  for (std::size_t i = 0; i < roles_.size(); ++i) {
    columns_.push_back(header.empty() ? i : find_column(header, roles_[i]));
    if (columns_[i] == count && !header.empty()) {
      table_.refuse(
          (table_.is_told_by_comment()
               ? "the last comment before the first line names columns, but none for "
               : "the first line is taken for a header, since no field of it is a number, but "
                 "names "
                 "no column for ") +
          name_of(roles_[i]) +
          "; columns are named x, y, z or easting, northing, height or lon, lat, elevation" +
          (roles_[i].end == 0 ? "" : ", with 1 and 2 behind them for the two ends") +
          ", or by --columns" + hint_of_bars());
    }
  }
  if (count < roles_.size()) {
    table_.refuse("there are " + std::to_string(count) + " fields in the first line, where " +
                  listed(roles_) + " are expected" + hint_of_bars());
  }
  if (!header.empty()) {
    refuse_twins(header);
    let_last_go_on(count);
  }
  numbering_.is_guess = header.empty() && count > roles_.size();
  numbering_.may_be = numbering_.is_guess || (header.empty() && count >= kFewestNumbered);
}

/// The advice where bars divide the first line, which separate nothing; "" where they do not.
std::string TextRows::hint_of_bars() const {
  std::ptrdiff_t bars = 0;
  for (const std::string& name : table_.header()) {
    bars += std::count(name.begin(), name.end(), '|');
  }
  for (const std::string_view field : table_.fields()) {
    bars += std::count(field.begin(), field.end(), '|');
  }
  return bars < 2 ? ""
                  : "; '|' is no separator: write semicolons, commas, tabs or blanks in its place";
}

/// Refuses a header in which another column has the name of one that is used.
void TextRows::refuse_twins(const std::vector<std::string>& header) const {
  for (const std::size_t column : columns_) {
    // A name without a unit comes before the same with one.
    const bool has_unit = !named_column(header[column]).unit.empty();
    const auto plain = [&](std::string_view name) {
      return has_unit ? named_column(name).name : name;
    };
    const auto is_same = [&](const std::string& name) {
      return equal_in_any_case(plain(name), plain(header[column]));
    };
    if (std::count_if(header.begin(), header.end(), is_same) > 1) {
      table_.refuse("the header names two columns " + shown_field(header[column]) +
                    "; name the one that is meant with --columns, and the other by any other name");
    }
  }
}

/// Lets the last column hold separators where it has a name and is no coordinate.
/// @param named  So many columns have names.
void TextRows::let_last_go_on(std::size_t named) {
  const std::size_t last = table_.field_count() - 1;
  if (named > last && std::find(columns_.begin(), columns_.end(), last) == columns_.end()) {
    table_.let_last_go_on();
  }
}

DeclaredUnits TextRows::units() {
  if (!begun_) {
    begin();
  }
  const std::vector<std::string>& all = names();
  const auto unit_of = [&](std::size_t role) {
    return role < columns_.size() && columns_[role] < all.size()
               ? unit_of_column(all[columns_[role]])
               : std::string();
  };
  const std::string x = unit_of(0), y = unit_of(1), z = unit_of(2);
  if (x != y && !x.empty() && !y.empty()) {
    table_.refuse("the names of the columns say that x is in units of '" + x + "' and y in '" + y +
                  "'; bring them to one unit first");
  }
  return {x.empty() ? y : x, z};
}

std::string TextRows::unknown_unit() {
  if (!begun_) {
    begin();
  }
  const std::vector<std::string>& all = names();
  for (const std::size_t column : columns_) {
    if (column < all.size()) {
      const std::string_view unit = named_column(all[column]).unit;
      if (!unit.empty() && unit_of_column(all[column]).empty()) {
        return std::string(unit.substr(0, 40));
      }
    }
  }
  return {};
}

bool TextRows::choose_id(const std::string& name) {
  const std::vector<std::string>& all = names();
  const auto found = std::find_if(all.begin(), all.end(), [&](const std::string& n) {
    return name.empty() ? !n.empty() && !is_coordinate_name(n) : equal_in_any_case(n, name);
  });
  id_ = static_cast<std::size_t>(found - all.begin());
  if (found != all.end() || name.empty()) {
    return found != all.end();
  }
  std::string known;
  for (const std::string& n : all) {
    known.append(known.empty() ? "" : ", ").append(shown_field(n));
  }
  table_.refuse("there is no column " + shown_field(name) + "; " +
                (all.empty()
                     ? "no header names any: name them with --columns, as in " + example_of(roles_)
                     : "there are " + known));
}

/// A column that numbers the rows is whole in each of them.
void TextRows::note_numbering() {
  RowNumbering& n = numbering_;
  const std::int64_t number = whole_number(fields_[0]);
  n.may_be = number >= 0;
  if (n.rows < kRowsCompared && table_.begins_text()) {
    numbers_.push_back(number);
  }
  n.by_one = n.by_one && (n.rows == 0 || number - 1 == n.last);
  n.has_decimals = n.has_decimals || fields_[1].find('.') != std::string_view::npos;
  n.first = n.rows == 0 ? number : n.first;
  n.last = number;
}

RowNumbering TextRows::numbering() const {
  RowNumbering result = numbering_;
  std::vector<std::int64_t> sorted = numbers_;
  std::sort(sorted.begin(), sorted.end());
  result.has_repeats = std::adjacent_find(sorted.begin(), sorted.end()) != sorted.end();
  return result;
}

bool TextRows::next() {
  if (!begun_) {
    begin();
  }
  if (!table_.next()) {
    if (numbering_.may_be && table_.is_whole()) {
      if (const auto fault = fault_of(numbering(), roles_)) {
        table_.refuse(*fault);
      }
    }
    return false;
  }
  fields_ = table_.fields();
  if (table_.is_misfit()) {
    return true;
  }
  if (numbering_.may_be) {
    note_numbering();
  }
  ++numbering_.rows;
  return true;
}

std::string TextRows::fault_of_field(std::size_t role, const std::string& what) const {
  return "the " + name_of(roles_[role]) +
         (roles_[role].end == 0 ? " of this point, " : " of this pair, ") +
         shown_field(field(role)) + ", " + what;
}

std::string TextRows::fault_of_no_number(std::size_t role) const {
  return fault_of_field(
      role,
      why_no_number(field(role)) +
          (numbering_.is_guess ? "; if the columns are others, name them with --columns, as in " +
                                     example_of(roles_)
                               : ""));
}

void TextRows::refuse_field(std::size_t role, const std::string& what) const {
  table_.refuse(fault_of_field(role, what));
}

void TextRows::refuse_no_number(std::size_t role) const { table_.refuse(fault_of_no_number(role)); }

}  // namespace ptin
