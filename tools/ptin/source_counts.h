// SPDX-License-Identifier: GPL-3.0-or-later
//
// What the build counted of its source.
#pragma once

#include <cstdint>

#include "engine/query/terrain.h"

namespace ptin::tools {

/// A count of the metadata's `source`, as "void_samples"; 0 when the build wrote none.
/// @throws Error corruption  what stands there is no count
[[nodiscard]] std::uint64_t source_count(const StoreFile& store, const char* key);

/// Whether the full TIN has a surface: some sample has a height, and not each such sample is lone.
/// @throws Error as source_count()
[[nodiscard]] bool has_surface(const StoreFile& store);

}  // namespace ptin::tools
