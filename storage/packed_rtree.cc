// SPDX-License-Identifier: GPL-3.0-or-later
#include "storage/packed_rtree.h"

#include <algorithm>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "engine/error.h"
#include "engine/geometry/infinity.h"
#include "storage/descriptor.h"
#include "storage/page_columns.h"
#include "storage/page_stores.h"

namespace ptin {

namespace {

/// The nodes of a level that are to be visited: their numbers, which ascend, and their checksums.
struct Found {
  std::vector<std::uint64_t> numbers, checksums;
};

/// Whether the stars that an entry describes may hold what a filter asks for.
class StarTest {
 public:
  StarTest(const StarFilter& filter, const HeightEncoding& heights)
      : filter_(filter), heights_(heights), level_(level_bits(filter.level)) {}
  [[nodiscard]] bool operator()(const layout::NodeEntry& e) const {
    // Few entries of a node pass the first three lines, which look at whole numbers alone.
    const GridBox& box = filter_.box;
    return e.star_min_x <= box.max_x && box.min_x <= e.star_max_x && e.star_min_y <= box.max_y &&
           box.min_y <= e.star_max_y && e.error_max > level_ - (filter_.with_ties ? 1 : 0) &&
           e.death_min <= level_ + 1 && (asks_no_more_ || passes(star_attributes_of(e, heights_)));
  }

 private:
  [[nodiscard]] bool passes(const StarAttributes& a) const {
    return meets(a.heights, filter_.heights) &&
           (filter_.also == nullptr || filter_.also->may_hold(a));
  }

  const StarFilter& filter_;
  const HeightEncoding& heights_;
  std::int32_t level_;
  bool asks_no_more_ = filter_.heights == kAllHeights && filter_.also == nullptr;
};

}  // namespace

/// Searches level by level, and announces the nodes of each level before it reads them: so a search
/// waits for the disk once a level, not once a node. Within a level nodes are visited from left to
/// right, so that pages come out ascending.
template <class Test, class Take>
void PackedRTree::descend(const Test& test, IoCounters& counters, const Take& take) const {
  const IndexShape& shape = nodes_.shape();
  if (shape.levels() == 0) {
    return;
  }
  Found found{{0}, {nodes_.root_checksum()}};
  Found below;
  for (std::uint32_t level = shape.levels(); level-- > 0;) {
    if (found.numbers.size() > 1) {
      nodes_.announce(level, found.numbers, counters);
    }
    below.numbers.clear();
    below.checksums.clear();
    for (std::size_t i = 0; i < found.numbers.size(); ++i) {
      visit({level, found.numbers[i], found.checksums[i]}, test, counters,
            [&](std::uint64_t child, const layout::NodeEntry& entry) {
              if (level == 0) {
                take(PageId{child}, entry);
              } else {
                below.numbers.push_back(child);
                below.checksums.push_back(entry.checksum);
              }
            });
    }
    std::swap(found, below);
  }
  nodes_.require_undamaged();
  nodes_.settle(counters);
}

void PackedRTree::search(const AttributePredicate& predicate, std::vector<PageId>& pages,
                         IoCounters& counters) const {
  descend([&](const layout::NodeEntry& e) { return predicate.holds(attributes_of(e, heights_)); },
          counters, [&](PageId id, const layout::NodeEntry&) { pages.push_back(id); });
}

void PackedRTree::search_stars(const StarFilter& filter, std::vector<StarPage>& pages,
                               IoCounters& counters) const {
  const StarTest test(filter, heights_);
  descend(test, counters, [&](PageId id, const layout::NodeEntry& e) {
    pages.push_back({id, short_value(e.error_max), e.records});
  });
}

/// A node or page on the heap of a best-first search.
class PackedRTree::Waiting {
 public:
  Merit bound;
  std::uint32_t level;  // above that of its descriptor; 0: a page
  std::uint64_t number;
  std::uint64_t checksum;  // of a page: its place among the attributes
  bool operator<(const Waiting& other) const {
    if (bound.is_below(other.bound) || other.bound.is_below(bound)) {
      return bound.is_below(other.bound);
    }
    return level != other.level ? level < other.level : number > other.number;
  }
};

bool PackedRTree::is_at_hand(const Waiting& w) const noexcept {
  return w.level == 0 ? pages_->is_at_hand(PageId{w.number})
                      : nodes_.is_at_hand(w.level - 1, w.number);
}

/// The heap of a best-first search, and what is done with its nodes.
class PackedRTree::BestFirst {
 public:
  BestFirst(const PackedRTree& tree, const StarFilter& filter, BestStarVisitor& visitor,
            Merit cut_off, IoCounters& counters)
      : tree_(tree),
        test_(filter, tree.heights_),
        visitor_(visitor),
        cut_off_(cut_off),
        counters_(counters),
        together_(visitor.wants_all() ? kMostTogether : kFirstTogether),
        heap_{{kBestMerit, tree.nodes_.shape().levels(), 0, tree.nodes_.root_checksum()}} {}

  void run() {
    while (is_left()) {
      const Waiting at = pop();
      if (tree_.pages_ != nullptr && tree_.pages_->is_far() && !tree_.is_at_hand(at)) {
        announce_with_best(at);
      }
      if (at.level == 0) {
        cut_off_ = visitor_.visit(PageId{at.number}, pages_[at.checksum]);
      } else {
        open(at);
      }
    }
  }

 private:
  [[nodiscard]] bool is_left() const {
    return !heap_.empty() && !heap_.front().bound.is_below(cut_off_);
  }
  Waiting pop() {
    std::pop_heap(heap_.begin(), heap_.end());
    const Waiting at = heap_.back();
    heap_.pop_back();
    return at;
  }
  void push(const Waiting& w) {
    heap_.push_back(w);
    std::push_heap(heap_.begin(), heap_.end());
  }
  void open(const Waiting& at);
  void announce_with_best(const Waiting& next);

  const PackedRTree& tree_;
  StarTest test_;
  BestStarVisitor& visitor_;
  Merit cut_off_;
  IoCounters& counters_;
  /// What is announced together: of most points one time of nodes and one of pages are enough. A
  /// search that goes on will probably go on for long.
  static constexpr std::size_t kFirstTogether = 6, kMostTogether = 96;
  std::size_t together_;
  std::size_t announced_ = 0;  ///< Times.
  std::vector<StarAttributes> pages_;
  std::vector<Waiting> heap_;
};

/// Puts what a node describes on the heap.
void PackedRTree::BestFirst::open(const Waiting& at) {
  const NodePlace place{at.level - 1, at.number, at.checksum};
  tree_.visit(place, test_, counters_, [&](std::uint64_t child, const layout::NodeEntry& entry) {
    const StarAttributes a = star_attributes_of(entry, tree_.heights_);
    const bool is_page = place.level == 0;
    const Merit bound = is_page ? visitor_.bound(a) : visitor_.bound_of_node(a, place.level - 1);
    if (!bound.is_below(cut_off_)) {
      push({bound, place.level, child, is_page ? pages_.size() : entry.checksum});
      if (is_page) {
        pages_.push_back(a);
      }
    }
  });
}

/// Announces the best of what waits, which will probably be visited soon, together with what is
/// visited next: that must be waited for anyhow in a far file. Nodes that are at hand are opened
/// for it; the order in which nodes are opened decides nothing.
void PackedRTree::BestFirst::announce_with_best(const Waiting& next) {
  if (++announced_ > 2 && together_ < kMostTogether) {
    together_ *= 2;
  }
  std::vector<Waiting> best{next};  // What is read first is announced first.
  while (best.size() < together_ && is_left()) {
    const Waiting at = pop();
    if (at.level > 0 && tree_.is_at_hand(at)) {
      open(at);
    } else {
      best.push_back(at);
    }
  }
  std::vector<GridBox> stars;
  {
    RangesToCome ranges(tree_.nodes_.file(), counters_);
    for (const Waiting& w : best) {
      if (w.level == 0) {
        const PageId page{w.number};
        tree_.pages_->add_ranges(std::span(&page, 1), ranges);
        stars.push_back(pages_[w.checksum].box);
      } else {
        tree_.nodes_.add_ranges(w.level - 1, std::span(&w.number, 1), ranges);
      }
    }
  }
  visitor_.will_visit(stars);
  std::for_each(best.begin() + 1, best.end(), [&](const Waiting& w) { push(w); });
}

void PackedRTree::search_stars_best_first(const StarFilter& filter, BestStarVisitor& visitor,
                                          Merit cut_off, IoCounters& counters) const {
  if (nodes_.shape().levels() == 0) {
    return;
  }
  BestFirst(*this, filter, visitor, cut_off, counters).run();
  nodes_.require_undamaged();
  nodes_.settle(counters);
}

/// Calls `take` for each entry that passes the test.
template <class Test, class Take>
void PackedRTree::visit(const NodePlace& at, const Test& test, IoCounters& counters,
                        const Take& take) const {
  layout::IndexNode scratch;  // stays untouched when nodes are mapped
  const layout::IndexNode& node = nodes_.node(at.level, at.number, at.checksum, scratch);
  ++counters.index_nodes;
  counters.bytes_read += layout::kNodeBytes;
  const std::uint32_t entries = node.entries;  // verified
  const std::uint64_t first = nodes_.shape().first_child(at.level, at.number);
  for (std::uint32_t i = 0; i < entries; ++i) {
    const layout::NodeEntry& entry = node.entry[i];
    if (test(entry)) {
      take(first + i, entry);
    }
  }
}

}  // namespace ptin
