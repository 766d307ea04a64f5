// SPDX-License-Identifier: GPL-3.0-or-later
//
// What the LandXML files that are written have in common: units, CRS, positions.
#pragma once

#include <string>

#include "engine/crs/crs_facts.h"

namespace ptin::tools {

/// From the declaration up to the open element Surface. A CRS with an EPSG code is named by it,
/// another one by its WKT. Where the units of the plane are none of metre, foot and US survey foot,
/// the file names none.
/// @param path  Named in errors.
/// @throws Error invalid_argument  the CRS is geographic: a LandXML file has a plane
[[nodiscard]] std::string land_xml_head(const CrsFacts& crs, const std::string& path);
/// From the end of Surface to the end of the file.
[[nodiscard]] std::string land_xml_tail();
/// Appends a position as LandXML has it: northing, then easting.
void append_land_xml_position(std::string& text, double x, double y);

}  // namespace ptin::tools
