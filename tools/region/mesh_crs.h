// SPDX-License-Identifier: GPL-3.0-or-later
//
// What a mesh on its way out says of its CRS and of its place.
#pragma once

#include <string>

#include <nlohmann/json_fwd.hpp>

#include "engine/crs/crs_facts.h"
#include "storage/store_file.h"
#include "tools/formats/mesh.h"

namespace ptin::tools {

/// Fills in the CRS, the lengths of its units at the middle of the mesh, and the frame.
/// @param facts  Facts of the terrain.
void set_crs(Mesh& mesh, const CrsFacts& crs, const StoreFacts& facts);

/// The frame of all meshes of a terrain, whatever their window and level of detail, so that they
/// fit together: its origin is the middle of the terrain in whole map units (degrees: 10^-4) at height 0, its units
/// are metres, by their lengths there.
[[nodiscard]] LocalFrame frame_of(const StoreFacts& facts, const CrsFacts& crs);

/// True when a format keeps to that frame, and an answer has to say so.
/// @param path  Path of the output.
/// @throws Error as mesh_format_of()
[[nodiscard]] bool has_frame(const std::string& path);
/// The frame as `{"origin", "scale"}`, and as a line for people.
[[nodiscard]] nlohmann::json frame_json(const LocalFrame& frame);
[[nodiscard]] std::string frame_text(const LocalFrame& frame);

}  // namespace ptin::tools
