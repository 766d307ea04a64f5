// SPDX-License-Identifier: GPL-3.0-or-later
//
// Layers whose points have depths where heights belong.
#pragma once

#include <string>

#include "engine/construct/grid/source_warning.h"

class GDALDataset;
class OGRLayer;

namespace ptin {

/// Refuses the soundings of a nautical chart (S-57), and attributes of one that hold depths. Warns of
/// any other layer, or attribute, that has a name of depths.
/// @param z_field  The attribute that holds heights; "" for the z of points.
/// @throws Error invalid_argument  as above
void refuse_depths(GDALDataset& data, OGRLayer& layer, const std::string& z_field,
                   const std::string& path, SourceWarnings& warnings);

}  // namespace ptin
