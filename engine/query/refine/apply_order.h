// SPDX-License-Identifier: GPL-3.0-or-later
//
// The order in which splits are applied: topological, and kind to the caches.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "engine/query/select/retrieval.h"

namespace ptin {

/// The indices of `splits` in an order in which every split comes after what it needs.
///
/// Each split belongs to the smallest cell of a quadtree that holds its roi; cells come before
/// their children, and in a cell splits come by falling rank. What a split needs has a larger roi
/// and a larger rank (saturation): so it lies in the same cell, and before, or in one above. A
/// cell's part of the mesh fits into the caches, where an order by rank alone walks the whole mesh
/// once a rank. Few splits are one cell: the order by rank. Equal ones keep their order, and with
/// it the file's. Cost: O(k + largest rank) time and memory, by two counting sorts.
[[nodiscard]] std::vector<std::uint32_t> order_of(std::span<const PendingSplit> splits);

}  // namespace ptin
