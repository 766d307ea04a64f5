// SPDX-License-Identifier: GPL-3.0-or-later
//
// The stages of reading and sorting points: by whomever their tasks are done, and in which order.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <map>
#include <numeric>
#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "engine/construct/grid/height_finder.h"
#include "engine/construct/grid/point_grid.h"
#include "engine/construct/lines/source_lines.h"
#include "engine/construct/points/point_source.h"
#include "engine/error.h"
#include "tests/construct/made_raster.h"
#include "tests/construct/memory_file.h"
#include "tests/construct/point_sets.h"
#include "tests/construct/read_buckets.h"
#include "tests/support/share_of_cases.h"

namespace ptin {
namespace {

using oracle::ScratchFolder;

Decimal any_decimal() {
  return {*rc::gen::inRange<std::int64_t>(-1'000'000, 1'000'000), *rc::gen::inRange(0, 7)};
}

RC_GTEST_PROP(PointExtent, JoinedIsThatOfAll, ()) {
  PointExtent all;
  std::vector<PointExtent> parts(static_cast<std::size_t>(*rc::gen::inRange(1, 5)));
  for (int i = *rc::gen::inRange(0, 50); i > 0; --i) {
    const SourcePoint p{any_decimal(), any_decimal(), any_decimal()};
    all.add(p);
    parts[*rc::gen::inRange<std::size_t>(0, parts.size())].add(p);
  }
  PointExtent joined;
  for (const PointExtent& part : parts) {
    joined.join(part);
  }
  RC_ASSERT(joined.points == all.points);
  const StepCounter fine(7);
  for (const auto range : {&PointExtent::x, &PointExtent::y, &PointExtent::z}) {
    RC_ASSERT((joined.*range).decimals() == (all.*range).decimals());
    RC_ASSERT((joined.*range).lowest(fine) == (all.*range).lowest(fine));
    RC_ASSERT((joined.*range).highest(fine) == (all.*range).highest(fine));
  }
}

RC_GTEST_PROP(HeightFinder, JoinedIsThatOfAll, ()) {
  const bool whole = *rc::gen::arbitrary<bool>();
  const double step = *rc::gen::element(1.0, 0.5, 0.1, 0.01, 1e-4, 1e-6);
  HeightFinder all(whole, 0.25);
  std::vector<HeightFinder> parts(static_cast<std::size_t>(*rc::gen::inRange(1, 5)), all);
  for (int i = *rc::gen::inRange(1, 40); i > 0; --i) {
    const double height = *rc::gen::inRange(-100'000, 100'000) * (whole ? 1.0 : step);
    all.add(height);
    parts[*rc::gen::inRange<std::size_t>(0, parts.size())].add(height);
  }
  HeightFinder joined(whole, 0.25);
  for (const HeightFinder& part : parts) {
    joined.join(part);
  }
  const HeightFit a = joined.fit(), b = all.fit();
  RC_ASSERT(a.encoding == b.encoding);
  RC_ASSERT(a.quantum == b.quantum && a.rounding == b.rounding && a.count == b.count);
  RC_ASSERT(a.min_height == b.min_height && a.max_height == b.max_height);
}

TEST(EvenSample, TakesEveryKthOfAll) {
  for (const std::uint64_t n :
       {0ULL, 1ULL, 1023ULL, 1024ULL, 1025ULL, 2048ULL, 2049ULL, 70'000ULL}) {
    EvenSample sample;
    for (std::uint64_t i = 0; i < n; ++i) {
      sample.add({{static_cast<std::int64_t>(i), 0}, {}, {}});
    }
    ASSERT_EQ(sample.points().size(), (n + sample.step() - 1) / sample.step());
    EXPECT_LE(sample.points().size(), EvenSample::kMost);
    EXPECT_TRUE(sample.step() == 1 || sample.points().size() > EvenSample::kMost / 2);
    for (std::size_t i = 0; i < sample.points().size(); ++i) {
      ASSERT_EQ(sample.points()[i].x, static_cast<std::int64_t>(i * sample.step()));
    }
  }
}

RC_GTEST_PROP(Split, MakesRangesOfEqualWeight, ()) {
  std::vector<WeightedKey> keys;
  const auto most = *rc::gen::element<std::uint64_t>(1, 3, 20, 1'000'000);
  const auto heaviest = *rc::gen::element<std::uint64_t>(1, 9);
  for (int i = *rc::gen::inRange(0, 300); i > 0; --i) {
    keys.push_back({*rc::gen::inRange<std::uint64_t>(0, most),
                    *rc::gen::inRange<std::uint64_t>(1, heaviest + 1)});
  }
  const auto ranges = *rc::gen::inRange<std::uint64_t>(1, 12);
  SortPlan plan;
  plan.splitters = split(keys, ranges);
  RC_ASSERT(plan.ranges() <= ranges);
  RC_ASSERT(std::adjacent_find(plan.splitters.begin(), plan.splitters.end(),
                               std::greater_equal<>()) == plan.splitters.end());
  std::vector<std::uint64_t> weights(plan.ranges(), 0);
  std::map<std::uint64_t, std::uint64_t> by_key;
  std::uint64_t all = 0;
  for (const WeightedKey& k : keys) {
    weights[plan.range_of(k.key)] += k.weight;
    by_key[k.key] += k.weight;
    all += k.weight;
  }
  std::uint64_t heaviest_key = 0;
  for (const auto& [key, weight] : by_key) {
    heaviest_key = std::max(heaviest_key, weight);
  }
  for (const std::uint64_t weight : weights) {  // what falls together cannot be divided
    RC_ASSERT(weight <= all / ranges + 1 + 2 * heaviest_key);
  }
}

/// All that sorting writes, by name.
using Written = std::map<std::string, std::string>;

Written written_in(const ScratchFolder& folder) {
  Written written;
  for (const std::string& name : folder.names()) {
    written[name] = oracle::bytes_of(folder.file(name));
  }
  return written;
}

/// Sorts, has the tasks run as `run` says, and returns what stays.
Written sorted_by(const RunTasks& run, const std::vector<std::string>& paths,
                  const SourceOptions& options) {
  const ScratchFolder folder(ScratchFolder::Size::kSmall);
  PointWork work{{FileLayer::system(), folder.path()}, run, {}, 0};
  work.portions = {1000, 10};
  work.sorting = small_sorting();
  PointSource source(paths, options, work);
  const PointBuckets buckets = source.sort(folder.file("buckets"), true);
  EXPECT_EQ(buckets.counts().source_points + buckets.counts().left_out.total(), 20'000U);
  std::ignore = buckets.save(FileLayer::system(), folder.file("index"));
  Written written = written_in(folder);
  EXPECT_GT(written.size(), 3U);
  std::erase_if(written, [](const auto& file) { return file.first.starts_with("sort."); });
  return written;
}

/// Does tasks in another order, some of them twice, each with a worker that knows nothing of the others.
RunTasks shuffled(const std::vector<std::string>& paths, const SourceOptions& options,
                  const std::string* folder) {
  return [=](TaskList& list, TaskWorker&) {
    std::vector<Task> tasks = test::taken_from(list);
    std::mt19937_64 random(tasks.size());
    std::shuffle(tasks.begin(), tasks.end(), random);
    const std::vector<Task> again(tasks.begin(), tasks.begin() + (tasks.size() + 1) / 2);
    tasks.insert(tasks.end(), again.begin(), again.end());
    std::map<TaskName, ArrayFileFacts> found;
    for (Task& task : tasks) {
      PointTasks other(paths, options, {FileLayer::system(), *folder});
      task.bytes = number_of(task.name) * 10'000;
      const TaskResult result = other.run(task);
      const ArrayFileFacts& facts = result.facts(TileFile::kIndex);
      EXPECT_EQ(found.try_emplace(task.name, facts).first->second, facts) << to_string(task.name);
      list.done(task.name, result);
    }
  };
}

TEST(PointStages, WriteTheSameBytesByWhomeverTheyAreDone) {
  const std::string text = text_of(points_of(PointKind::kClusters, 10'000, 3));
  const MemoryFile first("first.xyz", text),
      second("second.xyz", text_of(points_of(PointKind::kDuplicates, 10'000, 4)));
  const std::vector<std::string> paths{first.path(), second.path()};
  SourceOptions options;
  for (const PointMerge rule : test::some_of({PointMerge::kMean, PointMerge::kFirst})) {
    options.merge = rule;
    const Written alone = sorted_by(run_alone, paths, options);
    for (const int threads : {1, 2, 3}) {
      EXPECT_EQ(sorted_by(test::on_threads(threads, (1 << 20) / threads), paths, options), alone)
          << threads;
    }
  }
}

TEST(PointStages, WriteTheSameBytesInAnyOrderByOtherProcesses) {
  const MemoryFile file("first.xyz", text_of(points_of(PointKind::kEven, 20'000, 5)));
  SourceOptions options;
  options.merge = PointMerge::kFirst;
  options.resolution = 70.0;
  const Written alone = sorted_by(run_alone, {file.path()}, options);
  const ScratchFolder folder(ScratchFolder::Size::kSmall);
  const std::string name = folder.path();
  PointWork work{{FileLayer::system(), name}, shuffled({file.path()}, options, &name), {}, 0};
  work.portions = {1000, 10};
  work.sorting = small_sorting();
  {
    PointSource source({file.path()}, options, work);
    const PointBuckets buckets = source.sort(folder.file("buckets"), true);
    std::ignore = buckets.save(FileLayer::system(), folder.file("index"));
  }
  EXPECT_EQ(written_in(folder), alone);
}

SourceLines ring_and_line(double from, double to) {
  SourceLines lines;
  const auto add = [](LineSet& set, double x, double y) {
    set.vertices.push_back({decimal_of(x), decimal_of(y), decimal_of(5.0)});
  };
  for (const auto& [x, y] : {std::pair{from, from}, std::pair{to, from}, std::pair{to, to},
                             std::pair{from, to}, std::pair{from, from}}) {
    add(lines.rings, x, y);
  }
  lines.rings.ends.push_back(5);
  add(lines.breaklines, (from + to) / 2, from + 10);
  add(lines.breaklines, (from + to) / 2, to - 10);
  lines.breaklines.ends.push_back(2);
  lines.files.push_back({"lines", "", {}});
  return lines;
}

TEST(PointStages, AddLinesAndKeepWhatTheBoundaryHolds) {
  const std::vector<GridPoint> points = points_of(PointKind::kEven, 10'000, 7);
  const MemoryFile file("points.xyz", text_of(points));
  const SourceLines lines = ring_and_line(2000, 8000);
  SourceOptions options;
  options.lines = &lines;
  const std::uint64_t inside =
      static_cast<std::uint64_t>(std::count_if(points.begin(), points.end(), [](GridPoint p) {
        return p.x >= 2000 && p.x <= 8000 && p.y >= 2000 && p.y <= 8000;
      }));
  const PointBuckets coarse = read_buckets({file.path()}, options);
  const PointBuckets fine = read_buckets({file.path()}, options, 0, small_sorting());
  EXPECT_EQ(fine.counts().left_out.total(), points.size() - inside);
  EXPECT_EQ(fine.counts().left_out.total(), coarse.counts().left_out.total());
  EXPECT_EQ(fine.counts().source_points, coarse.counts().source_points);
  EXPECT_EQ(fine.hull().corners(), coarse.hull().corners());
  ASSERT_EQ(fine.size(), coarse.size());
  std::vector<BucketPoint> a, b;
  fine.take(0, fine.size(), a);
  coarse.take(0, coarse.size(), b);
  for (std::size_t i = 0; i < a.size(); ++i) {
    ASSERT_EQ(a[i].position, b[i].position);
    ASSERT_EQ(a[i].height, b[i].height);
  }
}

TEST(PointStages, SortOnceMoreFromWhatWasRead) {
  const MemoryFile file("points.xyz", text_of(points_of(PointKind::kEven, 10'000, 7)));
  const ScratchFolder folder(ScratchFolder::Size::kSmall);
  SourceLines lines = ring_and_line(2000, 8000);
  lines.rings_are_flat = true;
  SourceOptions options;
  options.lines = &lines;
  std::map<TaskKind, int> stages;
  const auto run = [&](TaskList& tasks, TaskWorker& worker) {
    run_alone(tasks, worker);
    ++stages[tasks.results().begin()->first.kind];
  };
  PointSource source({file.path()}, options, {{FileLayer::system(), folder.path()}, run, {}, 0});
  EXPECT_EQ(source.sort(folder.file("below"), false).counts().left_out.total(), 0U);
  lines.rings_are_flat = false;
  const PointBuckets twice = source.sort(folder.file("buckets"), true);
  const PointBuckets once = read_buckets({file.path()}, options);
  EXPECT_EQ(stages[TaskKind::kRead], 1);
  EXPECT_EQ(stages[TaskKind::kSort], 2);
  EXPECT_EQ(twice.size(), once.size());
  EXPECT_EQ(twice.counts().left_out.total(), once.counts().left_out.total());
}

TEST(PointBuckets, KnowTheBucketOfEachPoint) {
  const MemoryFile file("points.xyz", text_of(points_of(PointKind::kEven, 20'000, 1)));
  const PointBuckets buckets = read_buckets({file.path()}, {}, 0, small_sorting());
  std::uint64_t bucket = 0;
  for (std::uint64_t point = 0; point < buckets.size(); ++point) {
    bucket += point == buckets.begin_of(bucket + 1) ? 1 : 0;
    ASSERT_EQ(buckets.bucket_of(point), bucket);
  }
  EXPECT_EQ(bucket + 1, buckets.buckets());
  EXPECT_EQ(buckets.begin_of(0), 0U);
  EXPECT_EQ(buckets.begin_of(buckets.buckets()), buckets.size());
  EXPECT_GT(buckets.buckets(), buckets.size() / buckets.bucket_points() + 1);  // some have fewer
}

/// Files that are written where nothing is lost until they are closed, as over a network.
class FailingToClose final : public FileLayer {
 public:
  /// @param nth  Of the files that are made: the one that cannot be closed, from 0.
  explicit FailingToClose(int nth) : nth_(nth) {}
  int create(const std::string& path, int& fd) noexcept override {
    const int failure = FileLayer::create(path, fd);
    if (failure == 0 && made_++ == nth_) {
      fails_ = fd;
    }
    return failure;
  }
  int close(int fd) noexcept override {
    const bool fails = fd == fails_;
    fails_ = fails ? -1 : fails_;
    const int failure = FileLayer::close(fd);
    return fails ? EIO : failure;
  }
  [[nodiscard]] int made() const { return made_; }

 private:
  int nth_, made_ = 0, fails_ = -1;
};

TEST(PointStages, SayWhatAFileOfTheirsMeetsWhenItIsClosed) {
  const MemoryFile file("points.xyz", text_of(points_of(PointKind::kEven, 5'000, 2)));
  for (int nth = 0;; ++nth) {
    SCOPED_TRACE(nth);
    FailingToClose files(nth);
    const ScratchFolder folder(ScratchFolder::Size::kSmall);
    try {
      PointSource source({file.path()}, {}, {{files, folder.path()}, run_told(1 << 20), {}, 0});
      std::ignore = source.sort(folder.file("buckets"), true);
      EXPECT_LE(files.made(), nth) << "nobody saw it";
      EXPECT_GT(nth, 7);
      break;
    } catch (const Error& e) {
      EXPECT_EQ(e.code(), ErrorCode::io_error) << e.what();
      EXPECT_EQ(e.message(), "cannot close: Input/output error") << e.what();
    }
  }
}

enum class Damage { kChanged, kCut, kGone };

/// Does stages by processes of their own, as it were, and damages a file of theirs so many times.
class DamagedStages {
 public:
  DamagedStages(const MemoryFile& source, const ScratchFolder& folder, std::string file,
                Damage damage, int times)
      : source_(source), folder_(folder), file_(std::move(file)), how_(damage), times_(times) {}

  [[nodiscard]] PointWork work() {
    return {{FileLayer::system(), folder_.path()},
            [this](TaskList& tasks, TaskWorker&) {
              damage();
              PointTasks other({source_.path()}, {}, {FileLayer::system(), folder_.path()});
              run_alone(tasks, other);
              if (tasks.results().begin()->first.kind == TaskKind::kRead) {
                is_new_ = true;
              }
              damage();
            },
            {},
            0};
  }
  [[nodiscard]] int times_left() const { return times_; }

 private:
  /// Damages the file when it is there, once after each reading of all points.
  void damage() {
    if (times_ == 0 || !is_new_ || !std::filesystem::exists(file_)) {
      return;
    }
    --times_;
    is_new_ = false;
    std::string bytes = oracle::bytes_of(file_);
    bytes[bytes.size() / 2] ^= 1;
    if (how_ == Damage::kGone) {
      std::filesystem::remove(file_);
    } else {
      oracle::write_text(file_, how_ == Damage::kCut ? bytes.substr(0, bytes.size() / 2) : bytes);
    }
  }

  const MemoryFile& source_;
  const ScratchFolder& folder_;
  std::string file_;
  Damage how_;
  int times_;
  bool is_new_ = false;
};

TEST(PointStages, ReadAllOnceMoreWhereAFileIsDamagedAndNameItTheSecondTime) {
  const MemoryFile file("points.xyz", text_of(points_of(PointKind::kEven, 5'000, 2)));
  const auto written = [&](const ScratchFolder& folder, DamagedStages& stages) {
    {
      PointSource source({file.path()}, {}, stages.work());
      const PointBuckets buckets = source.sort(folder.file("buckets"), true);
      std::ignore = buckets.save(FileLayer::system(), folder.file("index"));
    }
    return written_in(folder);
  };
  const ScratchFolder undamaged(ScratchFolder::Size::kSmall);
  DamagedStages sound(file, undamaged, "", Damage::kChanged, 0);
  const Written expected = written(undamaged, sound);
  for (const std::string kind : {"spool", "read", "plan", "share", "shared", "shares", "range"}) {
    for (const Damage how : {Damage::kChanged, Damage::kCut, Damage::kGone}) {
      for (const int times : {1, 2}) {
        SCOPED_TRACE(kind + " " + std::to_string(static_cast<int>(how)) + " " +
                     std::to_string(times));
        const ScratchFolder folder(ScratchFolder::Size::kSmall);
        const std::string damaged = folder.file("sort." + kind + "-0");
        DamagedStages stages(file, folder, damaged, how, times);
        try {
          EXPECT_EQ(written(folder, stages), expected);
          EXPECT_EQ(times, 1) << "sorted";
        } catch (const Error& e) {
          EXPECT_EQ(times, 2) << e.what();
          EXPECT_EQ(e.code(), how == Damage::kGone ? ErrorCode::not_found : ErrorCode::corruption)
              << e.what();
          EXPECT_EQ(e.context(), damaged);
        }
        EXPECT_EQ(stages.times_left(), 0);
      }
    }
  }
}

TEST(PointStages, OfFilesThatAreWrongNameTheFirst) {
  std::string many;
  for (int i = 0; i < 5000; ++i) {
    many += std::to_string(i) + " 1 1\n";
  }
  const MemoryFile good("good.xyz", "0 0 1\n"), slow("slow.xyz", many + "bad 1 1\n"),
      quick("quick.xyz", "1 bad 1\n");
  const ScratchFolder folder(ScratchFolder::Size::kSmall);
  PointWork work{{FileLayer::system(), folder.path()}, test::on_threads(3, 1 << 18), {}, 0};
  work.portions = {1000, 10};
  for (int i = 0; i < 5; ++i) {
    try {
      const PointSource source({good.path(), slow.path(), quick.path()}, {}, work);
      ADD_FAILURE() << "read";
    } catch (const Error& e) {
      EXPECT_EQ(e.context(), slow.path() + ":5001");
    }
    EXPECT_EQ(folder.names(), std::vector<std::string>{});
  }
}

/// What lies in a folder, bytes.
std::uint64_t bytes_in(const ScratchFolder& folder) {
  std::uint64_t bytes = 0;
  for (const std::string& name : folder.names()) {
    bytes += std::filesystem::file_size(folder.file(name));
  }
  return bytes;
}

TEST(PointStages, TakeNoMoreDiskThanIsPlanned) {
  constexpr std::uint64_t kPoints = 300'000;
  std::mt19937_64 random(1);
  std::string text;
  for (std::uint64_t i = 0; i < kPoints; ++i) {
    text += std::to_string(random() % 1'000'000'000) + " " +
            std::to_string(random() % 1'000'000'000) + " " +
            std::to_string(random() % 2'000'000'000) + "\n";
  }
  const MemoryFile file("points.xyz", text);
  for (const PointMerge rule : {PointMerge::kMean, PointMerge::kFirst}) {
    const ScratchFolder folder(ScratchFolder::Size::kSmall);
    SourceOptions options;
    options.merge = rule;
    std::uint64_t most = 0;
    const auto run = [&](TaskList& tasks, TaskWorker& worker) {
      for (Task& task : test::taken_from(tasks)) {
        task.bytes = 0;
        tasks.done(task.name, worker.run(task));
        most = std::max(most, bytes_in(folder));
      }
    };
    PointSource source({file.path()}, options, {{FileLayer::system(), folder.path()}, run, {}, 0});
    std::ignore = source.sort(folder.file("buckets"), true);
    const SourceDisk planned = PointBuckets::disk_of(kPoints, rule);
    constexpr std::uint64_t kFacts =
        200'000;  // samples and the like: a plan adds a MiB in any case
    EXPECT_LE(most, planned.while_reading + kFacts);
    EXPECT_LE(bytes_in(folder), planned.kept + kFacts);
  }
}

}  // namespace
}  // namespace ptin
