// SPDX-License-Identifier: GPL-3.0-or-later
//
// Points as text: one a line, three numbers or more, read as a stream.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "engine/construct/grid/source_point.h"
#include "engine/construct/read/point_stream.h"
#include "engine/construct/read/text_rows.h"
#include "engine/construct/read/text_table.h"

namespace ptin {

/// Reads points from CSV or XYZ text (read/text_table.h). The columns of x, y and z are those that
/// the caller or a header names, else the first three (read/text_rows.h); further columns are
/// passed over. Numbers have decimal points. Not thread-safe.
class XyzReader {
 public:
  /// @param columns  The names of the columns from the left (read/column_names.h); empty: those of
  ///                 a header.
  /// @throws Error as TextTable; invalid_argument  `columns` lacks a coordinate
  /// @param part     As of TextTable.
  /// @param invalid_row  Rows that are no points are passed over and reported here; empty: they are
  ///                     errors.
  explicit XyzReader(std::string path, std::vector<std::string> columns = {},
                     const PointPart& part = {}, TakeInvalidRow invalid_row = {});
  /// Reads `text`, which it keeps, instead of a file; `name` stands for the path in errors.
  XyzReader(std::string name, std::string text, std::vector<std::string> columns = {});

  /// The next point; false at the end.
  /// @throws Error as TextRows::next(); invalid_argument  no number, NaN or an infinite one where a
  ///                                    number belongs. The context is "path:line".
  /// Cost: about 0.1 us a line; 1 MiB of memory whatever the file's size.
  [[nodiscard]] bool next(SourcePoint& point);

  /// The units as TextRows gives them.
  [[nodiscard]] DeclaredUnits units() { return rows_.units(); }
  [[nodiscard]] std::string unknown_unit() { return rows_.unknown_unit(); }

  /// Declarations of the comments before the first row, which this reads.
  /// @throws Error as next()
  [[nodiscard]] const DeclaredComments& declared() {
    static_cast<void>(table_.header());
    return table_.declared();
  }

  /// The line of the point that was read last.
  [[nodiscard]] std::uint64_t line() const noexcept { return table_.line(); }
  /// What the rows say that were read.
  [[nodiscard]] RowsOfPart rows() const {
    const RowNumbering numbering = rows_.numbering();
    return {numbering, table_.lines(), numbering.rows == 0 ? 0 : table_.line()};
  }
  /// As of TextTable.
  [[nodiscard]] std::uint64_t bytes_read() const noexcept { return table_.bytes_read(); }

 private:
  [[nodiscard]] bool is_number(std::size_t role, Decimal& value) const;
  [[nodiscard]] std::string fault() const;

  TextTable table_;
  TextRows rows_;
  TakeInvalidRow invalid_row_;
};

}  // namespace ptin
