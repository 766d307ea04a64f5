// SPDX-License-Identifier: GPL-3.0-or-later
//
// What the JSON of a GLB says of one mesh with normals.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include <nlohmann/json_fwd.hpp>

namespace ptin::tools {

/// Types of components, as glTF 2.0 numbers them (section 3.6.2.2).
enum class GlbType : std::uint16_t { kUnsignedShort = 5123, kUnsignedInt = 5125, kFloat = 5126 };

/// A mesh in the binary chunk: positions, normals (three floats each), indices, in this order.
struct GlbMeshFacts {
  std::size_t vertices = 0;
  std::size_t indices = 0;
  GlbType index_type = GlbType::kUnsignedInt;  ///< Type of the indices: one of the unsigned ones.
  std::array<float, 3> low{}, high{};          ///< Around the positions.
};

/// The bytes of the binary chunk, before it is filled up to a multiple of 4.
[[nodiscard]] std::size_t glb_bytes(const GlbMeshFacts& facts) noexcept;

/// Sets materials, meshes, accessors, buffer views and buffers: one mesh of number 0, in triangles,
/// of a matte ground. REQUIRES: vertices and indices above 0; glTF has no empty buffers.
void describe_mesh(nlohmann::json& json, const GlbMeshFacts& facts);

}  // namespace ptin::tools
