// SPDX-License-Identifier: GPL-3.0-or-later
//
// Stages of reading, on threads of one process.
#include "engine/construct/tasks/stage_runner.h"

#include <atomic>
#include <chrono>
#include <functional>
#include <string>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include "engine/construct/tasks/task_messages.h"
#include "engine/error.h"
#include "engine/stop.h"

namespace ptin {
namespace {

/// Does what a test says, for each task.
class Worker final : public StageWorker {
 public:
  explicit Worker(std::function<std::string(const StageTask&)> what) : what_(std::move(what)) {}
  [[nodiscard]] std::string run(const StageTask& task) override { return what_(task); }

 private:
  std::function<std::string(const StageTask&)> what_;
};

void wait_until_stopped(const StageTask& task) {
  while (true) {
    stop_if_asked(task.stop, "the test");
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
}

TEST(StageRunner, GivesResultsByNumberOnAnyNumberOfThreads) {
  const SourceStage stage{"reading", std::vector<std::uint64_t>(23, 2), "facts"};
  Worker worker([](const StageTask& task) {
    EXPECT_LE(task.memory, 1000U);
    return task.name + task.facts + std::to_string(task.number);
  });
  for (const int threads : {0, 1, 2, 5, 40}) {
    const std::vector<std::string> results = run_stage(stage, worker, {threads, 1000, {}, {}});
    ASSERT_EQ(results.size(), 23U);
    for (std::size_t i = 0; i < results.size(); ++i) {
      EXPECT_EQ(results[i], "readingfacts" + std::to_string(i));
    }
  }
  EXPECT_TRUE(run_stage({"nothing", {}, ""}, worker, {3, 0, {}, {}}).empty());
}

TEST(StageRunner, SharesMemoryAmongTheTasksThatRunAtOnce) {
  Worker worker([](const StageTask& task) { return std::to_string(task.memory); });
  EXPECT_EQ(run_stage({"a", {1, 1, 1, 1}, ""}, worker, {2, 1000, {}, {}})[0], "500");
  EXPECT_EQ(run_stage({"a", {1}, ""}, worker, {2, 1000, {}, {}})[0], "1000");
}

TEST(StageRunner, ThrowsTheErrorOfTheFirstTaskThatFails) {
  const SourceStage stage{"reading", std::vector<std::uint64_t>(8, 1), ""};
  for (const int threads : {1, 2, 4}) {
    std::atomic<bool> later_has_failed = threads == 1;
    Worker worker([&](const StageTask& task) -> std::string {
      if (task.number == 2) {  // ends after the one behind it
        while (!later_has_failed) {
          std::this_thread::sleep_for(std::chrono::milliseconds(1));
        }
        throw Error(ErrorCode::invalid_argument, "the second");
      }
      if (task.number == 3) {
        later_has_failed = true;
        throw Error(ErrorCode::io_error, "the third");
      }
      if (task.number > 3) {  // begun before that one failed
        wait_until_stopped(task);
      }
      return "";
    });
    try {
      std::ignore = run_stage(stage, worker, {threads, 0, {}, {}});
      ADD_FAILURE() << "no error";
    } catch (const Error& e) {
      EXPECT_EQ(e.message(), "the second");
    }
  }
}

TEST(StageRunner, StopsWhenAsked) {
  std::stop_source stop;
  Worker worker([&](const StageTask& task) -> std::string {
    stop.request_stop();
    wait_until_stopped(task);
    return "";
  });
  for (int i = 0; i < 2; ++i) {  // the second time before it begins
    try {
      std::ignore = run_stage({"a", {1, 1, 1}, ""}, worker, {2, 0, stop.get_token(), {}});
      ADD_FAILURE() << "no error";
    } catch (const Error& e) {
      EXPECT_EQ(e.code(), ErrorCode::cancelled);
    }
  }
}

TEST(StageRunner, TellsHowFarItIs) {
  Worker worker([](const StageTask& task) {
    task.progress(1);
    task.progress(1);
    task.progress(9);  // more than there is
    return std::string();
  });
  std::uint64_t last = 0;
  const auto progress = [&](std::uint64_t done, std::uint64_t total) {
    EXPECT_GT(done, last);
    EXPECT_EQ(total, 9U);
    last = done;
  };
  std::ignore = run_stage({"a", {3, 1, 5}, ""}, worker, {2, 0, {}, progress});
  EXPECT_EQ(last, 9U);
}

TEST(RunAlone, GivesEachTaskTheMemoryAndAddsUpTheirProgress) {
  Worker worker([](const StageTask& task) {
    task.progress(1);
    return std::to_string(task.number) + " " + std::to_string(task.memory);
  });
  std::vector<std::uint64_t> told;
  const auto progress = [&](std::uint64_t done, std::uint64_t total) {
    EXPECT_EQ(total, 9U);
    told.push_back(done);
  };
  EXPECT_EQ(run_alone_within({"a", {3, 1, 5}, ""}, worker, 77, {}, progress),
            (std::vector<std::string>{"0 77", "1 77", "2 77"}));
  EXPECT_EQ(told, (std::vector<std::uint64_t>{1, 4, 5}));
}

TEST(StageRunner, IsTheSameThroughMessages) {
  const SourceStage stage{"reading", {1, 1}, std::string(400, 'f')};
  Worker worker([](const StageTask& task) -> std::string {
    if (task.number == 1) {
      throw Error(ErrorCode::io_error, "no", "there");
    }
    return task.facts + std::to_string(task.memory);
  });
  EXPECT_LT(message_of(stage, 0).size(), 1024U);
  EXPECT_EQ(told_in(answer_to(message_of(stage, 0), worker, 77, {})), stage.facts + "77");
  try {
    std::ignore = told_in(answer_to(message_of(stage, 1), worker, 77, {}));
    ADD_FAILURE() << "no error";
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ErrorCode::io_error);
    EXPECT_EQ(e.message(), "no");
    EXPECT_EQ(e.context(), "there");
  }
}

TEST(StageText, HoldsAPlainValue) {
  struct Pair {
    double a = 0.1;
    std::uint64_t b = 77;
  };
  const std::string text = text_of_value(Pair{});
  EXPECT_EQ(value_in_text<Pair>(text).a, 0.1);
  EXPECT_EQ(value_in_text<Pair>(text).b, 77U);
  EXPECT_THROW(std::ignore = value_in_text<Pair>(text.substr(2)), Error);
  EXPECT_THROW(std::ignore = value_in_text<Pair>("zz" + text.substr(2)), Error);
}

}  // namespace
}  // namespace ptin
