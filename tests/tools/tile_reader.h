// SPDX-License-Identifier: GPL-3.0-or-later
//
// Readers of tiles, written from the formats' specifications and from nothing of tools/tiles. They
// throw std::runtime_error on what the specifications forbid.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

namespace ptin::tools::testing {

using Ecef = std::array<double, 3>;

/// quantized-mesh 1.0.
struct ReadTerrain {
  Ecef centre{}, sphere_centre{}, horizon{};
  float least = 0.0F, most = 0.0F;
  double radius = 0.0;
  std::vector<std::uint16_t> u, v, h;
  std::vector<std::array<std::uint32_t, 3>> triangles;
  std::vector<std::uint32_t> west, south, east, north;
  std::vector<std::array<std::uint8_t, 2>> normals;  ///< As they are coded; empty without.
  std::size_t index_bytes = 0;

  [[nodiscard]] double height(std::size_t i) const {
    const double step = (static_cast<double>(most) - static_cast<double>(least)) / 32767.0;
    return static_cast<double>(least) + h[i] * step;
  }
};
[[nodiscard]] ReadTerrain read_terrain_tile(const std::string& bytes);

/// A glTF binary with at most one mesh of one primitive, as tiles have it.
struct ReadGlb {
  nlohmann::json json;
  std::vector<Ecef> positions;  ///< Earth-centred: with the node's translation, z up.
  std::vector<std::array<float, 3>> normals;
  std::vector<std::array<std::uint32_t, 3>> triangles;
};
[[nodiscard]] ReadGlb read_tile_glb(const std::string& bytes);

/// A subtree of implicit tiling, QUADTREE.
struct ReadSubtree {
  std::vector<bool> tiles, contents, subtrees;
};
[[nodiscard]] ReadSubtree read_subtree(const std::string& bytes, int levels);

/// The unit vector that octvertexnormals code.
[[nodiscard]] Ecef oct_decoded(const std::array<std::uint8_t, 2>& code);

}  // namespace ptin::tools::testing
