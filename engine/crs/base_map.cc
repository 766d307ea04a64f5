// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/crs/base_map.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <string_view>

#include <nlohmann/json.hpp>

#include "engine/crs/credits.h"
#include "engine/crs/crs_facts.h"
#include "engine/web_address.h"

namespace ptin {

namespace {

constexpr std::size_t kMostTemplateBytes = 2000;
constexpr std::array<std::string_view, 3> kXyz = {"{z}", "{x}", "{y}"},
                                          kWmts = {"{TileMatrix}", "{TileCol}", "{TileRow}"};

/// Whether all of an address may stand in one: a browser would write other signs differently.
bool is_plain_address(std::string_view url) {
  return std::all_of(url.begin(), url.end(), [](char c) {
    constexpr std::string_view kNever = "\"#<>\\^`|";
    return c > ' ' && c <= '~' && kNever.find(c) == std::string_view::npos;
  });
}

/// Whether a template has each of three places, and no brace beside them.
bool has_places(std::string_view text, const std::array<std::string_view, 3>& places) {
  std::array<bool, 3> has{};
  for (std::size_t at = 0; (at = text.find_first_of("{}", at)) != std::string_view::npos;) {
    const auto* const place = std::find_if(places.begin(), places.end(), [&](std::string_view p) {
      return text.substr(at).starts_with(p);
    });
    if (place == places.end()) return false;
    has[static_cast<std::size_t>(place - places.begin())] = true;
    at += place->size();
  }
  return has[0] && has[1] && has[2];
}

}  // namespace

std::string BaseMap::origin() const { return std::string(origin_of(tiles)); }

const char* fault_of(const BaseMap& map) noexcept {
  if (map.tiles.empty()) {
    return map.attribution.empty()
               ? nullptr
               : "whom to name for a base map is given, and no tiles; give them "
                 "with --base-map TEMPLATE";
  }
  const bool is_address = map.tiles.size() <= kMostTemplateBytes && is_plain_address(map.tiles) &&
                          !origin_of(map.tiles).empty();
  if (!is_address || !(has_places(map.tiles, kXyz) || has_places(map.tiles, kWmts))) {
    return "a base map is an address of tiles: http:// or https://, a host, and either {z}, {x} "
           "and {y} or {TileMatrix}, {TileCol} and {TileRow}, with no other braces, as "
           "https://tiles.example.org/{z}/{x}/{y}.png";
  }
  return is_credit(map.attribution) ? nullptr
                                    : "whom to name for a base map is at most 1,000 bytes of UTF-8 "
                                      "without control characters";
}

BaseMap base_map_of(const nlohmann::json& metadata) {
  BaseMap map{text_of_option(metadata, "base_map"),
              text_of_option(metadata, "base_map_attribution")};
  return fault_of(map) == nullptr ? map : BaseMap();
}

BaseMap base_map_of(const StoreFile& store) { return base_map_of(metadata_of(store)); }

}  // namespace ptin
