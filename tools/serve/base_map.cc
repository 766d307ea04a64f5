// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/serve/base_map.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <string_view>

#include "engine/crs/credits.h"
#include "engine/error.h"
#include "tools/http/forwarded.h"

namespace ptin::serve {

namespace {

constexpr std::string_view kBaseMap = "base map";
constexpr std::size_t kMostTemplateBytes = 2000;
constexpr std::array<std::string_view, 3> kXyz = {"{z}", "{x}", "{y}"},
                                          kWmts = {"{TileMatrix}", "{TileCol}", "{TileRow}"};

/// The part of an address of http or https up to its path; empty where it is none.
std::string_view origin_in(std::string_view url) {
  for (const std::string_view scheme : {"http://", "https://"}) {
    if (!url.starts_with(scheme)) continue;
    const std::size_t end = std::min(url.find_first_of("/?#", scheme.size()), url.size());
    if (http::is_host(url.substr(scheme.size(), end - scheme.size()))) return url.substr(0, end);
  }
  return {};
}

/// Whether all of an address may stand in one: a browser would write other signs differently.
bool is_plain_address(std::string_view url) {
  return std::all_of(url.begin(), url.end(), [](char c) {
    constexpr std::string_view kNever = "\"#<>\\^`|";
    return c > ' ' && c <= '~' && kNever.find(c) == std::string_view::npos;
  });
}

/// Whether a template has each of three places, and no brace beside them.
bool has_places(std::string text, const std::array<std::string_view, 3>& places) {
  for (const std::string_view place : places) {
    if (text.find(place) == std::string::npos) return false;
    for (std::size_t at = 0; (at = text.find(place)) != std::string::npos;) {
      text.erase(at, place.size());
    }
  }
  return text.find_first_of("{}") == std::string::npos;
}

}  // namespace

std::string BaseMap::origin() const { return std::string(origin_in(tiles)); }

void check_base_map(const BaseMap& map) {
  const std::string where(kBaseMap);
  if (map.tiles.empty()) {
    if (map.attribution.empty()) return;
    refuse("an attribution is given, and no tiles; give them with --base-map TEMPLATE", where);
  }
  const bool is_address = map.tiles.size() <= kMostTemplateBytes && is_plain_address(map.tiles) &&
                          !origin_in(map.tiles).empty();
  if (!is_address || !(has_places(map.tiles, kXyz) || has_places(map.tiles, kWmts))) {
    refuse("\"" + map.tiles +
               "\" is no address of tiles; expected http:// or https://, a host, and either {z}, "
               "{x} and {y} or {TileMatrix}, {TileCol} and {TileRow}, with no other braces, as "
               "https://tiles.example.org/{z}/{x}/{y}.png",
           where);
  }
  if (!is_credit(map.attribution)) {
    refuse("an attribution is at most 1,000 bytes of UTF-8 without control characters", where);
  }
}

}  // namespace ptin::serve
