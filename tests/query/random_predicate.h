// SPDX-License-Identifier: GPL-3.0-or-later
//
// Random regions and predicates over a terrain.
#pragma once

#include <random>
#include <string>

#include "engine/query/select/predicate.h"
#include "storage/store_file.h"

namespace ptin::reference {

/// A window, point, segment or polygon (star-shaped or self-crossing, sometimes with a hole) that
/// mostly meets the terrain; often through vertices, along grid lines, or outside.
[[nodiscard]] Region random_region(std::mt19937_64& random, const StoreFacts& facts);

/// A predicate of any kind, or a composition of up to `depth` levels.
[[nodiscard]] PredicatePtr random_predicate(std::mt19937_64& random, const StoreFacts& facts,
                                            int depth);

}  // namespace ptin::reference
