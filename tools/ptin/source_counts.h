// SPDX-License-Identifier: GPL-3.0-or-later
//
// Whether there is a surface, from what the build counted of its source.
#pragma once

#include "engine/query/questions.h"
#include "tools/facts/source_count.h"

namespace ptin::tools {

/// Whether the full TIN has a surface: some sample has a height, and not each such sample is lone.
/// @throws Error as source_count()
[[nodiscard]] bool has_surface(const StoreFile& store);

}  // namespace ptin::tools
