// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/read/xyz_reader.h"

#include <utility>

namespace ptin {

XyzReader::XyzReader(std::string path, std::vector<std::string> columns, const PointPart& part)
    : table_(std::move(path), part), rows_(table_, point_roles(), std::move(columns)) {}

XyzReader::XyzReader(std::string name, std::string text, std::vector<std::string> columns)
    : table_(std::move(name), std::move(text)), rows_(table_, point_roles(), std::move(columns)) {}

Decimal XyzReader::number(std::size_t role) const {
  Decimal value;
  switch (parse_number(rows_.field(role), value)) {
    case NumberKind::kNumber:
      return value;
    case NumberKind::kNotANumber:
      rows_.refuse_field(role, "is NaN; leave points without a height out");
    case NumberKind::kInfinite:
      rows_.refuse_field(role, "is infinite");
    case NumberKind::kTooLarge:
      rows_.refuse_field(role, "is 10^18 or more");
    case NumberKind::kNoNumber:
      break;
  }
  rows_.refuse_no_number(role);
}

bool XyzReader::next(XyzPoint& point) {
  if (!rows_.next()) {
    return false;
  }
  point = {number(0), number(1), number(2)};
  return true;
}

}  // namespace ptin
