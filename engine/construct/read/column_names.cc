// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/read/column_names.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <utility>

#include "engine/crs/height_unit.h"
#include "engine/error.h"

namespace ptin {
namespace {

constexpr std::array<std::string_view, 12> kNamesOfX = {"x",   "easting",   "eastings", "east",
                                                        "e",   "longitude", "lon",      "long",
                                                        "lng", "point_x",   "x_coord",  "xcoord"};
constexpr std::array<std::string_view, 10> kNamesOfY = {
    "y", "northing", "northings", "north", "n", "latitude", "lat", "point_y", "y_coord", "ycoord"};
constexpr std::array<std::string_view, 11> kNamesOfZ = {
    "z",        "height", "h",       "elevation", "elev",  "ele",
    "altitude", "alt",    "point_z", "z_coord",   "zcoord"};
constexpr std::array<ColumnRole, 3> kPointRoles = {
    {{Coordinate::kX}, {Coordinate::kY}, {Coordinate::kZ}}};

std::span<const std::string_view> names_of(Coordinate which) {
  if (which == Coordinate::kX) {
    return kNamesOfX;
  }
  return which == Coordinate::kY ? std::span<const std::string_view>(kNamesOfY)
                                 : std::span<const std::string_view>(kNamesOfZ);
}

std::string known_unit(std::string_view unit) {
  for (const std::string_view degree : {"deg", "degree", "degrees", "dd", "\u00b0"}) {
    if (equal_in_any_case(unit, degree)) {
      return "degree";
    }
  }
  const std::string name = height_unit_named(std::string(unit));
  return metres_in(name) ? name : "";
}

std::string_view without_blanks_behind(std::string_view text) {
  const std::size_t last = text.find_last_not_of(" \t");
  return text.substr(0, last == std::string_view::npos ? 0 : last + 1);
}

/// The name without the number of an end behind it; empty where another number or none is there.
std::string_view without_end(std::string_view name, int end) {
  if (end == 0) {
    return name;
  }
  if (name.empty() || name.back() != static_cast<char>('0' + end)) {
    return {};
  }
  name.remove_suffix(1);
  if (name.ends_with('_') || name.ends_with(' ')) {
    name.remove_suffix(1);
  }
  return name;
}

}  // namespace

bool equal_in_any_case(std::string_view a, std::string_view b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](unsigned char x, unsigned char y) {
    return std::tolower(x) == std::tolower(y);
  });
}

std::string name_of(ColumnRole role) {
  if (role.end == 0) {
    return {"xyz"[static_cast<std::size_t>(role.coordinate)]};
  }
  return "xyh"[static_cast<std::size_t>(role.coordinate)] + std::to_string(role.end);
}

NamedColumn named_column(std::string_view name) {
  for (const auto& [open, close] : {std::pair{'[', ']'}, std::pair{'(', ')'}}) {
    const std::size_t at = name.rfind(open);
    if (at != std::string_view::npos && at > 0 && name.back() == close) {
      return {without_blanks_behind(name.substr(0, at)), name.substr(at + 1, name.size() - at - 2)};
    }
  }
  const std::size_t line = name.rfind('_');
  if (line != std::string_view::npos && line > 0 && !known_unit(name.substr(line + 1)).empty()) {
    return {name.substr(0, line), name.substr(line + 1)};
  }
  return {name, {}};
}

std::string unit_of_column(std::string_view name) {
  const NamedColumn column = named_column(name);
  return column.unit.empty() ? "" : known_unit(column.unit);
}

std::size_t find_column(std::span<const std::string> names, ColumnRole role) {
  for (const bool may_have_unit : {false, true}) {
    for (const std::string_view known : names_of(role.coordinate)) {
      const auto found = std::find_if(names.begin(), names.end(), [&](std::string_view name) {
        return equal_in_any_case(
            without_end(may_have_unit ? named_column(name).name : name, role.end), known);
      });
      if (found != names.end()) {
        return static_cast<std::size_t>(found - names.begin());
      }
    }
  }
  return names.size();
}

bool is_coordinate_name(std::string_view name) {
  const std::array<std::string, 1> names = {std::string(name)};
  for (const ColumnRole role : kPointRoles) {
    for (const int end : {0, 1, 2}) {
      if (find_column(names, {role.coordinate, end}) == 0) {
        return true;
      }
    }
  }
  return false;
}

std::vector<std::size_t> columns_of(std::span<const std::string> names,
                                    std::span<const ColumnRole> roles) {
  const auto refuse = [](const std::string& what) {
    throw Error(ErrorCode::invalid_argument,
                what +
                    "; name the columns from the left, the coordinates x, y, z (or as a header "
                    "may name them) and those to be skipped by any other name",
                "--columns");
  };
  std::vector<std::size_t> columns;
  for (const ColumnRole role : roles) {
    const std::size_t column = find_column(names, role);
    if (column == names.size()) {
      refuse("there is no column for " + name_of(role));
    }
    // A name without a unit comes before the same with one, which then names another column.
    const bool has_unit = !named_column(names[column]).unit.empty();
    const auto is_it = [&](const std::string& name) {
      const std::array<std::string, 1> alone = {name};
      return find_column(alone, role) == 0 && (has_unit || named_column(name).unit.empty());
    };
    if (std::count_if(names.begin(), names.end(), is_it) > 1) {
      refuse("there are two columns for " + name_of(role));
    }
    columns.push_back(column);
  }
  return columns;
}

std::span<const ColumnRole> point_roles() noexcept { return kPointRoles; }

}  // namespace ptin
