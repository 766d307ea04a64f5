// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/formats/crs_lines.h"

namespace ptin::tools {

std::string crs_lines(const CrsFacts& crs, const std::string& mark) {
  std::string text;
  const auto add = [&](const char* key, const std::string& value) {
    if (!value.empty() && value != "unknown")
      text.append(mark).append(key).append(value).append("\n");
  };
  add("crs: ", crs.horizontal_text());
  add("vertical_crs: ", crs.vertical_text());
  if (crs.wkt.empty()) add("units: ", crs.horizontal_unit);
  const bool is_told =
      crs.wkt.empty() ? crs.vertical_unit == crs.horizontal_unit : !crs.vertical_name.empty();
  if (!is_told) add("height_units: ", crs.vertical_unit);
  return text;
}

}  // namespace ptin::tools
