// SPDX-License-Identifier: GPL-3.0-or-later
//
// Errors of several threads at once.
#include <atomic>
#include <stdexcept>
#include <string>
#include <thread>

#include <gtest/gtest.h>

#include "tests/construct/listed_tasks.h"

namespace ptin {
namespace {

/// The one who gives back ends as the task does: whatever both write must be in order. Of two tasks the
/// second does not fit beside the first.
TEST(TaskDriver, StandsErrorsOfATaskAndOfGivingBackAtOnce) {
  for (int round = 0; round < 20; ++round) {
    std::atomic<bool> go_on = false;
    test::ListedTasks tasks({6, 6});
    test::ToldWorker worker([&](const Task&) -> std::string {
      while (!go_on) {
        std::this_thread::yield();
      }
      throw std::runtime_error("of the task");
    });
    const TaskLimits limits{2, 10, [&](std::uint64_t) {
                              go_on = true;
                              throw std::runtime_error("of giving back");
                            }};
    std::string thrown;
    try {
      TaskDriver().run(tasks, worker, limits, {});
    } catch (const std::exception& e) {
      thrown = e.what();
    }
    EXPECT_TRUE(thrown == "of the task" || thrown == "of giving back") << thrown;
  }
}

}  // namespace
}  // namespace ptin
