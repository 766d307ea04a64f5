// SPDX-License-Identifier: GPL-3.0-or-later
//
// The vertical part of a compound CRS.
#pragma once

#include <string>

class OGRSpatialReference;

namespace ptin {

/// A unit of length.
struct LengthUnit {
  std::string name;  ///< A name for unit_called() (engine/crs/height_unit.h).
  double metres = 1.0;
};

/// The unit of heights of a compound CRS. REQUIRES: `srs` is compound.
[[nodiscard]] LengthUnit vertical_unit_of(const OGRSpatialReference& srs);

/// True where neither the vertical part of a compound CRS nor its datum has a name: it states a
/// unit and nothing else. REQUIRES: `srs` is compound.
[[nodiscard]] bool is_vertical_unnamed(const OGRSpatialReference& srs);

/// True for what stands in the place of a name that nobody gave.
[[nodiscard]] bool is_no_name(const std::string& name);

/// The vertical part of a compound CRS alone: its code, or its WKT.
/// @param unit  Where it is another one than that of the part, the text has this unit, in its name
///              too. REQUIRES: `srs` is compound.
[[nodiscard]] std::string vertical_text(const OGRSpatialReference& srs, const LengthUnit& unit);

}  // namespace ptin
