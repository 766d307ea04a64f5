// SPDX-License-Identifier: GPL-3.0-or-later
#include "storage/store_writer.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <functional>
#include <numeric>
#include <optional>
#include <random>
#include <set>
#include <tuple>

#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include "engine/geometry/hilbert.h"
#include "storage/layout.h"
#include "storage/packed_segment.h"
#include "storage/page_packer.h"
#include "storage/record_order.h"
#include "storage/short_float.h"
#include "storage/verify.h"
#include "tests/storage/failing_files.h"
#include "tests/storage/store_fixture.h"
#include "tests/support/test_folder.h"

namespace ptin::test {
namespace {

TEST(StoreWriter, GivesTheSameBytesForTheSameRecordsInAnyOrderInsideOfASegment) {
  const TestFolder folder;
  StoreContent content = random_content({.segments = 3, .records = 5000});
  write_store(folder.file("a"), content);
  for (StarredRecords& segment : content.segments) {
    std::vector<std::uint32_t> order(segment.size());
    std::iota(order.rbegin(), order.rend(), 0U);
    segment = in_order(segment, order);
  }
  write_store(folder.file("b"), content);
  EXPECT_EQ(read_file(folder.file("a")), read_file(folder.file("b")));
}

TEST(StoreWriter, PutsRecordsInTheOrderOfTheirSegmentAndStartsEachOnAPageOfItsOwn) {
  const TestFolder folder;
  const StoreContent content = random_content({.segments = 3, .records = 1000});
  write_store(folder.file("a"), content);
  const auto store = StoreFile::open(folder.file("a"));
  StarredRecords ordered;
  for (const StarredRecords& segment : content.segments) {
    append(ordered, in_order(segment, order_of_segment(segment)));
  }
  // Within a page errors descend.
  StarredRecords expected;
  std::size_t begin = 0;
  std::set<std::size_t> begins;
  for (std::uint64_t page = 0; page < store->pages().page_count(); ++page) {
    begins.insert(begin);
    std::vector<std::uint32_t> of_page(store->page_info(PageId{page}).records);
    std::iota(of_page.begin(), of_page.end(), static_cast<std::uint32_t>(begin));
    append(expected, as_on_page(in_order(ordered, of_page), content.facts.heights.type));
    begin += of_page.size();
  }
  EXPECT_TRUE(are_same(read_all_starred(*store), expected));
  EXPECT_TRUE(begins.contains(1000) && begins.contains(2000));
}

// Stars about their vertex, small for most records and large for few, as errors are: a terrain's.
StarredRecords terrain_like(std::size_t count) {
  std::mt19937_64 random(7);
  const GridBox square{0, 0, 4096, 4096};
  const HeightEncoding metres{HeightType::int32, 1.0, 0.0};
  StarredRecords records;
  std::set<VertexKey> seen;
  while (records.size() < count) {
    const double size = 1.0 / (1e-3 + std::uniform_real_distribution(0.0, 1.0)(random));
    VertexSplit r;
    r.u = {static_cast<std::int32_t>(1 + random() % 4095),
           static_cast<std::int32_t>(1 + random() % 4095)};
    if (!seen.insert(key_of(r.u)).second) {
      continue;
    }
    r.error = shortened(
        static_cast<float>(size * std::exp2(std::uniform_real_distribution(-3.0, 3.0)(random))));
    r.deviation = r.error;
    r.height = static_cast<HeightBits>(random() % 1000);
    add_star(records, r, made_ring(r.u, square, 6, static_cast<std::int32_t>(4 * size), random),
             metres);
  }
  return records;
}

GridBox box_of_star(const StarredRecords& records, std::size_t i) {
  GridBox box = box_of(records.splits[i].u);
  for (const RingCorner& c : records.ring(i)) {
    box = united(box, c.position);
  }
  return box;
}

struct Cost {
  double point = 0, tolerance = 0;  // pages of a mean point, and of the mean of some tolerances
};

Cost cost_of(const StarredRecords& records) {
  constexpr std::size_t kPage = 160;
  Cost cost;
  for (std::size_t i = 0; i < records.size(); i += kPage) {
    GridBox box;
    float error = 0;
    for (std::size_t k = i; k < std::min(i + kPage, records.size()); ++k) {
      box = united(box, box_of_star(records, k));
      error = std::max(error, records.splits[k].error);
    }
    cost.point += static_cast<double>(box.max_x - box.min_x + 1) * (box.max_y - box.min_y + 1) /
                  (4096.0 * 4096.0);
    for (const float tolerance : {2.0F, 5.0F, 10.0F, 20.0F, 50.0F}) {
      cost.tolerance += error > tolerance ? 0.2 : 0.0;
    }
  }
  return cost;
}

StarredRecords sorted(const StarredRecords& records,
                      const std::function<bool(const VertexSplit&, const VertexSplit&)>& less) {
  std::vector<std::uint32_t> order(records.size());
  std::iota(order.begin(), order.end(), 0U);
  std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
    return less(records.splits[a], records.splits[b]);
  });
  return in_order(records, order);
}

// What it is for. Orders by one thing alone do one of both well; those it is held against are by
// error, and by octave of error and then in squares.
TEST(StoreWriter, OrdersRecordsSoThatPointsAndTolerancesReadFewPages) {
  const StarredRecords records = terrain_like(50'000);
  const Cost by_error = cost_of(sorted(
      records, [](const VertexSplit& a, const VertexSplit& b) { return a.error > b.error; }));
  const auto place = [](const VertexSplit& r) {
    const auto octave = static_cast<int>(layout::to_bits(r.error) >> 23);
    return std::tuple(-octave, hilbert_position(static_cast<std::uint32_t>(r.u.x),
                                                static_cast<std::uint32_t>(r.u.y)));
  };
  const Cost by_octave = cost_of(sorted(
      records, [&](const VertexSplit& a, const VertexSplit& b) { return place(a) < place(b); }));
  const Cost ours = cost_of(in_order(records, order_of_segment(records)));
  RecordProperty("point", std::to_string(ours.point) + " " + std::to_string(by_octave.point));
  EXPECT_LT(ours.point, 0.75 * by_octave.point);
  EXPECT_LT(ours.point, 0.1 * by_error.point);
  EXPECT_LT(ours.tolerance, 2.8 * by_error.tolerance);
  EXPECT_LT(ours.tolerance, 2.5 * by_octave.tolerance);
}

TEST(StoreWriter, FillsPagesOfEachSizeWithAsManyRecordsAsFit) {
  const TestFolder folder;
  for (const std::uint32_t page_bytes : {4096U, 8192U, 16384U, 65536U}) {
    for (const std::int32_t side : {30000, 1 << 29}) {
      const StoreContent content = random_content({.segments = 1, .records = 5000, .side = side});
      const HeightEncoding& heights = content.facts.heights;
      write_store(folder.file("a"), content, {.overwrite = true, .page_bytes = page_bytes});
      EXPECT_TRUE(verify_store(folder.file("a")).is_sound());
      const auto store = StoreFile::open(folder.file("a"));
      EXPECT_EQ(store->facts().page_bytes, page_bytes);
      // As they come to the packer: a page has them in another order.
      const StarredRecords& segment = content.segments[0];
      const StarredRecords all = in_order(segment, order_of_segment(segment));
      std::size_t i = 0;
      for (std::uint64_t page = 0; page < store->pages().page_count(); ++page) {
        PagePacker packer(page_bytes, heights, {});
        const std::size_t end = i + store->page_info(PageId{page}).records;
        for (; i < end; ++i) {
          ASSERT_TRUE(packer.add(all.splits[i], all.ring(i)));
        }
        EXPECT_TRUE(i == all.size() || !packer.add(all.splits[i], all.ring(i)));
      }
    }
  }
}

TEST(StoreWriter, TakesAtMost32BytesARecordOfSmallStars) {
  const TestFolder folder;
  StoreContent content = flat_square(4096, HeightType::int32);
  content.segments = {terrain_like(50'000)};
  write_store(folder.file("a"), content);
  EXPECT_LT(std::filesystem::file_size(folder.file("a")), 32U * 50'000U);
}

TEST(StoreWriter, RefusesAnExistingTargetAndKeepsIt) {
  const TestFolder folder;
  const std::string path = folder.file("a.ptin");
  write_file(path, Bytes(3));
  EXPECT_EQ(code_of([&] { StoreWriter::create(path, {}); }), ErrorCode::invalid_argument);
  EXPECT_EQ(read_file(path), Bytes(3));
  write_store(path, flat_square(10), {.overwrite = true});
  EXPECT_EQ(StoreFile::open(path)->record_count(), 0U);
}

TEST(StoreWriter, RefusesATargetThatAppearsWhileItWrites) {
  const TestFolder folder;
  const std::string path = folder.file("a.ptin");
  const StoreContent content = flat_square(10);
  auto writer = StoreWriter::create(path, {});
  write_file(path, Bytes(3));
  EXPECT_EQ(code_of([&] { writer->publish(content.facts, content.t0, content.metadata); }),
            ErrorCode::invalid_argument);
  writer.reset();
  EXPECT_EQ(read_file(path), Bytes(3));
  EXPECT_EQ(folder.names(), std::vector<std::string>{"a.ptin"});
}

TEST(StoreWriter, RefusesAFolderAsTargetAndAMissingFolder) {
  const TestFolder folder;
  EXPECT_EQ(code_of([&] { StoreWriter::create(folder.path(), {.overwrite = true}); }),
            ErrorCode::invalid_argument);
  EXPECT_EQ(code_of([&] { StoreWriter::create(folder.file("no/a.ptin"), {}); }),
            ErrorCode::not_found);
}

TEST(StoreWriter, SaysThatAFolderCannotBeWritten) {
  if (::geteuid() == 0) {
    GTEST_SKIP() << "permissions do not bind root";
  }
  const TestFolder folder;
  ::chmod(folder.path().c_str(), 0500);
  EXPECT_EQ(code_of([&] { StoreWriter::create(folder.file("a.ptin"), {}); }), ErrorCode::io_error);
  ::chmod(folder.path().c_str(), 0700);
}

TEST(StoreWriter, LeavesNothingWhenItIsNotPublished) {
  const TestFolder folder;
  {
    StoreContent content = random_content({});
    const auto writer = StoreWriter::create(folder.file("a.ptin"), {});
    writer->add_segment(pack_segment(content.segments[0], content.facts.heights, {}, 4096),
                        content.facts.heights);
    EXPECT_EQ(folder.names().size(), 1U);
  }
  EXPECT_TRUE(folder.names().empty());
}

TEST(StoreWriter, RefusesFactsAndPageSizesThatAReaderWouldRefuse) {
  const TestFolder folder;
  for (const std::uint32_t bytes : {0U, 2048U, 5000U, 131072U}) {
    StoreWriterOptions options;
    options.page_bytes = bytes;
    EXPECT_EQ(code_of([&] { StoreWriter::create(folder.file("a"), options); }),
              ErrorCode::invalid_argument);
  }
  StoreContent content = flat_square(10);
  content.facts.map.step_x = -1.0;
  EXPECT_EQ(code_of([&] { write_store(folder.file("a"), content); }), ErrorCode::invalid_argument);
  content = flat_square(10);
  content.t0.triangles[0].v[0] = 9;
  EXPECT_EQ(code_of([&] { write_store(folder.file("a"), content); }), ErrorCode::invalid_argument);
  content = random_content({.segments = 1, .records = 1});
  const auto writer = StoreWriter::create(folder.file("a"), {});
  const PackedSegment packed = pack_segment(content.segments[0], content.facts.heights, {}, 4096);
  writer->add_segment(packed, content.facts.heights);
  EXPECT_EQ(code_of([&] {
              writer->add_segment(packed, {HeightType::int32, 1.0, 0.0});
            }),
            ErrorCode::invalid_argument);
}

TEST(StoreWriter, TakesPagesThatCannotBeReadBackForAFaultOfTheProgram) {
  const TestFolder folder;
  const StoreContent content = random_content({.segments = 1, .records = 1});
  const auto code_after = [&](const std::function<void(PackedSegment&)>& ruin) {
    PackedSegment packed = pack_segment(content.segments[0], content.facts.heights, {}, 4096);
    ruin(packed);
    return code_of([&] {
      StoreWriter::create(folder.file("a"), {})->add_segment(packed, content.facts.heights);
    });
  };
  EXPECT_EQ(code_after([](auto&) {}), std::nullopt);
  EXPECT_EQ(code_after([](auto& p) { p.pages[0] = std::byte{2}; }), ErrorCode::internal);
  EXPECT_EQ(code_after([](auto& p) { p.descriptors[0].records = 2; }), ErrorCode::internal);
  EXPECT_EQ(code_after([](auto& p) { p.pages.resize(100); }), ErrorCode::internal);
  EXPECT_EQ(code_after([](auto& p) { p.pages[7] = std::byte{0xFF}; }), ErrorCode::internal)
      << "x beyond the grid";
  EXPECT_TRUE(folder.names().empty());
}

// --- Resuming ---

class StoreWriterResume : public testing::Test {
 protected:
  StoreWriterResume() { std::filesystem::create_directory(work_); }

  [[nodiscard]] std::unique_ptr<StoreWriter> writer(FileLayer& files) const {
    return StoreWriter::create(path_, {.files = &files, .work_folder = work_});
  }
  // All segments are on disk; the front of the file is over the first pages; it has no name yet.
  StoreCheckpoint publish_but_for_the_name() {
    PowerCutFiles files;
    files.renames = false;
    const auto first = writer(files);
    for (const StarredRecords& segment : content_.segments) {
      first->add_segment(pack_segment(segment, content_.facts.heights, {}, 4096),
                         content_.facts.heights);
    }
    first->sync();
    EXPECT_EQ(code_of([&] { publish(*first); }), ErrorCode::io_error);
    return first->position();
  }
  void publish(StoreWriter& writer) const {
    writer.publish(content_.facts, content_.t0, content_.metadata);
  }
  [[nodiscard]] Bytes written_in_one_go() const {
    write_store(folder_.file("b.ptin"), content_, {.overwrite = true});
    return read_file(folder_.file("b.ptin"));
  }

  TestFolder folder_{TestFolder::Size::kSmall};
  std::string path_ = folder_.file("a.ptin");
  std::string work_ = folder_.file("work");
  StoreContent content_ = random_content({.seed = 3, .segments = 2, .records = 700});
};

// The cut of the pages reaches the disk and that of the journal, which was made before it, does
// not: the journal's mark must not send the next one to copies that are gone.
TEST_F(StoreWriterResume, IsItselfResumedAfterAPowerCut) {
  const StoreCheckpoint checkpoint = publish_but_for_the_name();
  PowerCutFiles files;
  {
    const auto second = writer(files);
    second->resume(checkpoint, content_.facts.heights);
  }
  files.lose_cuts(work_ + "/descriptors");
  const auto third = writer(files);
  third->resume(checkpoint, content_.facts.heights);
  publish(*third);
  EXPECT_TRUE(read_file(path_) == written_in_one_go());
}

TEST_F(StoreWriterResume, KeepsWhereSegmentsEnd) {
  // Segments of so many pages have leaves of their own.
  content_ = random_content({.seed = 4, .segments = 3, .records = 12'000});
  const Bytes wanted = written_in_one_go();
  const SectionInfo segments = StoreFile::open(folder_.file("b.ptin"))->sections().at(2);
  ASSERT_EQ(segments.name, "segments");
  ASSERT_EQ(segments.bytes, 3 * sizeof(layout::SegmentEntry));
  for (const std::size_t kept : {1, 2}) {
    StoreCheckpoint checkpoint;
    const auto add = [&](StoreWriter& to, std::size_t from, std::size_t end) {
      for (std::size_t i = from; i < end; ++i) {
        to.add_segment(pack_segment(content_.segments[i], content_.facts.heights, {}, 4096),
                       content_.facts.heights);
      }
      to.sync();
      checkpoint = to.position();
    };
    add(*writer(FileLayer::system()), 0, kept);
    const auto second = writer(FileLayer::system());
    second->resume(checkpoint, content_.facts.heights);
    add(*second, kept, 3);
    publish(*second);
    EXPECT_TRUE(read_file(path_) == wanted) << kept;
    std::filesystem::remove(path_);
    std::filesystem::remove_all(work_);
    std::filesystem::create_directory(work_);
  }
}

TEST_F(StoreWriterResume, RefusesCountsThatAreNotThoseOfItsPages) {
  StoreCheckpoint checkpoint = publish_but_for_the_name();
  ++checkpoint.errors.front().records;
  EXPECT_EQ(
      code_of([&] { writer(FileLayer::system())->resume(checkpoint, content_.facts.heights); }),
      ErrorCode::corruption);
}

TEST_F(StoreWriterResume, GoesOnAfterEachCallThatCanFail) {
  const Bytes expected = written_in_one_go();
  bool failed = true;
  int nth = 0;
  while (failed) {
    const StoreCheckpoint checkpoint = publish_but_for_the_name();
    FailingFiles files(++nth, EIO, true);
    const auto code = code_of([&] { writer(files)->resume(checkpoint, content_.facts.heights); });
    failed = code.has_value();
    ASSERT_TRUE(!failed || code == ErrorCode::io_error) << "call " << nth;
    const auto last = writer(FileLayer::system());
    last->resume(checkpoint, content_.facts.heights);
    publish(*last);
    ASSERT_TRUE(read_file(path_) == expected) << "call " << nth;
    std::filesystem::remove_all(work_);
    std::filesystem::create_directory(work_);
    std::filesystem::remove(path_);
  }
  EXPECT_GT(nth, 20);
}

TEST_F(StoreWriterResume, SaysThatTheWorkFolderCannotBeLookedInto) {
  std::filesystem::remove(work_);
  std::filesystem::create_symlink("work", work_);  // to itself
  EXPECT_EQ(code_of([&] { static_cast<void>(writer(FileLayer::system())); }), ErrorCode::io_error);
}

// --- Faults ---

TEST(StoreWriterFaults, LeaveTheOldFileOrTheNewOneAndNothingElse) {
  expect_old_or_new(random_content({.seed = 2, .segments = 2, .records = 700}));
}

TEST(StoreWriterFaults, AFullDiskIsResourceExhaustedAndLeavesNothing) {
  const TestFolder folder;
  const SmallDisk disk(folder.file("disk"), 4);
  if (!disk.is_mounted()) {
    GTEST_SKIP() << SmallDisk::kNeeded;
  }
  EXPECT_EQ(code_of([&] {
              write_store(disk.path() + "/a.ptin",
                          random_content({.segments = 2, .records = 52000}));
            }),
            ErrorCode::resource_exhausted);
  EXPECT_TRUE(std::filesystem::is_empty(disk.path()));
}

}  // namespace
}  // namespace ptin::test
