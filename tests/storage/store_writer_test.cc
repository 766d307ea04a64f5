// SPDX-License-Identifier: GPL-3.0-or-later
#include "storage/store_writer.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <optional>
#include <random>
#include <tuple>

#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include "engine/geometry/hilbert.h"
#include "storage/layout.h"
#include "storage/record_order.h"
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
  for (auto& segment : content.segments) {
    std::reverse(segment.begin(), segment.end());
  }
  write_store(folder.file("b"), content);
  EXPECT_EQ(read_file(folder.file("a")), read_file(folder.file("b")));
}

TEST(StoreWriter, PutsWideRecordsFirstAndStartsASegmentOnAPageOfItsOwn) {
  const TestFolder folder;
  const StoreContent content = random_content({.segments = 3, .records = 1000});
  write_store(folder.file("a"), content);
  const auto store = StoreFile::open(folder.file("a"));
  std::vector<VertexSplit> expected;
  for (std::vector<VertexSplit> segment : content.segments) {
    order_segment(segment, 4096);
    for (std::size_t i = 1; i < segment.size(); ++i) {
      ASSERT_GE(kind_of(segment[i - 1]), kind_of(segment[i]));
    }
    expected.insert(expected.end(), segment.begin(), segment.end());
  }
  EXPECT_EQ(read_all(*store), expected);
}

// Boxes about their vertex, small for most records and large for few, as errors are: a terrain's.
std::vector<VertexSplit> terrain_like(std::size_t count) {
  std::mt19937_64 random(7);
  const int side = 4096;
  std::vector<VertexSplit> records(count);
  for (VertexSplit& r : records) {
    const double size = 1.0 / (1e-3 + std::uniform_real_distribution(0.0, 1.0)(random));
    const auto reach = static_cast<std::int32_t>(4 * size);
    r.u = {static_cast<std::int32_t>(random() % side), static_cast<std::int32_t>(random() % side)};
    r.w = r.vl = r.vr = {r.u.x + 1, r.u.y};
    r.roi = {std::max(r.u.x - reach, 0), std::max(r.u.y - reach, 0), r.u.x + reach + 1,
             r.u.y + reach};
    r.error =
        static_cast<float>(size * std::exp2(std::uniform_real_distribution(-3.0, 3.0)(random)));
  }
  return records;
}

struct Cost {
  double point = 0, tolerance = 0;  // pages of a mean point, and of the mean of some tolerances
};

Cost cost_of(std::span<const VertexSplit> records) {
  constexpr std::size_t kPage = 64;
  Cost cost;
  for (std::size_t i = 0; i < records.size(); i += kPage) {
    GridBox box;
    float error = 0;
    for (const VertexSplit& r : records.subspan(i, std::min(kPage, records.size() - i))) {
      box = united(box, r.roi);
      error = std::max(error, r.error);
    }
    cost.point += static_cast<double>(box.max_x - box.min_x + 1) * (box.max_y - box.min_y + 1) /
                  (4096.0 * 4096.0);
    for (const float tolerance : {2.0F, 5.0F, 10.0F, 20.0F, 50.0F}) {
      cost.tolerance += error > tolerance ? 0.2 : 0.0;
    }
  }
  return cost;
}

// What it is for. Orders by one thing alone do one of both well; those it is held against are by
// error, and by octave of error and then in squares.
TEST(StoreWriter, OrdersRecordsSoThatPointsAndTolerancesReadFewPages) {
  std::vector<VertexSplit> records = terrain_like(50'000);
  std::sort(records.begin(), records.end(),
            [](const VertexSplit& a, const VertexSplit& b) { return a.error > b.error; });
  const Cost by_error = cost_of(records);
  const auto place = [](const VertexSplit& r) {
    const auto octave = static_cast<int>(layout::to_bits(r.error) >> 23);
    return std::tuple(-octave, hilbert_position(static_cast<std::uint32_t>(r.u.x),
                                                static_cast<std::uint32_t>(r.u.y)));
  };
  std::sort(records.begin(), records.end(),
            [&](const VertexSplit& a, const VertexSplit& b) { return place(a) < place(b); });
  const Cost by_octave = cost_of(records);
  order_segment(records, 4096);
  const Cost ours = cost_of(records);
  RecordProperty("point", std::to_string(ours.point) + " " + std::to_string(by_octave.point));
  EXPECT_LT(ours.point, 0.75 * by_octave.point);
  EXPECT_LT(ours.point, 0.25 * by_error.point);
  EXPECT_LT(ours.tolerance, 1.6 * by_error.tolerance);
  EXPECT_LT(ours.tolerance, 1.35 * by_octave.tolerance);
}

TEST(StoreWriter, FillsPagesOfEachSizeWithAsManyRecordsAsFit) {
  const TestFolder folder;
  RandomRecords options;
  options.segments = 1;
  options.records = 5000;
  for (const std::uint32_t page_bytes : {4096U, 8192U, 16384U, 65536U}) {
    for (const bool narrow : {true, false}) {
      options.side = narrow ? 30000 : 1 << 29;
      StoreContent content = random_content(options);
      if (!narrow) {
        for (VertexSplit& r : content.segments[0]) {
          r.w = {r.u.x < options.side / 2 ? options.side : 0, r.u.y};
          r.roi = united(r.roi, r.w);
          r.error = 1.0F;
        }
      }
      StoreWriterOptions writer;
      writer.overwrite = true;
      writer.page_bytes = page_bytes;
      write_store(folder.file("a"), content, writer);
      const auto store = StoreFile::open(folder.file("a"));
      EXPECT_EQ(store->facts().page_bytes, page_bytes);
      const std::size_t fit = page_bytes / (narrow ? kNarrowRecordBytes : kWideRecordBytes);
      EXPECT_EQ(store->pages().page_count(), (options.records + fit - 1) / fit);
      EXPECT_EQ(store->page_info(PageId{0}).records, fit);
      EXPECT_EQ(store->page_info(PageId{0}).kind, narrow ? RecordKind::kNarrow : RecordKind::kWide);
      EXPECT_TRUE(verify_store(folder.file("a")).is_sound());
    }
  }
  EXPECT_EQ(4096 / kNarrowRecordBytes, 64U);
  EXPECT_EQ(4096 / kWideRecordBytes, 56U);
}

TEST(StoreWriter, TakesAtMost80BytesARecordOnALargeFile) {
  const TestFolder folder;
  RandomRecords options;
  options.segments = 1;
  options.records = 100000;
  write_store(folder.file("a"), random_content(options));
  EXPECT_LT(std::filesystem::file_size(folder.file("a")), 80U * options.records);
}

TEST(StoreWriter, KeepsALongIndexInASideFile) {
  const TestFolder folder;
  RandomRecords options;
  options.segments = 4;
  options.records = 40000;  // 2600 pages: 31 leaves, and 16 are kept in memory
  const StoreContent content = random_content(options);
  write_store(folder.file("a.ptin"), content);
  EXPECT_TRUE(verify_store(folder.file("a.ptin")).is_sound());
  EXPECT_EQ(folder.names(), std::vector<std::string>{"a.ptin"});
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
    writer->add_segment(content.segments[0], content.facts.heights);
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
  writer->add_segment(content.segments[0], content.facts.heights);
  EXPECT_EQ(code_of([&] {
              writer->add_segment(content.segments[0], {HeightType::int32, 1.0, 0.0});
            }),
            ErrorCode::invalid_argument);
}

TEST(StoreWriter, TakesRecordsThatCannotBeReadBackForAFaultOfTheProgram) {
  const TestFolder folder;
  StoreContent content = random_content({.segments = 1, .records = 1});
  content.segments[0][0].w = content.segments[0][0].u;
  EXPECT_EQ(code_of([&] { write_store(folder.file("a"), content); }), ErrorCode::internal);
  content = random_content({.segments = 1, .records = 1});
  content.segments[0][0].height_lo = layout::to_bits(std::numeric_limits<float>::quiet_NaN());
  EXPECT_EQ(code_of([&] { write_store(folder.file("a"), content); }), ErrorCode::internal);
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
    for (std::vector<VertexSplit> segment : content_.segments) {
      first->add_segment(segment, content_.facts.heights);
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
