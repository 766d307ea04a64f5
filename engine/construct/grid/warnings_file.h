// SPDX-License-Identifier: GPL-3.0-or-later
//
// The warnings of a reader in a temporary file.
#pragma once

#include "engine/construct/grid/source_warning.h"
#include "engine/construct/scratch/array_file.h"

namespace ptin {

/// Appends them to a file of arrays.  @throws Error io_error, resource_exhausted
void put_warnings(ArrayFileWriter& file, const SourceWarnings& warnings);
/// Reads what put_warnings() wrote at this place of the file.
/// @throws Error corruption  the next arrays are no warnings, or are damaged
[[nodiscard]] SourceWarnings take_warnings(ArrayFileReader& file);

}  // namespace ptin
