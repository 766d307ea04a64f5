// SPDX-License-Identifier: GPL-3.0-or-later
//
// Whether a terrain has voids, by the front of its file alone.
#pragma once

#include "storage/store_file.h"

namespace ptin {

/// False only when the full TIN is surface everywhere: the metadata says so, or it is a raster
/// whose samples are all vertices with heights. Void triangles between vertices with heights
/// (--max-edge, holes of TINs) leave no trace in T0 or the table of errors, so of other files true
/// is all that is known. Cost: T0, the table of errors and the metadata.
[[nodiscard]] bool may_have_voids(const StoreFile& store);

}  // namespace ptin
