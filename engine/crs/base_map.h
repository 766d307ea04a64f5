// SPDX-License-Identifier: GPL-3.0-or-later
//
// A map of somebody else that a viewer may lay over a terrain: where its tiles are, and whom to name.
#pragma once

#include <string>

#include <nlohmann/json_fwd.hpp>

#include "storage/store_file.h"

namespace ptin {

/// Tiles of Web Mercator. Nothing here ever asks for one.
struct BaseMap {
  /// The address of a tile, with `{z}`, `{x}` and `{y}` or, as WMTS has them, `{TileMatrix}`,
  /// `{TileCol}` and `{TileRow}`; empty: there is no base map.
  std::string tiles;
  std::string attribution;  ///< Empty: pages name the host.

  /// "https://tiles.example.org", for a Content-Security-Policy; empty where there is no base map.
  [[nodiscard]] std::string origin() const;
};

/// Why something is no base map, as a sentence that names the options: `tiles` is no URL of http or
/// https, or lacks one of the three places, or has others; the attribution is none (is_credit()), or
/// there are no tiles. Null: it is one, or there is none.
[[nodiscard]] const char* fault_of(const BaseMap& map) noexcept;

/// The one that the metadata of a store hold (`options.base_map`, `options.base_map_attribution`). What no build
/// writes, since it has a fault, counts as none. Never throws for what a file says.
[[nodiscard]] BaseMap base_map_of(const nlohmann::json& metadata);
/// @throws Error corruption as metadata_of()
[[nodiscard]] BaseMap base_map_of(const StoreFile& store);

/// Adds the member `base_map` to an object, where there is one: `tiles` and `attribution`.
template <class Json>
void add_base_map(Json& object, const BaseMap& map) {
  if (map.tiles.empty()) return;
  object["base_map"] = {{"tiles", map.tiles}, {"attribution", map.attribution}};
}

}  // namespace ptin
