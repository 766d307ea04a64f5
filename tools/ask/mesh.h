// SPDX-License-Identifier: GPL-3.0-or-later
//
// What is told of meshes: `ptin refine`, `stream` and `unstream`.
#pragma once

#include <cstdint>

#include "engine/query/questions.h"
#include "tools/ask/field.h"
#include "tools/formats/mesh.h"

namespace ptin::ask {

[[nodiscard]] Fields<tools::LocalFrame> frame_fields();

struct MeshAnswer {
  const RefinedTin* refined;
  std::uint64_t vertices = 0, triangles = 0;  ///< Of the output.
  const tools::LocalFrame* frame = nullptr;   ///< Null: the output has none.
};
[[nodiscard]] Fields<MeshAnswer> mesh_fields();

[[nodiscard]] Fields<StreamSummary> stream_fields();

}  // namespace ptin::ask
