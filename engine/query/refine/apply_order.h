// SPDX-License-Identifier: GPL-3.0-or-later
//
// The order in which splits are applied: topological, and kind to the caches.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "engine/query/select/retrieval.h"

namespace ptin {

/// The indices of `splits` in an order in which every split comes after those that it needs.
///
/// Each split belongs to the smallest cell of a quadtree that holds its roi. Cells come before
/// their children, and within a cell splits come by falling rank. What a split needs has a larger
/// roi and a larger rank (saturation), so it lies in the same cell and comes first there, or lies
/// in a cell above. The part of the mesh in a cell fits into the caches, while an order by rank
/// alone walks the whole mesh once for each rank. Up to 4096 splits form one cell and are ordered
/// by rank alone. Splits of the same cell and rank keep the order in which they are given.
/// Cost: O(k + largest rank) time and memory for k splits, by two counting sorts.
[[nodiscard]] std::vector<std::uint32_t> order_of(std::span<const PendingSplit> splits);

}  // namespace ptin
