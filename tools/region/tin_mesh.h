// SPDX-License-Identifier: GPL-3.0-or-later
//
// From a refined TIN on the grid to a mesh in map coordinates.
#pragma once

#include "engine/query/questions.h"
#include "storage/store_file.h"
#include "tools/formats/mesh.h"

namespace ptin::tools {

/// The surface triangles of `refined`, with the vertices that they use, in map units. The CRS is
/// left empty. Cost: linear.
[[nodiscard]] Mesh surface_mesh(const RefinedTin& refined, const StoreFacts& facts);

}  // namespace ptin::tools
