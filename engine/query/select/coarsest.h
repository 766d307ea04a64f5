// SPDX-License-Identifier: GPL-3.0-or-later
//
// T0 as a mesh.
#pragma once

#include <string>

#include "engine/mesh/tin.h"
#include "storage/coarsest_tin.h"

namespace ptin {

/// T0 as a mesh with neighbours; every query starts from a copy of it. Vertices and triangles keep
/// their order.
/// @param file  Named in errors.
/// @throws Error corruption when the stored triangles are not a valid TIN (mesh/validate.h)
/// Cost: O(|T0| log |T0|).
[[nodiscard]] Tin mesh_of(const CoarsestTin& t0, const std::string& file);

}  // namespace ptin
