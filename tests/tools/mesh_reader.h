// SPDX-License-Identifier: GPL-3.0-or-later
//
// Minimal readers of the mesh formats, written from their specifications and from no writer of
// ours.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

namespace ptin::tools::testing {

struct ReadMesh {
  std::vector<std::array<double, 3>> vertices;
  std::vector<std::array<std::uint32_t, 3>> triangles;
  std::vector<std::string> header;  ///< Lines before the data, where the format has them.
  nlohmann::json json;              ///< GLB: the JSON chunk.
};

/// Each throws std::runtime_error when the bytes are not what the specification says.
[[nodiscard]] ReadMesh read_ply(const std::string& content);
[[nodiscard]] ReadMesh read_obj(const std::string& content);
[[nodiscard]] ReadMesh read_2dm(const std::string& content);
[[nodiscard]] ReadMesh read_glb(const std::string& content);

}  // namespace ptin::tools::testing
