// SPDX-License-Identifier: GPL-3.0-or-later
//
// The two indexes over the record pages of one store, warm: the packed R-tree, and
// libspatialindex's bulk-loaded disk R-tree; brute force over the pages' attributes in memory is
// the rival of both. The store is PTIN_BENCH_STORE or is built from srtm1_bigtujunga; without
// either, all is skipped.
//   BM_Load/index:packed         pages' attributes -> IndexWriter -> nodes in a file, not synced;
//                                pages a second
//   BM_Load/index:spatialindex   the same attributes -> libspatialindex's bulk loader -> its two
//                                files; pages a second
//   BM_Search/index:i/query:q    predicate -> page ids; counters: pages found, nodes examined,
//                                pages found a second
//     window_ppm:n is one window of n millionths of the area; point is a window without area;
//     error_5 the whole terrain at 5 units of height; both is the window of 1/25 at that error.
//     64 seeded places, one after the other.
// libspatialindex keeps its nodes in an LRU buffer of its own and takes a lock; boxes of its nodes
// are doubles of four dimensions. Cannot show: cold nodes (ptin bench), several threads, trees higher
// than two or three levels.
#include <memory>
#include <string>
#include <vector>

#include <benchmark/benchmark.h>

#include "bench/support/opened_store.h"
#include "engine/query/select/predicate.h"
#include "storage/index_writer.h"
#include "storage/short_float.h"
#include "storage/spatialindex_rtree.h"

namespace {

using namespace ptin;
using namespace ptin::bench;

/// The attributes of the pages of store(), and the second index over them; made on first use.
struct Indexed {
  std::vector<StoreFile::PageInfo> pages;
  ScratchFolder folder;
  std::unique_ptr<SpatialIndexRTree> rival;

  Indexed() {
    for (std::uint64_t i = 0; i < store()->pages().page_count(); ++i) {
      pages.push_back(store()->page_info(PageId{i}));
    }
    rival = SpatialIndexRTree::open(store(), {.base = folder.file("search")});
  }
};

const Indexed& indexed() {
  static const Indexed it;
  return it;
}

/// 64 seeded predicates of one kind.
std::vector<PredicatePtr> predicates(const std::string& query) {
  const double area_ppm = query == "window_ppm:1000" ? 1000 : query == "point" ? 0 : 40000;
  std::vector<PredicatePtr> result;
  for (const Window& place : random_windows(facts(), 64, area_ppm, 1)) {
    const PredicatePtr window = meets_region(place, facts().map);
    result.push_back(query == "error_5" ? error_above(5)
                     : query == "both"  ? all_of({window, error_above(5)})
                                        : window);
  }
  return result;
}

class BruteForce final : public RecordIndex {
 public:
  explicit BruteForce(const std::vector<StoreFile::PageInfo>& pages) : pages_(pages) {}
  void search(const AttributePredicate& predicate, std::vector<PageId>& pages,
              IoCounters&) const override {
    for (std::size_t i = 0; i < pages_.size(); ++i) {
      if (predicate.holds(pages_[i].attributes)) pages.push_back(PageId{i});
    }
  }

 private:
  const std::vector<StoreFile::PageInfo>& pages_;
};

void BM_Search(benchmark::State& state, const std::string& index, const std::string& query) {
  if (skipped(state)) return;
  const Indexed& it = indexed();
  const BruteForce brute(it.pages);
  const RecordIndex& searched = index == "packed"        ? store()->index()
                                : index == "brute_force" ? static_cast<const RecordIndex&>(brute)
                                                         : *it.rival;
  const std::vector<PredicatePtr> asked = predicates(query);
  std::size_t found = 0;
  IoCounters counters;
  std::vector<PageId> pages;
  for (auto _ : state) {
    found = 0;
    counters = {};
    for (const PredicatePtr& p : asked) {
      pages.clear();
      searched.search(*p, pages, counters);
      found += pages.size();
    }
  }
  add_mean(state, "pages", found, asked.size());
  add_mean(state, "nodes", counters.index_nodes, asked.size());
  add_rate(state, "searches/s", asked.size());
  add_rate(state, "pages/s", found);
}

/// What an index entry says of a page.
layout::NodeEntry entry_of(const StoreFile::PageInfo& p, const HeightEncoding& heights) {
  const GridBox& b = p.attributes.roi;
  const GridBox& star = p.stars.box;
  layout::NodeEntry e{};
  e.min_x = b.min_x, e.min_y = b.min_y, e.max_x = b.max_x, e.max_y = b.max_y;
  e.star_min_x = star.min_x, e.star_min_y = star.min_y;
  e.star_max_x = star.max_x, e.star_max_y = star.max_y;
  e.height_lo = heights.bits(p.attributes.heights.lo);
  e.height_hi = heights.bits(p.attributes.heights.hi);
  e.star_height_lo = heights.bits(p.stars.heights.lo);
  e.star_height_hi = heights.bits(p.stars.heights.hi);
  e.error_max = short_bits(static_cast<float>(p.attributes.error));
  e.error_min = short_bits(static_cast<float>(p.min_error));
  e.deviation_max = short_bits(static_cast<float>(p.attributes.deviation));
  e.death_min = death_bits(static_cast<float>(p.stars.death));
  e.records = p.records;
  return e;
}

void BM_Load(benchmark::State& state, const std::string& index) {
  if (skipped(state)) return;
  const Indexed& it = indexed();
  const HeightEncoding heights = facts().heights;
  static int built = 0;  // of all repetitions: what is there is opened, not built
  for (auto _ : state) {
    if (index == "packed") {
      IndexWriter writer(FileLayer::system(), it.folder.file(""), "load", heights);
      for (const StoreFile::PageInfo& p : it.pages) writer.add(entry_of(p, heights));
      ScratchFile out(FileLayer::system(), it.folder.file(""), "load_out", true);
      benchmark::DoNotOptimize(writer.write_to(out, 0));
    } else {
      const auto tree = SpatialIndexRTree::open(
          store(), {.base = it.folder.file("load" + std::to_string(built++))});
      benchmark::DoNotOptimize(tree->was_built());
    }
  }
  state.counters["pages"] = double(it.pages.size());
  add_rate(state, "pages/s", it.pages.size());
}

[[maybe_unused]] const bool registered = [] {
  for (const char* index : {"packed", "spatialindex"}) {
    benchmark::RegisterBenchmark((std::string("BM_Load/index:") + index).c_str(), BM_Load,
                                 std::string(index))
        ->Unit(benchmark::kMillisecond);
  }
  for (const char* query : {"point", "window_ppm:1000", "window_ppm:40000", "error_5", "both"}) {
    for (const char* index : {"packed", "spatialindex", "brute_force"}) {
      const std::string title = std::string("BM_Search/index:") + index + "/query:" + query;
      benchmark::RegisterBenchmark(title.c_str(), BM_Search, std::string(index), std::string(query))
          ->Unit(benchmark::kMicrosecond);
    }
  }
  return true;
}();

}  // namespace
