// SPDX-License-Identifier: GPL-3.0-or-later
//
// The page stores, and what happens when the file changes under them.
#include "storage/page_store.h"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <optional>
#include <span>
#include <utility>

#include <gtest/gtest.h>
#include <signal.h>
#include <sys/mman.h>

#include "storage/file/sigbus_guard.h"
#include "storage/index_shape.h"
#include "storage/layout.h"
#include "storage/sample_heights.h"
#include "tests/storage/failing_files.h"

namespace ptin::test {
namespace {

namespace fs = std::filesystem;

class PageStoreTest : public testing::TestWithParam<PageAccess> {
 protected:
  PageStoreTest() { write_store(path_, random_content({.segments = 3, .records = 5000})); }

  [[nodiscard]] std::shared_ptr<const StoreFile> open() const {
    return StoreFile::open(path_, GetParam());
  }

  std::optional<ErrorCode> read_everything(const StoreFile& store) {
    return code_of([&] { static_cast<void>(read_all(store)); });
  }
  void flip_byte(std::uint64_t at) {
    Bytes bytes = read_file(path_);
    bytes[at] ^= std::byte{1};
    write_file(path_, bytes);
  }
  [[nodiscard]] std::uint64_t section(layout::SectionKind kind) const {
    return section_of(read_file(path_), kind).offset;
  }

  TestFolder folder_;
  std::string path_ = folder_.file("a.ptin");
};
INSTANTIATE_TEST_SUITE_P(Access, PageStoreTest,
                         testing::Values(PageAccess::kMapped, PageAccess::kPread),
                         [](const auto& access) {
                           return access.param == PageAccess::kMapped ? "Mapped" : "Pread";
                         });

TEST_P(PageStoreTest, ReadsPagesAndCountsThem) {
  const auto store = open();
  std::vector<std::byte> page(store->pages().page_bytes());
  IoCounters counters;
  SampleHeights samples;
  store->pages().read(PageId{5}, page, counters);
  store->pages().read(PageId{5}, page, counters);
  EXPECT_EQ(counters.pages, 2U);
  EXPECT_EQ(counters.bytes_read, 2U * 4096);
  EXPECT_EQ(counters.pages_verified, GetParam() == PageAccess::kMapped ? 1U : 2U);
}

TEST_P(PageStoreTest, RefusesPagesThatAreNotThere) {
  const auto store = open();
  std::vector<std::byte> page(4096);
  std::vector<VertexSplit> records;
  IoCounters counters;
  SampleHeights samples;
  for (const std::uint64_t id : {store->pages().page_count(), std::uint64_t{1} << 32, UINT64_MAX}) {
    EXPECT_EQ(code_of([&] { store->pages().read(PageId{id}, page, counters); }),
              ErrorCode::corruption);
    EXPECT_EQ(code_of([&] { static_cast<void>(store->page_info(PageId{id})); }),
              ErrorCode::corruption);
    EXPECT_EQ(code_of([&] { store->read_records(PageId{id}, records, samples, counters); }),
              ErrorCode::corruption);
    const std::vector<PageId> ids{PageId{id}};
    store->pages().announce(ids, counters);
  }
  EXPECT_EQ(counters.ranges_announced, 0U);
  EXPECT_TRUE(records.empty());
}

TEST_P(PageStoreTest, NamesAPageThatDoesNotMatchItsChecksum) {
  const auto pages = section(layout::SectionKind::kPages);
  flip_byte(pages + 4096 * 20 + 17);
  const auto store = open();
  try {
    static_cast<void>(read_all(*store));
    FAIL();
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ErrorCode::corruption);
    EXPECT_NE(e.context().find(path_ + ", page "), std::string::npos) << e.what();
  }
}

TEST_P(PageStoreTest, NamesANodeThatDoesNotMatchItsChecksum) {
  flip_byte(section(layout::SectionKind::kIndex) + 4096 + 30);
  const auto store = open();
  std::vector<PageId> ids;
  IoCounters counters;
  SampleHeights samples;
  const FunctionPredicate all([](const Attributes&) { return true; });
  try {
    store->index().search(all, ids, counters);
    FAIL();
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ErrorCode::corruption);
    EXPECT_NE(e.context().find("index level 0, node 0"), std::string::npos) << e.what();
  }
  EXPECT_EQ(code_of([&] { static_cast<void>(store->page_info(PageId{3})); }),
            ErrorCode::corruption);
  EXPECT_EQ(code_of([&] { static_cast<void>(store->page_info(PageId{90})); }), std::nullopt);
}

TEST_P(PageStoreTest, AnnouncesTheNodesOfALevelBeforeTheyAreReadForTheFirstTime) {
  const auto store = open();
  const FunctionPredicate all([](const Attributes&) { return true; });
  for (const std::uint64_t expected : {1U, 0U}) {  // the leaves, one beside the other
    std::vector<PageId> ids;
    IoCounters counters;
    SampleHeights samples;
    store->index().search(all, ids, counters);
    EXPECT_EQ(counters.index_nodes, IndexShape(ids.size()).total_nodes());
    EXPECT_EQ(counters.ranges_announced, expected);
    EXPECT_EQ(ids.size(), store->pages().page_count());
    EXPECT_TRUE(std::is_sorted(ids.begin(), ids.end()));
  }
}

TEST_P(PageStoreTest, AnnouncesNearPagesAsOneRange) {
  const auto store = open();
  const auto ranges = [&](const std::vector<std::uint64_t>& numbers) {
    std::vector<PageId> ids;
    for (const std::uint64_t n : numbers) {
      ids.push_back(PageId{n});
    }
    IoCounters counters;
    SampleHeights samples;
    store->pages().announce(ids, counters);
    return counters.ranges_announced;
  };
  EXPECT_EQ(ranges({}), 0U);
  EXPECT_EQ(ranges({50}), 1U);
  EXPECT_EQ(ranges({50, 51, 52, 53}), 1U);
  EXPECT_EQ(ranges({50, 51, 53, 54}), 1U) << "one page of waste for four";
  EXPECT_EQ(ranges({50, 200}), 2U);
  EXPECT_EQ(ranges({50, 60, 70, 80}), 4U) << "would be mostly waste";
}

/// Notes what it is told, and starts nothing.
class NotingAnnouncer final : public Announcer {
 public:
  void announce(int, std::uint64_t offset, std::uint64_t bytes) noexcept override {
    told.emplace_back(offset, bytes);
  }
  std::vector<std::pair<std::uint64_t, std::uint64_t>> told;
};

TEST_P(PageStoreTest, TellsAnAnnouncerWhatIsReadNext) {
  const auto announcer = std::make_shared<NotingAnnouncer>();
  const auto store = StoreFile::open(path_, GetParam(), announcer);
  ASSERT_EQ(announcer->told.size(), 1U);
  EXPECT_EQ(announcer->told.back(), std::pair(std::uint64_t{0}, std::uint64_t{16} << 10))
      << "the front";
  announcer->told.clear();
  const FunctionPredicate all([](const Attributes&) { return true; });
  std::vector<PageId> ids;
  IoCounters counters;
  SampleHeights samples;
  store->index().search(all, ids, counters);
  const std::uint64_t leaves = IndexShape(ids.size()).nodes(0);
  const std::uint64_t index = section(layout::SectionKind::kIndex);
  EXPECT_EQ(announcer->told.back(),
            std::pair(index + layout::kNodeBytes, leaves * layout::kNodeBytes));
  const std::size_t before = announcer->told.size();
  store->pages().announce(ids, counters);
  std::uint64_t bytes = 0;
  for (const auto& [offset, length] : std::span(announcer->told).subspan(before)) {
    EXPECT_GE(offset, section(layout::SectionKind::kPages));
    bytes += length;
  }
  EXPECT_EQ(bytes, ids.size() * 4096);
  EXPECT_EQ(announcer->told.size(), counters.ranges_announced);
  EXPECT_EQ(read_everything(*store), std::nullopt);
}

TEST_P(PageStoreTest, NoticesThatTheFileWasReplaced) {
  const auto store = open();
  EXPECT_EQ(code_of([&] { store->pages().check_unchanged(); }), std::nullopt);
  write_store(path_, random_content({.seed = 9}), {.overwrite = true});
  EXPECT_EQ(code_of([&] { store->pages().check_unchanged(); }), ErrorCode::corruption);
  EXPECT_EQ(code_of([&] { open()->pages().check_unchanged(); }), std::nullopt);
}

TEST_P(PageStoreTest, NoticesThatTheFileWasWrittenTo) {
  const auto store = open();
  std::fstream file(path_, std::ios::binary | std::ios::in | std::ios::out);
  file.seekp(100);
  file.put('x');
  file.flush();
  EXPECT_EQ(code_of([&] { store->pages().check_unchanged(); }), ErrorCode::corruption);
}

TEST_P(PageStoreTest, SurvivesAFileThatIsCutShort) {
  install_sigbus_guard();
  const auto other = folder_.file("other.ptin");
  write_store(other, random_content({.seed = 5, .segments = 1, .records = 100}));
  const auto untouched = StoreFile::open(other, GetParam());
  const auto store = open();
  EXPECT_EQ(read_everything(*store), std::nullopt) << "all pages are verified once";
  fs::resize_file(path_, section(layout::SectionKind::kPages) + 4096 * 3 + 100);
  EXPECT_EQ(read_everything(*store), ErrorCode::corruption);
  EXPECT_EQ(code_of([&] { store->pages().check_unchanged(); }), ErrorCode::corruption);
  // Not only because zeros are no records: a page that was verified before is not served either.
  std::vector<std::byte> page(4096);
  IoCounters counters;
  SampleHeights samples;
  EXPECT_EQ(code_of([&] { store->pages().read(PageId{70}, page, counters); }),
            ErrorCode::corruption);
  EXPECT_EQ(read_everything(*untouched), std::nullopt)
      << "only the store that lost its file is marked";
}

TEST_P(PageStoreTest, SurvivesAFileThatIsCutShortInsideOfTheIndex) {
  install_sigbus_guard();
  const auto store = open();
  const FunctionPredicate all([](const Attributes&) { return true; });
  std::vector<PageId> ids;
  IoCounters counters;
  SampleHeights samples;
  store->index().search(all, ids, counters);
  fs::resize_file(path_, section(layout::SectionKind::kIndex));
  const auto code = code_of([&] {
    store->index().search(all, ids, counters);
    store->pages().check_unchanged();
  });
  EXPECT_EQ(code, ErrorCode::corruption);
}

TEST(SigbusGuard, HandsOtherFaultsToTheHandlerBefore) {
  const TestFolder folder;
  write_file(folder.file("hole"), Bytes(4096));
  EXPECT_EXIT(
      {
        struct sigaction action {};
        action.sa_handler = [](int) { ::_exit(42); };
        ::sigaction(SIGBUS, &action, nullptr);
        install_sigbus_guard();
        std::FILE* file = std::fopen(folder.file("hole").c_str(), "r+");
        auto* byte = static_cast<volatile char*>(
            ::mmap(nullptr, 8192, PROT_READ, MAP_SHARED, ::fileno(file), 0));
        std::exit(byte[4096]);
      },
      testing::ExitedWithCode(42), "");
}

TEST(SigbusGuard, MarksTheMappingThatHasTheHole) {
  install_sigbus_guard();
  const TestFolder folder;
  write_file(folder.file("hole"), Bytes(8192, std::byte{7}));
  std::FILE* file = std::fopen(folder.file("hole").c_str(), "r");
  const auto map = [&] {
    return static_cast<volatile char*>(
        ::mmap(nullptr, 8192, PROT_READ, MAP_SHARED, ::fileno(file), 0));
  };
  volatile char* a = map();
  volatile char* b = map();
  {
    const GuardedMapping guard_a(const_cast<char*>(a), 8192);
    const GuardedMapping guard_b(const_cast<char*>(b), 8192);
    fs::resize_file(folder.file("hole"), 4096);
    EXPECT_EQ(b[0], 7);
    EXPECT_FALSE(guard_b.is_damaged());
    EXPECT_EQ(b[5000], 0);
    EXPECT_TRUE(guard_b.is_damaged());
    EXPECT_FALSE(guard_a.is_damaged());
  }
  const GuardedMapping again(const_cast<char*>(a), 8192);
  EXPECT_FALSE(again.is_damaged()) << "a place in the list is used again, without its mark";
  ::munmap(const_cast<char*>(a), 8192);
  ::munmap(const_cast<char*>(b), 8192);
  std::fclose(file);
}

}  // namespace
}  // namespace ptin::test
