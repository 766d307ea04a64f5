// SPDX-License-Identifier: GPL-3.0-or-later
//
// What `ptin bench` measures with: percentiles, the look at the page cache, questions, ways of
// reading, and what figures come to.
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <numeric>

#include <fcntl.h>
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>
#include <sys/mman.h>
#include <unistd.h>

#include "engine/error.h"
#include "tests/support/least_memory.h"
#include "tests/tools/disk_folder.h"
#include "tests/tools/program.h"
#include "tools/measure/best_way.h"
#include "tools/measure/deadline.h"
#include "tools/measure/file_cache.h"
#include "tools/measure/measure_io.h"
#include "tools/measure/quantiles.h"
#include "tools/measure/system_reads.h"
#include "tools/measure/uring_announcer.h"

namespace ptin::tools {
namespace {

using testing::built;
using testing::disk_folder;
using testing::kNeedsDisk;
using testing::read_file;
using testing::TestFolder;
using testing::write_file;

TEST(QuantilesOf, AreTheNearestRanks) {
  std::vector<double> values(200);
  std::iota(values.begin(), values.end(), 1.0);
  std::reverse(values.begin(), values.end());
  const Quantiles q = quantiles_of(values);
  EXPECT_EQ(q.count, 200U);
  EXPECT_EQ(q.median, 100.0);
  EXPECT_EQ(q.p95, 190.0);
  EXPECT_EQ(q.p99, 198.0);
}

TEST(QuantilesOf, AreToldOfEnoughValuesAlone) {
  const auto of = [](std::size_t n) { return quantiles_of(std::vector<double>(n, 7.0)); };
  EXPECT_FALSE(of(0).median);
  EXPECT_EQ(of(1).median, 7.0);
  EXPECT_FALSE(of(39).p95);
  EXPECT_EQ(of(40).p95, 7.0);
  EXPECT_FALSE(of(199).p99);
  EXPECT_EQ(of(200).p99, 7.0);
}

/// Held against their meaning: so many values are no larger, and with one value less there would be
/// fewer.
RC_GTEST_PROP(QuantilesOf, HoldByCounting, (std::vector<std::uint16_t> drawn)) {
  const std::vector<double> values(drawn.begin(), drawn.end());
  const Quantiles q = quantiles_of(values);
  RC_ASSERT(q.count == values.size());
  const auto holds = [&](const std::optional<double>& value, std::size_t percent) {
    const auto no_larger = static_cast<std::size_t>(
        std::count_if(values.begin(), values.end(), [&](double v) { return v <= *value; }));
    const auto smaller = static_cast<std::size_t>(
        std::count_if(values.begin(), values.end(), [&](double v) { return v < *value; }));
    return 100 * no_larger >= percent * values.size() && 100 * smaller < percent * values.size();
  };
  RC_ASSERT(q.median.has_value() == !values.empty());
  if (q.median) RC_ASSERT(holds(q.median, 50));
  if (q.p95) RC_ASSERT(holds(q.p95, 95));
  if (q.p99) RC_ASSERT(holds(q.p99, 99));
}

TEST(Deadline, FiresWhenTimeIsUp) {
  const Deadline deadline(0.01, {});
  while (!deadline.token().stop_requested()) usleep(1000);
  EXPECT_TRUE(deadline.is_over());
  EXPECT_GE(deadline.elapsed(), 0.01);
}

TEST(Deadline, FiresWhenTheCallerStops) {
  std::stop_source caller;
  const Deadline deadline(1e9, caller.get_token());
  EXPECT_FALSE(deadline.token().stop_requested());
  caller.request_stop();
  EXPECT_TRUE(deadline.token().stop_requested());
  EXPECT_FALSE(deadline.is_over());
}

TEST(FileCache, SeesWhatIsReadAndWhatIsDropped) {
  const auto folder = disk_folder();
  if (!folder) GTEST_SKIP() << kNeedsDisk;
  const auto page = static_cast<std::uint64_t>(::sysconf(_SC_PAGESIZE));
  write_file(folder->file("a"), std::string(100 * page + 1, 'a'));
  const FileCache cache(folder->file("a"));
  EXPECT_EQ(cache.file_bytes(), 100 * page + 1);
  EXPECT_EQ(cache.resident_bytes(), 101 * page);
  EXPECT_EQ(cache.drop(), 0U);
  EXPECT_EQ(cache.resident_bytes(), 0U);
  const int fd = ::open(folder->file("a").c_str(), O_RDONLY | O_CLOEXEC);
  ::posix_fadvise(fd, 0, 0, POSIX_FADV_RANDOM);
  char byte = 0;
  EXPECT_EQ(::pread(fd, &byte, 1, static_cast<off_t>(50 * page)), 1);
  ::close(fd);
  EXPECT_EQ(cache.resident_bytes(), page) << "a page that was touched is no longer cold";
}

/// Keeps a file in the page cache: what is mapped and touched is not dropped.
class Holder {
 public:
  explicit Holder(const std::string& path)
      : bytes_(std::filesystem::file_size(path)), fd_(::open(path.c_str(), O_RDONLY | O_CLOEXEC)) {
    mapping_ = ::mmap(nullptr, bytes_, PROT_READ, MAP_SHARED | MAP_POPULATE, fd_, 0);
  }
  Holder(const Holder&) = delete;
  Holder& operator=(const Holder&) = delete;
  ~Holder() {
    ::munmap(mapping_, bytes_);
    ::close(fd_);
  }

 private:
  std::size_t bytes_;
  int fd_;
  void* mapping_;
};

TEST(FileCache, TellsWhatStays) {
  const auto folder = disk_folder();
  if (!folder) GTEST_SKIP() << kNeedsDisk;
  write_file(folder->file("a"), std::string(100000, 'a'));
  const FileCache cache(folder->file("a"));
  const Holder holder(folder->file("a"));
  EXPECT_GE(cache.drop(), 100000U);
  EXPECT_NE(cache.why_never_cold().find("stay in the page cache"), std::string::npos);
}

TEST(FileCache, SaysThatMemoryIsNoDisk) {
  if (::access("/dev/shm", W_OK) != 0) GTEST_SKIP() << "needs /dev/shm";
  const TestFolder folder(TestFolder::Size::kSmall);
  write_file(folder.file("a"), "a");
  EXPECT_EQ(FileCache(folder.file("a")).file_system(), "tmpfs");
  EXPECT_NE(FileCache(folder.file("a")).why_never_cold().find("tmpfs"), std::string::npos);
}

/// mincore says then that all of the file is there.
TEST(FileCache, SaysThatAUserMayNotLook) {
  const bool is_root = ::geteuid() == 0;
  if (is_root) {
    ASSERT_EQ(::seteuid(65534), 0);
  }
  const std::string why = FileCache("/etc/passwd").why_never_cold();
  if (is_root) {
    ASSERT_EQ(::seteuid(0), 0);
  }
  EXPECT_NE(why.find("may not see"), std::string::npos) << why;
}

TEST(SystemReads, CountWhatComesFromADevice) {
  const auto folder = disk_folder();
  if (!folder) GTEST_SKIP() << kNeedsDisk;
  write_file(folder->file("a"), std::string(1 << 20, 'a'));
  ASSERT_EQ(FileCache(folder->file("a")).drop(), 0U);
  const SystemReads before = SystemReads::now();
  if (!before.device_bytes) GTEST_SKIP() << "needs /proc/self/io";
  static_cast<void>(read_file(folder->file("a")));
  const SystemReads cold = SystemReads::now();
  if (*cold.since(before).device_bytes == 0) GTEST_SKIP() << "needs a file system that counts";
  EXPECT_GE(*cold.since(before).device_bytes, std::uint64_t{1} << 20);
  static_cast<void>(read_file(folder->file("a")));
  EXPECT_EQ(*SystemReads::now().since(cold).device_bytes, 0U);
}

TEST(UringAnnouncer, BringsWhatIsAnnouncedIntoTheCacheAndNoMore) {
  const auto folder = disk_folder();
  if (!folder) GTEST_SKIP() << kNeedsDisk;
  if (!why_no_uring().empty()) {
    EXPECT_THROW(UringAnnouncer(), Error);
    GTEST_SKIP() << "needs io_uring: " << why_no_uring();
  }
  const std::uint64_t page = 4096;
  write_file(folder->file("a"), std::string(std::size_t{40} << 20, 'a'));
  const FileCache cache(folder->file("a"));
  ASSERT_EQ(cache.drop(), 0U);
  const int fd = ::open(folder->file("a").c_str(), O_RDONLY | O_CLOEXEC);
  {
    UringAnnouncer announcer;
    announcer.announce(fd, 3 * page, 5 * page);
    announcer.announce(fd, std::uint64_t{10} << 20, std::uint64_t{20} << 20);  // more than the ring
    announcer.announce(fd, std::uint64_t{1} << 40, page);  // beyond the end: nothing to read
    announcer.announce(-1, 0, page);                       // no file: nobody is told
  }
  ::close(fd);
  EXPECT_EQ(cache.resident_bytes(), (std::uint64_t{20} << 20) + 5 * page);
}

class Measured : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!folder_) GTEST_SKIP() << kNeedsDisk;
    store_ = built(*folder_, "mountains_257.tif");
    request_.file = store_;
    request_.most_times = 2;
    request_.most_threads = 2;
    request_.seconds = 3;
  }
  std::unique_ptr<TestFolder> folder_ = disk_folder();
  std::string store_;
  IoRequest request_;
};

TEST_F(Measured, QuestionsAreThoseOfTheirSeed) {
  const Terrain terrain = Terrain::open(store_);
  const Questions questions(terrain.store(), 5, {}), same(terrain.store(), 5, {}),
      others(terrain.store(), 6, {});
  const StoreFacts& facts = terrain.store().facts();
  const MapPoint low = facts.map.to_map(facts.bounds.min_x, facts.bounds.min_y);
  const MapPoint high = facts.map.to_map(facts.bounds.max_x, facts.bounds.max_y);
  const double area = (high.x - low.x) * (high.y - low.y);
  const std::map<QuestionKind, double> shares = {{QuestionKind::kWindow10000th, 1e-4},
                                                 {QuestionKind::kWindow400th, 1.0 / 400},
                                                 {QuestionKind::kWindow25th, 0.04},
                                                 {QuestionKind::kIsoline25th, 0.04}};
  for (const QuestionKind kind : kQuestionKinds) {
    for (std::uint64_t i = 0; i < 20; ++i) {
      const Question q = questions.make(kind, i, terrain);
      EXPECT_EQ(q.at, same.make(kind, i, terrain).at);
      EXPECT_NE(q.at, others.make(kind, i, terrain).at);
      EXPECT_NE(q.at, questions.make(kind, i + 1, terrain).at);
      const Window& w = q.window;
      EXPECT_GE(w.min_x, low.x - 1e-6);
      EXPECT_LE(w.max_y, high.y + 1e-6);
      if (shares.contains(kind)) {
        EXPECT_NEAR((w.max_x - w.min_x) * (w.max_y - w.min_y) / area, shares.at(kind), 1e-9);
      }
      EXPECT_EQ(questions.predicate(q) == nullptr,
                kind == QuestionKind::kSight || kind == QuestionKind::kIsoline25th);
    }
  }
}

TEST_F(Measured, EveryWayGivesTheSameAnswers) {
  TerrainOpener opener;
  const Terrain announced = opener.open(store_, ReadWay::kAnnounced);
  for (const std::optional<double> tolerance : {std::optional<double>(), std::optional(5.0)}) {
    const Questions questions(announced.store(), 1, tolerance);
    for (const ReadWay way : kReadWays) {
      if (way == ReadWay::kUring && !why_no_uring().empty()) continue;
      const Terrain terrain = opener.open(store_, way);
      for (const QuestionKind kind : kQuestionKinds) {
        const Question q = questions.make(kind, 3, announced);
        const Answer a = questions.ask(q, announced, {}), b = questions.ask(q, terrain, {});
        EXPECT_EQ(a.digest, b.digest) << name_of(kind) << " by " << name_of(way);
        EXPECT_EQ(a.cost.io.pages, b.cost.io.pages) << name_of(kind) << " by " << name_of(way);
      }
    }
  }
}

/// Nothing is read beside what the question asks for, but for at most half as much between it.
TEST_F(Measured, AColdPointBringsLittleIntoTheCache) {
  TerrainOpener opener;
  const FileCache cache(store_);
  std::optional<Questions> questions;
  questions.emplace(opener.open(store_, ReadWay::kPread).store(), 1, std::nullopt);
  for (const ReadWay way : {ReadWay::kAnnounced, ReadWay::kFaults, ReadWay::kPread}) {
    for (std::uint64_t i = 0; i < 10; ++i) {
      ASSERT_EQ(cache.drop(), 0U);
      const Terrain terrain = opener.open(store_, way);
      EXPECT_LE(cache.resident_bytes(), std::uint64_t{16} << 10) << name_of(way);
      ASSERT_NE(terrain.floor(), nullptr);  // its root is read with the first question, once
      const std::uint64_t front = cache.resident_bytes();
      const Question q = questions->make(QuestionKind::kPoint, i, terrain);
      const Answer answer = questions->ask(q, terrain, {});
      const std::uint64_t asked = answer.cost.io.bytes_read;
      EXPECT_LE(cache.resident_bytes() - front, way == ReadWay::kFaults ? asked : asked + asked / 2)
          << name_of(way) << ", point " << i;
    }
  }
}

TEST_F(Measured, EveryKindByEveryWayColdAndWarm) {
  request_.most_times = 1;
  request_.seconds = 12;
  const IoReport report = measure_io(request_);
  const std::size_t ways = why_no_uring().empty() ? 4 : 3;
  EXPECT_EQ(report.why_not_cold, "");
  EXPECT_EQ(report.opening.size(), ways);
  ASSERT_EQ(report.questions.size(), kQuestionKinds.size() * ways);
  for (const QuestionFigures& f : report.questions) {
    EXPECT_EQ(f.cold.all().size() + f.cold.not_cold(), 1U) << name_of(f.kind) << name_of(f.way);
    EXPECT_EQ(f.warm.all().size(), f.way == ReadWay::kUring ? 0U : 1U);
    EXPECT_EQ(f.why_left_out, "");
    EXPECT_GT(f.cold.mean_pages(), 0);
    if (report.has_device_bytes) {
      EXPECT_GT(f.cold.mean_device_bytes(), 0);
    }
  }
  EXPECT_EQ(report.threads.size(), 2 * ways * 2);  // two kinds, one thread and two
  EXPECT_EQ(report.index.why_no_second, "");
  EXPECT_EQ(report.index.searches.size(), 8U);
  EXPECT_GT(report.index.bytes, 0U);
  EXPECT_TRUE(best_way(report));
  EXPECT_EQ(folder_->names(), std::vector<std::string>{"mountains_257.tif.ptin"});
}

TEST_F(Measured, WhatWasNotColdIsCountedAndInNoFigure) {
  std::optional<Holder> holder;
  request_.most_threads = 1;
  request_.seconds = 6;
  request_.progress = [&](const char* stage, double share) {
    if (std::string(stage) == "questions" && share > 0 && !holder) holder.emplace(store_);
  };
  const IoReport report = measure_io(request_);
  ASSERT_TRUE(holder);
  // The first kind had its first round before.
  EXPECT_EQ(report.questions[0].cold.all().size(), 1U);
  EXPECT_EQ(report.questions[0].cold.not_cold(), 1U);
  EXPECT_EQ(report.questions.back().cold.all().size(), 0U);
  EXPECT_EQ(report.questions.back().cold.not_cold(), 2U);
  for (const ThreadFigures& f : report.threads) EXPECT_TRUE(f.cold_per_second.empty());
  EXPECT_GT(report.threads.front().not_cold, 0U);
}

TEST_F(Measured, AFileThatChangesEndsIt) {
  const std::string other = built(*folder_, "coast_257.tif");
  request_.progress = [&](const char* stage, double share) {
    if (std::string(stage) == "questions" && share > 0 && std::filesystem::exists(other))
      std::filesystem::rename(other, store_);
  };
  try {
    static_cast<void>(measure_io(request_));
    FAIL();
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ErrorCode::corruption) << e.what();
  }
  EXPECT_EQ(folder_->names().size(), 1U);
}

TEST_F(Measured, AStopEndsItWithNothingLeftBehind) {
  for (const char* at : {"questions", "threads", "indexes"}) {
    std::stop_source stop;
    request_.stop = stop.get_token();
    request_.progress = [&](const char* stage, double share) {
      if (std::string(stage) == at && share > 0) stop.request_stop();
    };
    try {
      static_cast<void>(measure_io(request_));
      FAIL() << at;
    } catch (const Error& e) {
      EXPECT_EQ(e.code(), ErrorCode::cancelled) << at << ": " << e.what();
    }
    EXPECT_EQ(folder_->names().size(), 1U) << at;
  }
}

/// Windows of 1/25 and isolines in them want several times what any other question does.
bool is_small(QuestionKind kind) { return kind < QuestionKind::kWindow25th; }

/// What every small question fits that may be asked for a request, and no larger one.
std::uint64_t memory_for_small_questions(const IoRequest& request) {
  const Terrain terrain = Terrain::open(request.file);
  const Questions questions(terrain.store(), request.seed, request.tolerance);
  std::uint64_t most_small = 0, least_large = UINT64_MAX;
  for (const QuestionKind kind : kQuestionKinds) {
    for (std::uint64_t i = 0; i < request.most_times * kReadWays.size(); ++i) {
      const Question question = questions.make(kind, i, terrain);
      const std::uint64_t least = reference::least_memory([&](std::uint64_t limit) {
        static_cast<void>(questions.ask(question, terrain, {limit, {}}));
      });
      is_small(kind) ? most_small = std::max(most_small, least)
                     : least_large = std::min(least_large, least);
    }
  }
  EXPECT_LT(2 * most_small, least_large);
  return most_small;
}

TEST_F(Measured, WhatDoesNotFitTheMemoryIsLeftOutWithASentence) {
  request_.tolerance = 0.0;  // by stars
  request_.memory_bytes = memory_for_small_questions(request_);
  const IoReport report = measure_io(request_);
  for (const QuestionFigures& f : report.questions) {
    EXPECT_EQ(f.why_left_out.find("--memory") == std::string::npos, is_small(f.kind))
        << name_of(f.kind) << ": " << f.why_left_out;
    EXPECT_EQ(f.cold.all().empty(), !is_small(f.kind)) << name_of(f.kind);
  }
}

TEST_F(Measured, ASecondIndexThatDoesNotFitTheMemoryIsLeftOutWithASentence) {
  request_.memory_bytes = std::uint64_t{64} << 10;
  const IoReport report = measure_io(request_);
  EXPECT_NE(report.index.why_no_second.find("--memory"), std::string::npos);
  EXPECT_EQ(report.index.searches.size(), 4U);
}

}  // namespace
}  // namespace ptin::tools
