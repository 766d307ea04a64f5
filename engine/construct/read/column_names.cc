// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/read/column_names.h"

#include <algorithm>
#include <array>
#include <cctype>

namespace ptin {
namespace {

constexpr std::array<std::string_view, 8> kNamesOfX = {"x",         "easting", "east", "e",
                                                       "longitude", "lon",     "long", "point_x"};
constexpr std::array<std::string_view, 7> kNamesOfY = {"y",        "northing", "north",  "n",
                                                       "latitude", "lat",      "point_y"};
constexpr std::array<std::string_view, 8> kNamesOfZ = {"z",    "height",   "h",   "elevation",
                                                       "elev", "altitude", "alt", "point_z"};

std::span<const std::string_view> names_of(Coordinate which) {
  if (which == Coordinate::kX) {
    return kNamesOfX;
  }
  return which == Coordinate::kY ? std::span<const std::string_view>(kNamesOfY) : kNamesOfZ;
}

std::string_view unquoted(std::string_view field) {
  constexpr std::string_view kAround = " \t\r";
  if (field.size() >= 2 && field.front() == '"' && field.back() == '"') {
    field = field.substr(1, field.size() - 2);
    field.remove_prefix(std::min(field.find_first_not_of(kAround), field.size()));
    field = field.substr(0, field.find_last_not_of(kAround) + 1);
  }
  return field;
}

bool equal_in_any_case(std::string_view a, std::string_view b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](unsigned char x, unsigned char y) {
    return std::tolower(x) == std::tolower(y);
  });
}

}  // namespace

std::size_t find_column(std::span<const std::string_view> fields, Coordinate which) {
  for (const std::string_view name : names_of(which)) {
    const auto found = std::find_if(fields.begin(), fields.end(), [&](std::string_view field) {
      return equal_in_any_case(unquoted(field), name);
    });
    if (found != fields.end()) {
      return static_cast<std::size_t>(found - fields.begin());
    }
  }
  return fields.size();
}

}  // namespace ptin
