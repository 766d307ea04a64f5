// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/query/select/retrieval.h"

#include "engine/large_array.h"
#include "engine/mesh/tin.h"
#include "engine/mesh/vertex_table.h"

namespace ptin {

std::uint64_t refinement_bytes(std::uint64_t records) noexcept {
  constexpr std::uint64_t kVertexBytes = sizeof(Vertex) + sizeof(std::uint8_t);
  constexpr std::uint64_t kTriangleBytes = sizeof(Triangle) + sizeof(TriangleClass);
  constexpr std::uint64_t kRecordBytes =
      sizeof(PendingSplit) + 4 * sizeof(std::uint32_t) + kVertexBytes + 2 * kTriangleBytes;
  return records * kRecordBytes + VertexTable::bytes_for(records);
}

std::uint64_t most_records(const StoreFile& store, std::span<const PageId> pages) {
  std::uint64_t records = 0;
  for (const PageId page : pages) {
    records += store.page_info(page).records;
  }
  return records;
}

void read_pages(const StoreFile& store, std::span<const PageId> pages,
                const AttributePredicate& predicate, QueryContext& context,
                std::vector<PendingSplit>& out) {
  store.announce(pages, context.heights(), context.cost.io);
  const std::size_t before = out.size();
  for (const PageId page : pages) {
    context.check_stop();
    context.cost.records_examined +=
        store.read_matching(page, predicate, out, context.heights(), context.cost.io);
  }
  context.cost.records_retrieved += out.size() - before;
}

std::vector<PendingSplit> retrieve(const RecordSource& source, const AttributePredicate& predicate,
                                   std::uint64_t fixed_bytes, QueryContext& context) {
  std::vector<PageId> pages;
  source.index.search(predicate, pages, context.cost.io);
  context.check_stop();
  const std::uint64_t records = most_records(source.store, pages);
  context.admit(fixed_bytes + refinement_bytes(records));
  std::vector<PendingSplit> splits;
  reserve_large(splits, records);
  read_pages(source.store, pages, predicate, context, splits);
  return splits;
}

}  // namespace ptin
