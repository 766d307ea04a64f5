// SPDX-License-Identifier: GPL-3.0-or-later
//
// Many queries at once on one store: run under the thread sanitizer too.
#include <atomic>
#include <thread>

#include <gtest/gtest.h>

#include "engine/error.h"
#include "storage/file/sigbus_guard.h"
#include "storage/spatialindex_rtree.h"
#include "storage/store_file.h"
#include "tests/storage/store_fixture.h"

namespace ptin::test {
namespace {

constexpr int kThreads = 8;

void run(const std::function<void(int)>& work) {
  std::vector<std::thread> threads;
  for (int t = 0; t < kThreads; ++t) {
    threads.emplace_back(work, t);
  }
  for (std::thread& t : threads) {
    t.join();
  }
}

TEST(StoreFileConcurrency, GivesEveryThreadTheSameAnswers) {
  const TestFolder folder;
  write_store(folder.file("a"), random_content({.segments = 3, .records = 5000}));
  for (const PageAccess access : {PageAccess::kMapped, PageAccess::kPread}) {
    const auto reference = StoreFile::open(folder.file("a"));
    const std::vector<VertexSplit> expected = read_all(*reference);
    const auto store = StoreFile::open(folder.file("a"), access);
    const auto second = SpatialIndexRTree::open(store);
    std::atomic<int> failures{0};
    run([&](int t) {
      const GridBox window{0, 0, 1 << (14 + t % 7), 1 << 20};
      const FunctionPredicate predicate([&](const Attributes& a) { return meets(a.roi, window); });
      std::vector<PageId> pages, pages2;
      IoCounters counters;
      store->index().search(predicate, pages, counters);
      second->search(predicate, pages2, counters);
      store->pages().announce(pages, counters);
      store->pages().check_unchanged();
      if (pages != pages2 || read_all(*store) != expected) {
        ++failures;
      }
    });
    EXPECT_EQ(failures, 0);
  }
}

TEST(StoreFileConcurrency, EveryThreadSeesThatTheFileWasCutShort) {
  install_sigbus_guard();
  const TestFolder folder;
  write_store(folder.file("a"), random_content({.segments = 3, .records = 5000}));
  const auto store = StoreFile::open(folder.file("a"));
  static_cast<void>(read_all(*store));
  std::filesystem::resize_file(folder.file("a"), store->file_bytes() / 2);
  std::atomic<int> refused{0};
  run([&](int) {
    try {
      static_cast<void>(read_all(*store));
    } catch (const Error& e) {
      refused += e.code() == ErrorCode::corruption ? 1 : 0;
    }
  });
  EXPECT_EQ(refused, kThreads);
}

TEST(StoreFileConcurrency, StoresOpenAndCloseBesideEachOther) {
  const TestFolder folder;
  write_store(folder.file("a"), random_content({.segments = 1, .records = 500}));
  install_sigbus_guard();
  std::atomic<std::size_t> records{0};
  run([&](int) {
    for (int i = 0; i < 20; ++i) {
      records += read_all(*StoreFile::open(folder.file("a"))).size();
    }
  });
  EXPECT_EQ(records, std::size_t{500} * 20 * kThreads);
}

}  // namespace
}  // namespace ptin::test
