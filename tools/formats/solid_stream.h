// SPDX-License-Identifier: GPL-3.0-or-later
//
// A surface as a closed solid, for printers: the surface on top, walls along its borders, a flat base.
#pragma once

#include <cstdint>
#include <memory>

#include "tools/formats/mesh_stream.h"

namespace ptin::tools {

/// Passes a surface on to `inner` with all that closes it: below each triangle its mirror image at
/// the height `base`, and along each edge that only one triangle has a wall of two triangles, its
/// outer side out. So voids are holes that go through, and each edge has two triangles that run
/// along it in opposite directions. Where two borders touch in one vertex, the edge below it has
/// four.
///
/// Vertex k of the surface is vertex 2 k of the solid, and the one below it 2 k + 1. Walls come last,
/// in the order of their vertices. Takes some 100 bytes for each edge that has one triangle so far.
///
/// add_vertex() throws Error invalid_argument where a vertex is not above the base; add_triangle()
/// resource_exhausted where the open edges take more than `most_bytes`.
[[nodiscard]] std::unique_ptr<MeshStream> make_solid(std::unique_ptr<MeshStream> inner, double base,
                                                     std::uint64_t most_bytes = UINT64_MAX);

/// The solid of a whole mesh, as a mesh.  @throws Error invalid_argument  as make_solid(); more
/// vertices than 32 bits count
[[nodiscard]] Mesh solid_of(const Mesh& surface, double base);

}  // namespace ptin::tools
