// SPDX-License-Identifier: GPL-3.0-or-later
//
// The warnings of a reader in a temporary file.
#pragma once

#include "engine/construct/grid/source_warning.h"
#include "engine/construct/scratch/array_file.h"

namespace ptin {

/// @throws Error as ArrayFileWriter::values(), ArrayFileReader::values()
void serialize(ArrayFileWriter& file, const SourceWarnings& warnings);
void serialize(ArrayFileReader& file, SourceWarnings& warnings);

}  // namespace ptin
