// SPDX-License-Identifier: GPL-3.0-or-later
//
// What a WKT text says about a CRS, in the words that people and other programs use.
#pragma once

#include <string>

#include <nlohmann/json_fwd.hpp>

#include "storage/store_file.h"

namespace ptin {

struct CrsFacts {
  std::string wkt;            ///< WKT2 on one line; empty when unknown.
  std::string name;           ///< Of the horizontal part.
  std::string code;           ///< "EPSG:32611" of the horizontal part; empty when it has none.
  std::string vertical_name;  ///< Empty when the vertical CRS is unknown.
  std::string vertical_code;
  bool geographic = false;
  std::string horizontal_unit = "unknown";
  std::string vertical_unit = "unknown";

  /// The short form for the headers of files: the code where there is one, else the WKT.
  [[nodiscard]] std::string horizontal_text() const { return code.empty() ? wkt : code; }
  [[nodiscard]] std::string vertical_text() const {
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
