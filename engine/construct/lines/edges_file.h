// SPDX-License-Identifier: GPL-3.0-or-later
//
// Fixed edges in a temporary file, for other processes of a build and for later ones.
#pragma once

#include "engine/construct/lines/fixed_edges.h"
#include "engine/construct/scratch/array_file.h"

namespace ptin {

/// Cost: linear in the edges to write them, as FixedEdges() to read them.
/// @throws Error as ArrayFileWriter::values(), ArrayFileReader::values()
void serialize(ArrayFileWriter& file, const FixedEdges& edges);
void serialize(ArrayFileReader& file, FixedEdges& edges);

}  // namespace ptin
