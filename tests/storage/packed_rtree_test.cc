// SPDX-License-Identifier: GPL-3.0-or-later
#include "storage/packed_rtree.h"

#include <limits>
#include <memory>
#include <vector>

#include <gtest/gtest.h>
#include <rapidcheck.h>
#include <rapidcheck/gtest.h>

#include "engine/error.h"
#include "storage/index_shape.h"
#include "storage/page_slots.h"
#include "storage/sample_heights.h"
#include "storage/spatialindex_rtree.h"
#include "tests/storage/store_fixture.h"

namespace ptin::test {
namespace {

// One store for all cases of a process: more than one leaf, voids.
struct Shared {
  TestFolder folder;
  std::shared_ptr<const StoreFile> mapped, pread;
  std::unique_ptr<SpatialIndexRTree> second;

  explicit Shared(HeightType type) {
    RandomRecords options;
    options.segments = 8;
    options.records = 3000;
    options.type = type;
    write_store(folder.file("a.ptin"), random_content(options));
    mapped = StoreFile::open(folder.file("a.ptin"), PageAccess::kMapped);
    pread = StoreFile::open(folder.file("a.ptin"), PageAccess::kPread);
    second = SpatialIndexRTree::open(mapped);
  }
};

const Shared& shared(HeightType type) {
  static const Shared floats(HeightType::float32);
  static const Shared integers(HeightType::int32);
  return type == HeightType::float32 ? floats : integers;
}

std::vector<PageId> brute_force(const StoreFile& store, const AttributePredicate& predicate) {
  std::vector<PageId> pages;
  for (std::uint64_t i = 0; i < store.pages().page_count(); ++i) {
    if (predicate.holds(store.page_info(PageId{i}).attributes)) {
      pages.push_back(PageId{i});
    }
  }
  return pages;
}

std::vector<PageId> search(const RecordIndex& index, const AttributePredicate& predicate) {
  std::vector<PageId> pages;
  IoCounters counters;
  SampleHeights samples;
  index.search(predicate, pages, counters);
  return pages;
}

// Monotone: window, height, error and deviation, each of which may be left out.
FunctionPredicate any_predicate(const StoreFile& store) {
  const std::int32_t side = store.facts().bounds.max_x;
  const auto within = [&] { return *rc::gen::inRange(0, side + 1); };
  GridBox window = united(box_of({within(), within()}), GridPoint{within(), within()});
  if (*rc::gen::arbitrary<bool>()) {
    window = store.facts().bounds;
  }
  const bool asks_height = *rc::gen::arbitrary<bool>();
  const double height = *rc::gen::inRange(-100, 13000);
  const bool asks_error = *rc::gen::arbitrary<bool>();
  const bool asks_deviation = *rc::gen::arbitrary<bool>();
  const double error =
      *rc::gen::element(0.0, 0.1, 1.0, 30.0, 250.0, 1e30, std::numeric_limits<double>::infinity());
  return FunctionPredicate([=](const Attributes& a) {
    return meets(a.roi, window) && (!asks_height || contains(a.heights, height)) &&
           (!asks_error || a.error > error) && (!asks_deviation || a.deviation > error);
  });
}

RC_GTEST_PROP(PackedRTree, FindsThePagesThatBruteForceFinds, ()) {
  const Shared& s = shared(*rc::gen::element(HeightType::float32, HeightType::int32));
  const FunctionPredicate predicate = any_predicate(*s.mapped);
  const std::vector<PageId> expected = brute_force(*s.mapped, predicate);
  RC_ASSERT(search(s.mapped->index(), predicate) == expected);
  RC_ASSERT(search(s.pread->index(), predicate) == expected);
}

RC_GTEST_PROP(SpatialIndexRTree, FindsThePagesThatThePackedRTreeFinds, ()) {
  const Shared& s = shared(*rc::gen::element(HeightType::float32, HeightType::int32));
  const FunctionPredicate predicate = any_predicate(*s.mapped);
  RC_ASSERT(search(*s.second, predicate) == search(s.mapped->index(), predicate));
}

RC_GTEST_PROP(PackedRTree, MissesNoRecord, ()) {
  const Shared& s = shared(HeightType::float32);
  const FunctionPredicate predicate = any_predicate(*s.mapped);
  std::vector<VertexSplit> found;
  IoCounters counters;
  SampleHeights samples;
  for (const PageId id : search(s.mapped->index(), predicate)) {
    s.mapped->read_matching(id, predicate, found, samples, counters);
  }
  std::size_t expected = 0;
  for (const VertexSplit& r : read_all(*s.mapped)) {
    expected += predicate.holds(attributes_of(r, s.mapped->facts().heights)) ? 1 : 0;
  }
  RC_ASSERT(found.size() == expected);
}

TEST(PackedRTree, CountsWhatItReads) {
  const Shared& s = shared(HeightType::float32);
  const FunctionPredicate all([](const Attributes&) { return true; });
  const FunctionPredicate none([](const Attributes&) { return false; });
  std::vector<PageId> pages;
  IoCounters counters;
  SampleHeights samples;
  s.mapped->index().search(none, pages, counters);
  EXPECT_EQ(counters.index_nodes, 1U);
  EXPECT_TRUE(pages.empty());
  counters = {};
  s.mapped->index().search(all, pages, counters);
  EXPECT_EQ(counters.index_nodes, s.mapped->index_shape().total_nodes());
  EXPECT_EQ(counters.bytes_read, counters.index_nodes * 4096);
  EXPECT_EQ(pages.size(), s.mapped->pages().page_count());
}

TEST(SpatialIndexRTree, IsBuiltOnceAndAgainForAnotherStore) {
  const TestFolder folder;
  const std::string path = folder.file("a.ptin");
  write_store(path, random_content({.seed = 1}));
  const auto first = StoreFile::open(path);
  EXPECT_TRUE(SpatialIndexRTree::open(first)->was_built());
  EXPECT_FALSE(SpatialIndexRTree::open(first)->was_built());
  EXPECT_FALSE(SpatialIndexRTree::open(first)->was_built()) << "as whole as before it was opened";
  write_store(path, random_content({.seed = 2}), {.overwrite = true});
  const auto second = StoreFile::open(path);
  EXPECT_TRUE(SpatialIndexRTree::open(second)->was_built());
  EXPECT_EQ(folder.names(),
            (std::vector<std::string>{"a.ptin", "a.ptin.sidx.dat", "a.ptin.sidx.idx"}));
}

TEST(SpatialIndexRTree, AnswersForAStoreWithoutPages) {
  const TestFolder folder;
  write_store(folder.file("a.ptin"), flat_square(10));
  const auto store = StoreFile::open(folder.file("a.ptin"));
  const FunctionPredicate all([](const Attributes&) { return true; });
  EXPECT_TRUE(search(store->index(), all).empty());
  EXPECT_TRUE(search(*SpatialIndexRTree::open(store), all).empty());
}

// A flipped bit anywhere: the same pages, from what is whole or built again, or an Error. Without
// checksums libspatialindex crashes on some of them.
TEST(SpatialIndexRTree, AnswersNothingFromDamagedFiles) {
  const TestFolder folder;
  const std::string path = folder.file("a.ptin");
  write_store(path, random_content({.segments = 4, .records = 4000}));
  const auto store = StoreFile::open(path);
  const FunctionPredicate all([](const Attributes&) { return true; });
  const std::vector<PageId> expected = search(*SpatialIndexRTree::open(store), all);
  const Bytes dat = read_file(path + ".sidx.dat"), idx = read_file(path + ".sidx.idx");
  int refused = 0;
  const auto try_with = [&](Bytes damaged_dat, Bytes damaged_idx, std::size_t at) {
    write_file(path + ".sidx.dat", damaged_dat);
    write_file(path + ".sidx.idx", damaged_idx);
    try {
      EXPECT_EQ(search(*SpatialIndexRTree::open(store), all), expected) << at;
    } catch (const Error& e) {
      EXPECT_EQ(e.code(), ErrorCode::corruption) << at;
      ++refused;
    }
  };
  const auto flipped = [](Bytes bytes, std::size_t at) {
    bytes[at] ^= static_cast<Bytes::value_type>(16);
    return bytes;
  };
  for (std::size_t at = 0; at < dat.size(); at += 1 + dat.size() / 150)
    try_with(flipped(dat, at), idx, at);
  for (std::size_t at = 0; at < idx.size(); at += 1 + idx.size() / 150)
    try_with(dat, flipped(idx, at), at);
  EXPECT_GT(refused, 10);
}

TEST(SpatialIndexRTree, SaysWhichFolderIsMissing) {
  const TestFolder folder;
  write_store(folder.file("a.ptin"), random_content({}));
  const auto store = StoreFile::open(folder.file("a.ptin"));
  try {
    SpatialIndexRTree::open(store, {.base = folder.file("no/such/base")});
    FAIL();
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ErrorCode::not_found);
  }
}

// --- Places ---

TEST(IndexShape, HoldsCountsBeyond32Bits) {
  const std::uint64_t pages = std::uint64_t{1} << 52;
  const IndexShape shape(pages);
  EXPECT_EQ(shape.levels(), 9U);
  EXPECT_EQ(shape.nodes(shape.levels() - 1), 1U);
  EXPECT_EQ(shape.nodes(0), (pages + 55) / 56);
  EXPECT_EQ(shape.entries(0, shape.nodes(0) - 1), pages - (shape.nodes(0) - 1) * 56);
  std::uint64_t expected = 0;
  for (std::uint32_t level = shape.levels(); level-- > 0;) {
    EXPECT_EQ(shape.position(level, 0), expected);
    expected += shape.nodes(level);
  }
  EXPECT_EQ(shape.total_nodes(), expected);
}

RC_GTEST_PROP(IndexShape, EveryChildHasOneParentEntry, ()) {
  const auto pages = *rc::gen::inRange<std::uint64_t>(1, 2'000'000);
  const IndexShape shape(pages);
  for (std::uint32_t level = 0; level < shape.levels(); ++level) {
    const std::uint64_t last = shape.nodes(level) - 1;
    RC_ASSERT(shape.entries(level, last) >= 1U);
    RC_ASSERT(last * layout::kFanOut + shape.entries(level, last) == shape.children(level));
  }
}

RC_GTEST_PROP(IndexShape, EachPageOfSomeSegmentsHasOneEntryAndOneName, ()) {
  const auto segments = *rc::gen::nonEmpty(
      rc::gen::container<std::vector<std::uint64_t>>(rc::gen::inRange<std::uint64_t>(1, 300)));
  const IndexShape shape(segments);
  std::uint64_t page = 0;
  std::uint64_t leaf = 0;
  for (std::size_t s = 0; s < segments.size(); ++s) {
    for (std::uint64_t k = 0; k < segments[s]; ++k, ++page) {
      leaf += k > 0 && k % layout::kFanOut == 0 ? 1 : 0;
      const auto [found, entry] = shape.leaf_entry(page);
      RC_ASSERT(found == leaf);
      RC_ASSERT(shape.first_child(0, leaf) + entry == page);
      RC_ASSERT(entry < shape.entries(0, leaf));
      RC_ASSERT(shape.name_of(0, leaf) == (std::uint64_t{s} << 32 | k / layout::kFanOut));
      RC_ASSERT(shape.page_name(page) == (s << 16 | k));
      RC_ASSERT(shape.page_named(shape.page_name(page)) == page);
    }
    RC_ASSERT(shape.page_named(static_cast<std::uint32_t>(s << 16 | segments[s])) == std::nullopt);
    ++leaf;
  }
  RC_ASSERT(shape.pages() == page);
  RC_ASSERT(shape.nodes(0) == leaf);
  RC_ASSERT(shape.page_named(static_cast<std::uint32_t>(segments.size() << 16)) == std::nullopt);
}

TEST(PageSlots, PutEachPageIntoOneSlotBeyond32Bits) {
  const std::uint64_t pages = (std::uint64_t{1} << 40) + 3;
  const PageSlots slots{pages, 1000, 4096000, 4096};
  EXPECT_EQ(slots.slot_of(PageId{1000}), 0U);
  EXPECT_EQ(slots.slot_of(PageId{pages - 1}), pages - 1001);
  EXPECT_EQ(slots.slot_of(PageId{0}), pages - 1000);
  EXPECT_EQ(slots.slot_of(PageId{999}), pages - 1);
  EXPECT_EQ(slots.offset_of(PageId{999}), 4096000 + (pages - 1) * 4096);
}

}  // namespace
}  // namespace ptin::test
