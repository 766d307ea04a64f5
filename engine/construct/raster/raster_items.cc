// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/raster/raster_items.h"

#include <array>
#include <string_view>
#include <utility>
#include <vector>

#include <cpl_string.h>

namespace ptin {

namespace {

/// The name of an attribute without its variable's, and its value.
using Item = std::pair<std::string, std::string>;

std::vector<Item> items_of(GDALDataset& data) {
  std::vector<Item> items;
  const CPLStringList list(data.GetMetadata(), FALSE);
  for (int i = 0; i < list.size(); ++i) {
    const std::string_view text(list[i]);
    const std::size_t equals = text.find('=');
    const std::size_t hash = text.substr(0, equals).find('#');
    if (equals != std::string_view::npos && hash != std::string_view::npos) {
      items.emplace_back(text.substr(hash + 1, equals - hash - 1), text.substr(equals + 1));
    }
  }
  return items;
}

template <std::size_t N>
bool is_one_of(const std::string& text, const std::array<const char*, N>& words) {
  for (const char* const word : words) {
    if (EQUAL(text.c_str(), word)) {
      return true;
    }
  }
  return false;
}

}  // namespace

std::string plane_unit_of_items(GDALDataset& data) {
  // The spellings of CF, sections 4.1 and 4.2.
  constexpr std::array<const char*, 6> kEast = {"degrees_east", "degree_east", "degree_E",
                                                "degrees_E",    "degreeE",     "degreesE"};
  constexpr std::array<const char*, 6> kNorth = {"degrees_north", "degree_north", "degree_N",
                                                 "degrees_N",     "degreeN",      "degreesN"};
  bool is_east = false, is_north = false;
  for (const auto& [name, value] : items_of(data)) {
    is_east = is_east || (name == "units" && is_one_of(value, kEast));
    is_north = is_north || (name == "units" && is_one_of(value, kNorth));
  }
  return is_east && is_north ? "degree" : "";
}

void warn_of_vertical_items(GDALDataset& data, const std::string& path, SourceWarnings& warnings) {
  constexpr std::array<const char*, 6> kNames = {"geoid_name",     "geopotential_datum_name",
                                                 "vertical_datum", "vert_datum",
                                                 "vertical_crs",   "vertical_datum_name"};
  for (const auto& [name, value] : items_of(data)) {
    if (is_one_of(name, kNames) && !value.empty()) {
      warnings.add({"crs_vertical_in_words",
                    "the heights are told to be above '" + value + "' (" + name +
                        "), which is not used; name the vertical CRS with --vertical-crs",
                    path});
      return;
    }
  }
}

}  // namespace ptin
