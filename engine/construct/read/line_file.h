// SPDX-License-Identifier: GPL-3.0-or-later
//
// Lines and areas with heights, from one file of any format.
#pragma once

#include <functional>
#include <stop_token>
#include <string>
#include <vector>

#include "engine/construct/grid/source_point.h"
#include "engine/construct/grid/source_warning.h"
#include "engine/construct/read/layer_choice.h"

namespace ptin {

/// What a file of lines declares.
struct LineFileCrs {
  std::string crs;       ///< As PointStreamFacts::crs.
  DeclaredUnits units;   ///< As PointStreamFacts::units.
  bool is_flat = false;  ///< Some line or polygon has no heights.
  SourceWarnings warnings{};
};

/// Takes a line. @param has_heights  False: the z of its vertices means nothing.
using TakeLine = std::function<void(const std::vector<SourcePoint>& line, bool has_heights)>;

/// Hands every line, or of LayerKind::kAreas every ring of every polygon, to `take`, in the order of the file. A ring ends
/// with the vertex that it begins with. Features without a geometry are passed over, and so are hidden
/// ones (read/hidden_features.h). From LandXML come the Breaklines and the Boundaries of a
/// surface's SourceData, with northing before easting; from other files what OGR reads.
/// @throws Error  not_found, io_error, cancelled
///                invalid_argument  not a vector file; no layer fits, or several do; a feature is
///                                  no line (no polygon), has curves, or
///                                  a number that is not finite; there is no line at all
[[nodiscard]] LineFileCrs read_line_file(const std::string& path, const LayerWish& wish,
                                         const TakeLine& take, const std::stop_token& stop);

/// Does what read_line_file() says of LandXML, with the same parameters and errors.
[[nodiscard]] LineFileCrs read_land_xml_lines(const std::string& path, const LayerWish& wish,
                                              const TakeLine& take, const std::stop_token& stop);

}  // namespace ptin
