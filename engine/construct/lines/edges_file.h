// SPDX-License-Identifier: GPL-3.0-or-later
//
// Fixed edges in a temporary file, for other processes of a build and for later ones.
#pragma once

#include "engine/construct/lines/fixed_edges.h"
#include "engine/construct/scratch/array_file.h"

namespace ptin {

/// Appends edges and their vertices. Cost: linear in them.
/// @throws Error io_error, resource_exhausted
void put_edges(ArrayFileWriter& file, const FixedEdges& edges);
/// Reads the edges that put_edges() wrote at this place of the file. Cost: as FixedEdges().
/// @throws Error corruption  they are not what was written
[[nodiscard]] FixedEdges take_edges(ArrayFileReader& file);

}  // namespace ptin
