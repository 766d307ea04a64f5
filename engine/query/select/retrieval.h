// SPDX-License-Identifier: GPL-3.0-or-later
//
// Retrieval: from a monotone predicate to the records for which it is true, through index and
// pages.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "engine/query/select/accounting.h"
#include "storage/index.h"
#include "storage/pending_split.h"
#include "storage/store_file.h"

namespace ptin {

/// How many triangles a split adds: one at a border, otherwise two. None only for a damaged record,
/// which split() refuses.
[[nodiscard]] constexpr std::uint32_t triangles_of(std::uint32_t flags) noexcept {
  static_assert(VertexSplit::kNoRight == 2 * VertexSplit::kNoLeft);
  constexpr std::uint8_t kTriangles[] = {2, 1, 1, 0};  // without branches
  return kTriangles[flags / VertexSplit::kNoLeft % 4];
}

/// Bytes that reading and applying `records` records take at most: records, mesh and key table.
[[nodiscard]] std::uint64_t refinement_bytes(std::uint64_t records) noexcept;

/// Where records come from. Borrowed: store and index outlive the query.
struct RecordSource {
  const StoreFile& store;
  const RecordIndex& index;
};

/// Most records that `pages` can hold, from their descriptors: known before anything is read.
/// @throws Error corruption
[[nodiscard]] std::uint64_t most_records(const StoreFile& store, std::span<const PageId> pages);

/// Reads `pages` (ascending) and appends their records for which `predicate` is true, in the order
/// of the file.
/// @throws Error corruption, io_error, cancelled
/// Cost: announces all pages, then reads each once.
void read_pages(const StoreFile& store, std::span<const PageId> pages,
                const AttributePredicate& predicate, QueryContext& context,
                std::vector<PendingSplit>& out);

/// Retrieves the records for which `predicate` is true: searches the index, asks `context` for the
/// memory that the answer may take, then reads the pages.
/// @param fixed_bytes  What the query holds besides its records (T0).
/// @throws Error resource_exhausted (before any page is read), corruption, io_error, cancelled
[[nodiscard]] std::vector<PendingSplit> retrieve(const RecordSource& source,
                                                 const AttributePredicate& predicate,
                                                 std::uint64_t fixed_bytes, QueryContext& context);

}  // namespace ptin
