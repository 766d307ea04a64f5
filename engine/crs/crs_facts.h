// SPDX-License-Identifier: GPL-3.0-or-later
//
// What a WKT text says about a CRS, in the words that people and other programs use.
#pragma once

#include <string>

#include <nlohmann/json_fwd.hpp>

#include "storage/store_file.h"

namespace ptin {

struct CrsFacts {
  std::string wkt;   ///< WKT2 on one line; empty when unknown.
  std::string name;  ///< Of the horizontal part.
  std::string code;  ///< "EPSG:32611" of the horizontal part; empty when it has none.
  bool has_third_axis =
      false;  ///< Heights are the CRS's own: above its ellipsoid, unless it is local.
  /// The name of the vertical part; "ellipsoidal height" of a third axis. Empty when it is unknown.
  std::string vertical_name;
  std::string vertical_code;  ///< Code of the vertical part, or of a whole CRS of three axes.
  bool geographic = false;
  std::string horizontal_unit = "unknown";
  std::string vertical_unit = "unknown";

  /// The short form for the headers of files: the code where there is one, else the WKT. That of a
  /// CRS of three axes says of its heights, too.
  [[nodiscard]] std::string horizontal_text() const { return code.empty() ? wkt : code; }
  /// The text of a vertical CRS; empty where there is none apart from horizontal_text().
  [[nodiscard]] std::string vertical_text() const {
    if (has_third_axis) return {};
    return vertical_code.empty() ? vertical_name : vertical_code;
  }
};

/// The facts of a WKT text. Of a text that GDAL does not understand: facts that hold the text
/// alone.
[[nodiscard]] CrsFacts crs_facts(const std::string& wkt);

/// Whether the same coordinates are the same place in both: the horizontal parts name one CRS,
/// whatever the order of the axes. Where one of them is unknown: no units that are known differ.
[[nodiscard]] bool is_same_plane(const CrsFacts& a, const CrsFacts& b);

/// The metadata of a store as JSON.  @throws Error corruption when it is none
[[nodiscard]] nlohmann::json metadata_of(const StoreFile& store);

/// The facts of the CRS that a store's metadata hold. The WKT is that of `crs` or `crs_wkt`; units
/// that it does not tell are those of `crs` or `units`.
[[nodiscard]] CrsFacts crs_facts_of(const nlohmann::json& metadata);

/// As crs_facts_of(metadata_of(store)).  @throws Error corruption as metadata_of()
[[nodiscard]] CrsFacts crs_facts(const StoreFile& store);

}  // namespace ptin
