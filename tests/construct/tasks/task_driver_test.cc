// SPDX-License-Identifier: GPL-3.0-or-later
//
// Tasks on threads of one process: memory, progress, and what becomes of what tasks and callbacks
// throw; and the same through messages.
#include "engine/construct/tasks/task_driver.h"

#include <atomic>
#include <chrono>
#include <cstddef>
#include <functional>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include "engine/construct/tasks/value_text.h"
#include "engine/error.h"
#include "engine/stop.h"
#include "tests/construct/listed_tasks.h"
#include "tests/construct/task_runs.h"

namespace ptin {
namespace {

using test::ListedTasks;
using test::on_threads;
using test::ToldWorker;

void wait_until_stopped(const Task& task) {
  while (true) {
    stop_if_asked(task.stop, "the test");
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
}

// -------------------------------------------------------------------------------------------------
// Lists of tasks.

TEST(TaskList, GivesResultsByNumberOnAnyNumberOfThreads) {
  const ArrayFileFacts plan{77, 5};
  ToldWorker worker([](const Task& task) {
    EXPECT_EQ(task.bytes, 1000U);
    return to_string(task.name) + " " + std::to_string(task.inputs.at(0).facts.bytes);
  });
  for (const int threads : {0, 1, 2, 5, 40}) {
    TaskList tasks(TaskKind::kRead, std::vector<std::uint64_t>(23, 2), 7, plan);
    on_threads(threads, 1000)(tasks, worker);
    EXPECT_TRUE(tasks.is_complete());
    ASSERT_EQ(tasks.results().size(), 23U);
    std::size_t i = 0;
    for (const auto& [name, result] : tasks.results()) {
      EXPECT_EQ(result.told, "reading portion " + std::to_string(i++) + " 77");
    }
  }
  TaskList nothing(TaskKind::kRead, {}, 0);
  on_threads(3)(nothing, worker);
  EXPECT_TRUE(nothing.results().empty());
}

TEST(TaskList, HandsOutWhatWaitsForNothingFirst) {
  const TaskName first = numbered(TaskKind::kRead, 0), second = numbered(TaskKind::kRead, 1);
  TaskList tasks({second, first},
                 [&](const TaskName& name, const TaskResults& results) -> std::optional<Task> {
                   if (name == second && !results.contains(first)) {
                     return std::nullopt;
                   }
                   return Task{name, {}, 0, 3};
                 },
                 {});
  EXPECT_EQ(tasks.next_bytes(), 3U);
  EXPECT_EQ(tasks.take().name, first);
  EXPECT_EQ(tasks.next_bytes(), std::nullopt);
  EXPECT_FALSE(tasks.is_complete());
  tasks.done(first, {});
  EXPECT_EQ(tasks.take().name, second);
  EXPECT_TRUE(tasks.is_complete());
}

TEST(TaskList, TellsHowFarItIs) {
  ToldWorker worker([](const Task& task) {
    task.progress(1);
    task.progress(1);
    task.progress(9);  // more than there is
    return std::string();
  });
  std::uint64_t last = 0;
  const auto progress = [&](const StageProgress& told) {
    EXPECT_STREQ(told.stage, "sharing out");
    EXPECT_GT(told.done, last);
    EXPECT_EQ(told.total, 9U);
    last = told.done;
  };
  TaskList tasks(TaskKind::kShare, {3, 1, 5}, 0);
  on_threads(2, 0, {}, progress)(tasks, worker);
  EXPECT_EQ(last, 9U);
}

TEST(TaskList, AddsUpTheProgressOfOneTaskAfterTheOther) {
  ToldWorker worker([](const Task& task) {
    task.progress(1);
    return std::to_string(number_of(task.name)) + " " + std::to_string(task.bytes);
  });
  std::vector<std::uint64_t> told;
  TaskList tasks(TaskKind::kRead, {3, 1, 5}, 0);
  tasks.set_bytes(77);
  tasks.tell([&](const StageProgress& p) { told.push_back(p.done); });
  run_alone(tasks, worker);
  EXPECT_EQ(tasks.results().at(numbered(TaskKind::kRead, 2)).told, "2 77");
  EXPECT_EQ(told, (std::vector<std::uint64_t>{1, 3, 4, 5, 9}));
}

// -------------------------------------------------------------------------------------------------
// Threads.

TEST(TaskDriver, ThrowsTheErrorOfTheFirstTaskThatFails) {
  for (const int threads : {1, 2, 4}) {
    std::atomic<bool> later_has_failed = threads == 1;
    ToldWorker worker([&](const Task& task) -> std::string {
      const std::size_t number = number_of(task.name);
      if (number == 2) {  // ends after the one behind it
        while (!later_has_failed) {
          std::this_thread::sleep_for(std::chrono::milliseconds(1));
        }
        throw Error(ErrorCode::invalid_argument, "the second");
      }
      if (number == 3) {
        later_has_failed = true;
        throw Error(ErrorCode::io_error, "the third");
      }
      if (number > 3) {  // begun before that one failed
        wait_until_stopped(task);
      }
      return "";
    });
    TaskList tasks(TaskKind::kRead, std::vector<std::uint64_t>(8, 1), 0);
    try {
      on_threads(threads)(tasks, worker);
      ADD_FAILURE() << "no error";
    } catch (const Error& e) {
      EXPECT_EQ(e.message(), "the second");
    }
  }
}

TEST(TaskDriver, KeepsWhatEarlierTasksMakeAfterAnError) {
  std::atomic<bool> third_has_begun = false, third_is_stopped = false;
  const auto wait_for = [](const std::atomic<bool>& event) {
    while (!event) {
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
  };
  ToldWorker worker([&](const Task& task) -> std::string {
    switch (number_of(task.name)) {
      case 0:
        wait_for(third_is_stopped);  // so the error of the second is known
        return "made";
      case 1:
        wait_for(third_has_begun);
        throw Error(ErrorCode::io_error, "the second");
      default:
        third_has_begun = true;
        while (!task.stop.stop_requested()) {
          std::this_thread::sleep_for(std::chrono::milliseconds(1));
        }
        third_is_stopped = true;
        throw Error(ErrorCode::cancelled, "the third");
    }
  });
  TaskList tasks(TaskKind::kRead, {1, 1, 1}, 0);
  EXPECT_THROW(on_threads(3)(tasks, worker), Error);
  ASSERT_EQ(tasks.results().size(), 1U);
  EXPECT_TRUE(tasks.results().begin()->second.told.starts_with("made"));
}

TEST(TaskDriver, StopsWhenAsked) {
  std::stop_source stop;
  ToldWorker worker([&](const Task& task) -> std::string {
    stop.request_stop();
    wait_until_stopped(task);
    return "";
  });
  for (int i = 0; i < 2; ++i) {  // the second time before it begins
    TaskList tasks(TaskKind::kRead, {1, 1, 1}, 0);
    try {
      on_threads(2, 0, stop.get_token())(tasks, worker);
      ADD_FAILURE() << "no error";
    } catch (const Error& e) {
      EXPECT_EQ(e.code(), ErrorCode::cancelled);
    }
  }
}

TEST(TaskDriver, GivesMemoryBackBeforeTasksThatAreLarger) {
  ListedTasks tasks({5, 5, 3, 9, 9, 1, 2});
  ToldWorker worker([](const Task&) { return std::string(); });
  std::vector<std::size_t> given_back;
  std::vector<std::uint64_t> wanted;
  const TaskLimits limits{1, 10, [&](std::uint64_t bytes) {
                            given_back.push_back(tasks.ended.size());
                            wanted.push_back(bytes);
                          }};
  EXPECT_EQ(TaskDriver().run(tasks, worker, limits, {}), 9U);
  EXPECT_EQ(tasks.ended, (std::vector<std::uint64_t>{5, 5, 3, 9, 9, 1, 2}));
  EXPECT_EQ(given_back, (std::vector<std::size_t>{3, 6})) << "before the first 9, and before the 2";
  EXPECT_EQ(wanted, (std::vector<std::uint64_t>{9, 2}));
}

/// What running the tasks throws.
std::string thrown_by(TaskSchedule& tasks, TaskWorker& worker, const TaskLimits& limits) {
  try {
    TaskDriver().run(tasks, worker, limits, {});
  } catch (const std::exception& e) {
    return e.what();
  }
  return "";
}

TEST(TaskDriver, ThrowsWhatATaskThrewOnceTheOthersHaveEnded) {
  for (const int threads : {1, 2, 3}) {
    SCOPED_TRACE(threads);
    std::atomic<int> running = 0;
    ListedTasks tasks(std::vector<std::uint64_t>(50, 1));
    ToldWorker worker([&](const Task& task) -> std::string {
      ++running;
      std::this_thread::yield();
      --running;
      if (number_of(task.name) == 7) {
        throw std::runtime_error("the seventh");
      }
      return "";
    });
    EXPECT_EQ(thrown_by(tasks, worker, {threads, 100, {}}), "the seventh");
    EXPECT_EQ(running, 0);
    EXPECT_LT(tasks.ended.size(), 50U);
  }
}

TEST(TaskDriver, ThrowsWhatTheScheduleThrew) {
  for (const int threads : {1, 3}) {
    ListedTasks tasks(std::vector<std::uint64_t>(50, 1));
    tasks.when_done = [](std::size_t number) {
      if (number == 20) {
        throw std::runtime_error("no room for the result");
      }
    };
    ToldWorker worker([](const Task&) { return std::string(); });
    EXPECT_EQ(thrown_by(tasks, worker, {threads, 100, {}}), "no room for the result");
  }
}

TEST(TaskDriver, ThrowsWhatGivingMemoryBackThrew) {
  ListedTasks tasks({5, 9, 5});
  ToldWorker worker([](const Task&) { return std::string(); });
  const TaskLimits limits{1, 10, [](std::uint64_t) { throw std::runtime_error("not mine"); }};
  EXPECT_EQ(thrown_by(tasks, worker, limits), "not mine");
  EXPECT_EQ(tasks.ended, std::vector<std::uint64_t>{5});
}

// -------------------------------------------------------------------------------------------------
// Other processes.

TEST(TaskMessages, OfReadingAreShortAndTellWhatIsTold) {
  ToldWorker worker([](const Task& task) -> std::string {
    if (number_of(task.name) == 1) {
      throw Error(ErrorCode::io_error, "no", "there");
    }
    return std::string(700, 'f') + std::to_string(task.bytes);
  });
  TaskList tasks(TaskKind::kScan, {1, 1}, 77);
  const Task first = tasks.take(), second = tasks.take();
  EXPECT_LT(message_of(first).size(), 1024U);
  const std::string answer = answer_to(task_in_message(message_of(first)), worker);
  EXPECT_LT(answer.size(), 1024U);
  take_answer(first.name, answer, tasks);
  EXPECT_EQ(tasks.results().at(first.name).told, std::string(700, 'f') + "77");
  try {
    take_answer(second.name, answer_to(task_in_message(message_of(second)), worker), tasks);
    ADD_FAILURE() << "no error";
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ErrorCode::io_error);
    EXPECT_EQ(e.message(), "no");
    EXPECT_EQ(e.context(), "there");
  }
}

TEST(ValueText, HoldsAPlainValue) {
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
