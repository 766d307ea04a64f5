// SPDX-License-Identifier: GPL-3.0-or-later
//
// A map of somebody else that the viewer may lay over terrains: where its tiles are, and whom to name.
#pragma once

#include <string>

namespace ptin::serve {

/// Tiles of Web Mercator. The service itself never asks for one.
struct BaseMap {
  /// The address of a tile, with `{z}`, `{x}` and `{y}` or, as WMTS has them, `{TileMatrix}`,
  /// `{TileCol}` and `{TileRow}`; empty: there is no base map.
  std::string tiles;
  std::string attribution;  ///< Empty: pages name the host.

  /// "https://tiles.example.org", for a Content-Security-Policy; empty where there is no base map.
  [[nodiscard]] std::string origin() const;
};

/// @throws Error invalid_argument  `tiles` is no URL of http or https, or lacks one of the three
///               places, or has others; the attribution is none (is_credit()), or there are no tiles
void check_base_map(const BaseMap& map);

}  // namespace ptin::serve
