// SPDX-License-Identifier: GPL-3.0-or-later
//
// What a WKT text says about a CRS, in the words that people and other programs use.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include <nlohmann/json_fwd.hpp>

#include "engine/crs/ground_facts.h"
#include "storage/store_file.h"

namespace ptin {

struct CrsFacts {
  std::string wkt;  ///< WKT2 on one line; empty when unknown.
  /// GDAL understands the text. Else what follows is unknown, but for units that are told beside it.
  bool is_understood = false;
  std::string name;  ///< Name of the horizontal part.
  std::string code;  ///< "EPSG:32611" of the horizontal part; empty when it has none.
  bool has_third_axis =
      false;  ///< Heights are the CRS's own: above its ellipsoid, unless it is local.
  /// The name of the vertical part; "ellipsoidal height" of a third axis. Empty when it is unknown.
  std::string vertical_name;
  std::string vertical_code;  ///< Code of the vertical part, or of a whole CRS of three axes.
  bool geographic = false;
  /// The authority's order of axes begins with the one to the north, as that of EPSG:4326. Positions
  /// in files and answers have x, to the east, first all the same.
  bool north_first = false;
  std::string horizontal_unit = "unknown";
  std::string vertical_unit = "unknown";
  /// Where `is_understood`: the ellipsoid and the size of the map unit. metres_per_height is that of
  /// the vertical part, and 0 where there is none apart from the axes of the plane.
  GroundFacts ground{.metres_per_height = 0.0};

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
/// alone. Cost: starts GDAL and PROJ where nobody has yet, some milliseconds.
[[nodiscard]] CrsFacts crs_facts(const std::string& wkt);
/// How many texts this process has given to GDAL for their facts.
[[nodiscard]] std::uint64_t crs_texts_read() noexcept;

/// The facts of a text as a build writes them beside it (storage/FORMAT.md, "Metadata"), so that
/// nobody needs GDAL to know them. Null where the text is not understood.
[[nodiscard]] nlohmann::json json_of(const CrsFacts& crs);
/// What json_of() gave; none where a member is missing, or means nothing.
[[nodiscard]] std::optional<CrsFacts> crs_facts_told(const nlohmann::json& facts, std::string wkt);

/// Whether the same coordinates are the same place in both: the horizontal parts name one CRS,
/// whatever the order of the axes. Where one of them is unknown: no units that are known differ.
[[nodiscard]] bool is_same_plane(const CrsFacts& a, const CrsFacts& b);

/// The metadata of a store as JSON.  @throws Error corruption when it is none
[[nodiscard]] nlohmann::json metadata_of(const StoreFile& store);

/// The facts of the CRS that a store's metadata hold. The WKT is that of `crs` or `crs_wkt`; it is
/// read where the facts do not stand beside it. Units that it does not tell are those of `units`.
[[nodiscard]] CrsFacts crs_facts_of(const nlohmann::json& metadata);

/// As crs_facts_of(metadata_of(store)).  @throws Error corruption as metadata_of()
[[nodiscard]] CrsFacts crs_facts(const StoreFile& store);

}  // namespace ptin
