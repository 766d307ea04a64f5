// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/query/refine/page_cache.h"

#include <utility>

namespace ptin {

std::uint64_t PageCache::Entry::bytes() const noexcept {
  constexpr std::uint64_t kBeside = 128;  // list node, table node and their allocations
  return records.capacity() * sizeof(VertexSplit) + kBeside;
}

void PageCache::announce(std::span<const PageId> pages, QueryContext& context) const {
  std::vector<PageId> missing;
  for (const PageId page : pages) {
    if (!places_.contains(index_of(page))) {
      missing.push_back(page);
    }
  }
  store_.announce(missing, context.heights(), context.cost.io);
}

std::span<const VertexSplit> PageCache::records(PageId page, QueryContext& context) {
  if (const auto place = places_.find(index_of(page)); place != places_.end()) {
    entries_.splice(entries_.begin(), entries_, place->second);
    return place->second->records;
  }
  Entry entry{page, {}};
  entry.records.reserve(store_.page_info(page).records);
  store_.read_records(page, entry.records, context.heights(), context.cost.io);
  make_room(entry.bytes());
  entries_.push_front(std::move(entry));
  try {
    places_.emplace(index_of(page), entries_.begin());
  } catch (...) {
    entries_.pop_front();
    throw;
  }
  bytes_ += entries_.front().bytes();
  return entries_.front().records;
}

void PageCache::make_room(std::uint64_t bytes) {
  while (!entries_.empty() && bytes_ + bytes > limit_bytes_) {
    bytes_ -= entries_.back().bytes();
    places_.erase(index_of(entries_.back().page));
    entries_.pop_back();
  }
}

}  // namespace ptin
