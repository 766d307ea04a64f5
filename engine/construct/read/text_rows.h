// SPDX-License-Identifier: GPL-3.0-or-later
//
// Which columns of a text hold the coordinates, and which one tells rows apart.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "engine/construct/grid/source_point.h"
#include "engine/construct/read/column_names.h"
#include "engine/construct/read/point_part.h"
#include "engine/construct/read/text_table.h"

namespace ptin {

/// What is wrong with a text whose first column numbers its rows and would be taken for a coordinate;
/// none where it does not. It does where it is whole, and counts 1, 2, 3 ... or holds no number twice
/// beside coordinates with decimals; where there are no more columns than coordinates, it has to do
/// both.
[[nodiscard]] std::optional<std::string> fault_of(const RowNumbering& numbering,
                                                  std::span<const ColumnRole> roles);

/// The rows of a text as points, or as pairs of points. Their columns are those that the caller
/// named; else those that a header names; else the first ones, in the order of the roles. Not
/// thread-safe.
class TextRows {
 public:
  /// @param table    Which outlives the rows; nothing of it was read yet but the header.
  /// @param columns  The names of the columns from the left, as columns_of() takes them; empty:
  ///                 none were given.
  /// @throws Error as columns_of()
  TextRows(TextTable& table, std::span<const ColumnRole> roles,
           std::vector<std::string> columns = {});

  /// Chooses the column that tells rows apart: the one of this name, in any case; without a name
  /// the first whose name is none of a coordinate's.
  /// @return  False where there is no name and no such column.
  /// @throws Error  invalid_argument  no column has this name; also as next()
  [[nodiscard]] bool choose_id(const std::string& name);

  /// The units that the names of the columns give for x and y, and of z, as in "x[m]" and "z_ft";
  /// also "degree". Reads the first row.
  /// @throws Error as next(); invalid_argument  those of x and y differ
  [[nodiscard]] DeclaredUnits units();
  /// The unit in brackets in the name of a coordinate's column, where nobody knows it; else "".
  /// @throws Error as next()
  [[nodiscard]] std::string unknown_unit();

  /// Reads the next row; false at the end. A row that misfits (TextTable::misfit()) counts for nothing,
  /// and has no fields.
  /// @throws Error as TextTable::next(); invalid_argument also where a header lacks a column, where
  ///         names it twice, there are too few, and, at the end of a whole text, where nobody said
  ///         which columns these are and the one taken for the first coordinate numbers the rows
  ///         (fault_of()).
  /// Cost: 8 bytes of memory for each of the first 65536 rows while a column may number them.
  [[nodiscard]] bool next();

  /// Whether the first column numbers the rows that were read so far.
  [[nodiscard]] RowNumbering numbering() const;

  /// The field of a role, by its place among the roles.
  [[nodiscard]] std::string_view field(std::size_t role) const { return fields_[columns_[role]]; }
  /// The field that tells the row apart. REQUIRES: choose_id() returned true.
  [[nodiscard]] std::string_view id() const { return fields_[id_]; }
  /// The fault of the field of a role: "the x of this point, 'nan', " and `what`.
  [[nodiscard]] std::string fault_of_field(std::size_t role, const std::string& what) const;
  /// That it is no number.
  [[nodiscard]] std::string fault_of_no_number(std::size_t role) const;
  /// Refuses the row for what is wrong with the field of a role.
  [[noreturn]] void refuse_field(std::size_t role, const std::string& what) const;
  /// Refuses the row since the field of a role is no number.
  [[noreturn]] void refuse_no_number(std::size_t role) const;

 private:
  void begin();
  void note_numbering();
  [[nodiscard]] std::string hint_of_bars() const;
  void refuse_twins(const std::vector<std::string>& header) const;
  void let_last_go_on(std::size_t named);
  /// The names of the columns: given, of the header, or none.
  [[nodiscard]] const std::vector<std::string>& names() const {
    return given_.empty() ? table_.header() : given_;
  }

  TextTable& table_;
  std::vector<ColumnRole> roles_;
  std::vector<std::string> given_;
  std::vector<std::size_t> columns_;  ///< By role.
  std::size_t id_ = 0;
  std::span<const std::string_view> fields_;
  bool begun_ = false;

  RowNumbering numbering_;             ///< But for its repeats.
  std::vector<std::int64_t> numbers_;  ///< In the first column of the first rows of the text.
};

}  // namespace ptin
