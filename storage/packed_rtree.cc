// SPDX-License-Identifier: GPL-3.0-or-later
#include "storage/packed_rtree.h"

#include <algorithm>
#include <limits>
#include <string>
#include <vector>

#include "engine/error.h"
#include "storage/descriptor.h"

namespace ptin {

struct PackedRTree::Search {
  const AttributePredicate& predicate;
  std::vector<PageId>& pages;
  IoCounters& counters;
};

void PackedRTree::search(const AttributePredicate& predicate, std::vector<PageId>& pages,
                         IoCounters& counters) const {
  const IndexShape& shape = nodes_.shape();
  if (shape.levels() == 0) {
    return;
  }
  Search search{predicate, pages, counters};
  visit(search, shape.levels() - 1, 0, nodes_.root_checksum());
  nodes_.require_undamaged();
}

layout::NodeEntry PackedRTree::sound_entry(const layout::IndexNode& node, std::uint32_t level,
                                           std::uint64_t number, std::uint32_t i) const {
  const layout::NodeEntry entry = node.entry[i];
  if (!is_sound(entry, heights_)) [[unlikely]] {
    throw Error(
        ErrorCode::corruption,
        "entry " + std::to_string(i) + " has a box, heights or errors that no program wrote",
        nodes_.path() + ", index level " + std::to_string(level) + ", node " +
            std::to_string(number));
  }
  return entry;
}

void PackedRTree::search_best_first(BestFirstVisitor& visitor, IoCounters& counters) const {
  struct Waiting {
    double bound;
    bool is_page;
    std::uint32_t level;  // of a node
    std::uint64_t number, checksum;
    bool operator<(const Waiting& other) const { return bound < other.bound; }
  };
  const IndexShape& shape = nodes_.shape();
  if (shape.levels() == 0) {
    return;
  }
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  std::vector<Waiting> heap{{kInfinity, false, shape.levels() - 1, 0, nodes_.root_checksum()}};
  double cut_off = -kInfinity;
  while (!heap.empty() && heap.front().bound >= cut_off) {
    std::pop_heap(heap.begin(), heap.end());
    const Waiting at = heap.back();
    heap.pop_back();
    if (at.is_page) {
      cut_off = visitor.visit(PageId{at.number});
      continue;
    }
    layout::IndexNode scratch;  // stays untouched when nodes are mapped
    const layout::IndexNode& node = nodes_.node(at.level, at.number, at.checksum, scratch);
    ++counters.index_nodes;
    counters.bytes_read += layout::kNodeBytes;
    const std::uint32_t entries = shape.entries(at.level, at.number);
    for (std::uint32_t i = 0; i < entries; ++i) {
      const layout::NodeEntry entry = sound_entry(node, at.level, at.number, i);
      const double bound = visitor.bound(attributes_of(entry, heights_));
      if (bound > -kInfinity && bound >= cut_off) {
        heap.push_back(
            {bound, at.level == 0, at.level - 1, at.number * layout::kFanOut + i, entry.checksum});
        std::push_heap(heap.begin(), heap.end());
      }
    }
  }
  nodes_.require_undamaged();
}

// Depth first and from left to right, so that pages come out ascending. Depth: the number of
// levels, at most ten.
void PackedRTree::visit(Search& search, std::uint32_t level, std::uint64_t number,
                        std::uint64_t checksum) const {
  layout::IndexNode scratch;  // stays untouched when nodes are mapped
  const layout::IndexNode& node = nodes_.node(level, number, checksum, scratch);
  ++search.counters.index_nodes;
  search.counters.bytes_read += layout::kNodeBytes;
  const std::uint32_t entries = nodes_.shape().entries(level, number);
  for (std::uint32_t i = 0; i < entries; ++i) {
    const layout::NodeEntry entry = sound_entry(node, level, number, i);
    if (!search.predicate.holds(attributes_of(entry, heights_))) {
      continue;
    }
    const std::uint64_t child = number * layout::kFanOut + i;
    if (level == 0) {
      search.pages.push_back(PageId{child});
    } else {
      visit(search, level - 1, child, entry.checksum);
    }
  }
}

}  // namespace ptin
