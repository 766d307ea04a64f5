// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/read/xyz_reader.h"

#include <utility>

namespace ptin {

XyzReader::XyzReader(std::string path, std::vector<std::string> columns, const PointPart& part,
                     TakeInvalidRow invalid_row)
    : table_(std::move(path), part),
      rows_(table_, point_roles(), std::move(columns)),
      invalid_row_(std::move(invalid_row)) {
  table_.let_rows_misfit();
}

XyzReader::XyzReader(std::string name, std::string text, std::vector<std::string> columns)
    : table_(std::move(name), std::move(text)), rows_(table_, point_roles(), std::move(columns)) {
  table_.let_rows_misfit();
}

bool XyzReader::is_number(std::size_t role, Decimal& value) const {
  return parse_number(rows_.field(role), value) == NumberKind::kNumber;
}

/// The fault of the row that was read last. REQUIRES: it has one.
std::string XyzReader::fault() const {
  if (table_.is_misfit()) {
    return table_.misfit();
  }
  Decimal ignored;
  std::size_t role = 0;
  while (is_number(role, ignored)) {
    ++role;
  }
  switch (parse_number(rows_.field(role), ignored)) {
    case NumberKind::kNotANumber:
      return rows_.fault_of_field(role, "is NaN; leave points without a height out");
    case NumberKind::kInfinite:
      return rows_.fault_of_field(role, "is infinite");
    case NumberKind::kTooLarge:
      return rows_.fault_of_field(role, "is 10^18 or more");
    case NumberKind::kNumber:
    case NumberKind::kNoNumber:
      break;
  }
  return rows_.fault_of_no_number(role);
}

bool XyzReader::next(SourcePoint& point) {
  while (rows_.next()) {
    if (!table_.is_misfit() && is_number(0, point.x) && is_number(1, point.y) &&
        is_number(2, point.z)) {
      return true;
    }
    if (!invalid_row_) {
      table_.refuse(fault() + "; --skip-invalid passes over such rows");
    }
    invalid_row_(table_.line(), fault());
  }
  return false;
}

}  // namespace ptin
