// SPDX-License-Identifier: GPL-3.0-or-later
//
// Parts of a file of points that are read by themselves, and what each of them says of the whole.
#pragma once

#include <array>
#include <cstdint>
#include <limits>

namespace ptin {

/// A part of a file that is read by itself: of text the rows that begin in these bytes, of LAS these
/// records, of LAZ the chunks that begin with one of them. The parts of a file that do not overlap have no point in common.
struct PointPart {
  std::uint64_t begin = 0, end = std::numeric_limits<std::uint64_t>::max();
  [[nodiscard]] bool is_whole() const noexcept { return *this == PointPart{}; }
  friend bool operator==(const PointPart&, const PointPart&) = default;
};

/// Whether the first column of a text numbers its rows, as far as they were read (read/text_rows.h).
struct RowNumbering {
  bool may_be = false;           ///< All of it are whole numbers, and nobody named the columns.
  bool is_guess = false;         ///< There are more columns than coordinates.
  bool by_one = true;            ///< It rose by one from each row to the next.
  bool has_repeats = false;      ///< Some number came twice among the first rows of the first part.
  bool has_decimals = false;     ///< The second column has.
  std::array<bool, 3> unused{};  ///< In the place of padding: numberings are written as they are.
  std::int64_t first = 0, last = 0;
  std::uint64_t rows = 0;

  /// Adds the rows of the next part.
  void join(const RowNumbering& next) noexcept;
};

/// What a part of a text says of its rows, which only all parts together show.
struct RowsOfPart {
  RowNumbering numbering;
  std::uint64_t lines = 0;     ///< All that begin in the part.
  std::uint64_t last_row = 0;  ///< The line that its last row begins in, from 1; 0: it has no row.
};

}  // namespace ptin
