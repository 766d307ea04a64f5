// SPDX-License-Identifier: GPL-3.0-or-later
//
// The order of batches, messages of tasks, what was done elsewhere, and files that show late.
#include "engine/construct/tile_tasks/tile_schedule.h"

#include <algorithm>
#include <filesystem>
#include <map>
#include <random>
#include <string>
#include <thread>
#include <vector>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "engine/construct/build.h"
#include "engine/construct/build_parts.h"
#include "engine/construct/build_worker.h"
#include "engine/construct/tasks/await_file.h"
#include "engine/construct/tasks/task_driver.h"
#include "engine/construct/tasks/task_messages.h"
#include "engine/construct/tile_tasks/tile_worker.h"
#include "tests/construct/resume_fixture.h"

namespace ptin {
namespace {

using test::InterruptibleBuild;
using test::SourceKind;

RC_GTEST_PROP(BatchOrder, NamesTheTilesAboveOfWhichAllBatchesAreWithin, ()) {
  const TileTree tree(*rc::gen::inRange(2, 200), *rc::gen::inRange(2, 200), 8);
  const BatchOrder order(tree);
  const auto count = static_cast<int>(order.batches().size());
  const auto begin = static_cast<std::size_t>(*rc::gen::inRange(0, count + 1));
  const auto end = static_cast<std::size_t>(*rc::gen::inRange(static_cast<int>(begin), count + 1));
  std::map<TileId, std::pair<std::size_t, std::size_t>> batches;  // all, and those within
  for (std::size_t i = 0; i < order.batches().size(); ++i) {
    for (const TileId& above : ancestors_of(tree, order.batches()[i])) {
      ++batches[above].first;
      batches[above].second += begin <= i && i < end ? 1 : 0;
    }
  }
  std::vector<TileId> expected;
  for (const auto& [tile, counts] : batches) {
    if (counts.first == counts.second) {
      expected.push_back(tile);
    }
  }
  std::vector<TileId> within = order.above_within(begin, end);
  RC_ASSERT(std::is_sorted(within.begin(), within.end(),
                           [](const TileId& a, const TileId& b) { return a.level < b.level; }));
  std::sort(within.begin(), within.end());
  RC_ASSERT(within == expected);
}

/// Results with the largest facts that a disk can hold.
TaskResult large_result() {
  TaskResult result;
  for (ArrayFileFacts& f : result.files) {
    f = {std::uint64_t{1} << 44, ~std::uint64_t{0}};
  }
  result.page_bytes = result.lone_samples = std::uint64_t{1} << 44;
  return result;
}

/// The longest message of the tasks of the last batch and of all tiles above it, and of the answers.
std::size_t longest_message(const TileTree& tree) {
  TileId batch = tree.root();
  TaskResults results;
  std::vector<TaskName> names;
  const auto add = [&](TaskKind kind, const TileId& tile) {
    results[{kind, tile}] = large_result();
  };
  for (; batch.level > 1; batch = tree.children(batch).back()) {
    for (const TileId& child : tree.children(batch)) {
      for (const TileFile file : {TileFile::kPushed, TileFile::kBounds, TileFile::kPages}) {
        add(producer_of(child, file).kind, child);
      }
    }
    add(TaskKind::kJoin, batch);
    add(TaskKind::kClose, batch);
    for (const TaskKind kind : {TaskKind::kJoin, TaskKind::kClose, TaskKind::kPlace}) {
      names.push_back({kind, batch});
    }
  }
  for (const TaskKind kind : {TaskKind::kCollapse, TaskKind::kTighten, TaskKind::kPlace}) {
    names.push_back({kind, batch});
  }
  const TaskMemory memory{{}, ~std::uint64_t{0}, 0};
  const TaskGraph graph(tree, memory);
  std::size_t longest = json_of(large_result()).dump().size();
  for (const TaskName& name : names) {
    const std::string message = message_of(graph.describe(name, results));
    EXPECT_EQ(message_of(task_in(nlohmann::json::parse(message))), message);
    longest = std::max(longest, message.size());
  }
  return longest;
}

TEST(TaskMessages, OfEveryTaskAreShortHoweverHighTheTree) {
  const TileTree twelve(std::int64_t{64} << 11, std::int64_t{64} << 11, 64);
  ASSERT_EQ(twelve.levels(), 12);
  EXPECT_LE(longest_message(twelve), 1024U);
  const TileTree twenty(std::int64_t{64} << 19, std::int64_t{64} << 19, 64);
  ASSERT_EQ(twenty.levels(), 20);
  EXPECT_LE(longest_message(twenty), 1024U);
}

/// Leaves all tasks but the placing to others, who tell of them in any order.
class TakesUp final : public TaskDriver {
 public:
  explicit TakesUp(std::vector<TaskResults> told) : told_(std::move(told)) {}
  [[nodiscard]] bool begin(const BuildNote& note) override {
    is_read_ = !note.index.is_null();
    return true;
  }
  std::uint64_t run(TaskSchedule& schedule, TaskWorker& worker, const TaskLimits& limits,
                    const std::stop_token& stop) override {
    for (const TaskResults& results : is_read_ ? std::exchange(told_, {}) : decltype(told_){}) {
      schedule.take_up(results);
    }
    return TaskDriver::run(schedule, worker, limits, stop);
  }

 private:
  std::vector<TaskResults> told_;
  bool is_read_ = false;
};

/// Does all tasks of a tree in an order that is as random as their inputs allow, and tells of some.
TaskResults done_in_any_order(BuildWorker& worker, std::mt19937& random) {
  const TileTree& tree = worker.tree();
  const BatchOrder order(tree);
  std::vector<TaskName> left;
  for (const TileId& batch : order.batches()) {
    left.push_back({TaskKind::kCollapse, batch});
    if (tree.root().level > 1) {
      left.push_back({TaskKind::kTighten, batch});
    }
  }
  for (const TileId& above : order.above_within(0, order.batches().size())) {
    left.push_back({TaskKind::kJoin, above});
    left.push_back({TaskKind::kClose, above});
  }
  const TaskMemory memory;
  const TaskGraph graph(tree, memory);
  TaskResults done;
  while (!left.empty()) {
    std::shuffle(left.begin(), left.end(), random);
    const auto next = std::find_if(left.begin(), left.end(), [&](const TaskName& name) {
      return graph.can_be_done(name, done);
    });
    done[*next] = worker.tasks().run(graph.describe(*next, done));
    left.erase(next);
  }
  return done;
}

TEST(TileSchedule, TakesUpWhatWasDoneElsewhereInAnyOrder) {
  std::mt19937 random(3);
  for (const int left_out : {0, 0, 3, 40}) {
    const InterruptibleBuild of(SourceKind::kRaster);
    const std::string note =
        begin_parts({of.input()}, of.output(), of.options(), InterruptibleBuild::resources()).note;
    std::vector<TaskResults> told(5);
    {
      BuildWorker worker({of.input()}, of.options(), InterruptibleBuild::resources(), note);
      TaskResults done = done_in_any_order(worker, random);
      for (const auto& [name, result] : done) {
        if (static_cast<int>(random() % 100) >= left_out) {
          told[random() % told.size()][name] = result;
        }
      }
    }
    TakesUp driver(told);
    BuildResources resources = InterruptibleBuild::resources();
    resources.driver = &driver;
    resources.unfinished = Unfinished::kResume;
    EXPECT_EQ(of.run(resources), std::nullopt);
    of.expect_resumed_to_the_same_bytes();
  }
}

TEST(AwaitFile, WaitsForAFileThatShowsLateAndNotForever) {
  const oracle::ScratchFolder folder;
  EXPECT_FALSE(await_file(folder.file("a"), std::chrono::milliseconds(0), {}));
  EXPECT_FALSE(await_file(folder.file("a"), std::chrono::milliseconds(30), {}));
  std::thread late([&] {
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
    oracle::write_text(folder.file("a"), "here");
  });
  EXPECT_TRUE(await_file(folder.file("a"), std::chrono::minutes(5), {}));
  late.join();
  std::stop_source stop;
  stop.request_stop();
  EXPECT_THROW(await_file(folder.file("b"), std::chrono::minutes(5), stop.get_token()), Error);
}

/// A worker of another machine is told of a file before it sees it.
TEST(BuildWorker, WaitsForInputsThatShowLate) {
  const InterruptibleBuild of(SourceKind::kRaster);
  BuildResources resources = InterruptibleBuild::resources();
  const std::string note = begin_parts({of.input()}, of.output(), of.options(), resources).note;
  for (const bool is_patient : {true, false}) {
    resources.patience = std::chrono::milliseconds(is_patient ? 300000 : 0);
    BuildWorker worker({of.input()}, of.options(), resources, note);
    const TaskMemory memory;
    const TaskGraph graph(worker.tree(), memory);
    TaskResults done;
    const TileId above{2, 0, 0};
    for (const TileId& batch : worker.tree().children(above)) {
      const TaskName name{TaskKind::kCollapse, batch};
      done[name] = worker.tasks().run(graph.describe(name, done));
    }
    const TileId hidden = worker.tree().children(above).back();
    const std::string path = note_in(note).temporary + "/" + file_name(hidden, TileFile::kPushed);
    std::filesystem::rename(path, path + "-hidden");
    const Task join = graph.describe({TaskKind::kJoin, above}, done);
    if (is_patient) {
      std::thread late([&] {
        std::this_thread::sleep_for(std::chrono::milliseconds(50));
        std::filesystem::rename(path + "-hidden", path);
      });
      EXPECT_GT(worker.tasks().run(join).facts(TileFile::kPushed).bytes, 0U);
      late.join();
    } else {
      EXPECT_THROW(static_cast<void>(worker.tasks().run(join)), DamagedInput);
    }
  }
}

TEST(BuildWorker, SaysThatItDoesNotSeeTheFoldersOfTheBuild) {
  const InterruptibleBuild of(SourceKind::kPoints);
  const oracle::ScratchFolder tmp;
  BuildResources resources = InterruptibleBuild::resources();
  resources.tmp = tmp.path().string();
  const std::string note = begin_parts({of.input()}, of.output(), of.options(), resources).note;
  std::filesystem::rename(note_in(note).temporary, note_in(note).temporary + "-elsewhere");
  try {
    const BuildWorker worker({of.input()}, of.options(), resources, note);
    ADD_FAILURE() << "began";
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ErrorCode::invalid_argument);
    EXPECT_NE(e.message().find("all processes share"), std::string::npos) << e.message();
  }
}

}  // namespace
}  // namespace ptin
