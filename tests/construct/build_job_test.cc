// SPDX-License-Identifier: GPL-3.0-or-later
//
// How a job shares threads and memory out to the tasks that read its source.
#include "engine/construct/build_job.h"

#include <cstdint>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tests/construct/listed_tasks.h"

namespace ptin {
namespace {

/// Notes how many threads it may take.
class NotesThreads final : public TaskDriver {
 public:
  std::uint64_t run(TaskSchedule& schedule, TaskWorker& worker, const TaskLimits& limits,
                    const std::stop_token& stop) override {
    threads = limits.threads;
    return TaskDriver::run(schedule, worker, limits, stop);
  }
  int threads = 0;
};

/// The threads that so many tasks run on, and the bytes that each may sort in. They take so many bytes
/// each at least; 1000 bytes are there for sorting and 2^40 for all, and a job may take two threads.
std::string shares_of(std::size_t tasks, std::uint64_t bytes) {
  const std::vector<std::string> inputs;
  const std::string output;
  const BuildOptions options;
  NotesThreads driver;
  BuildResources resources;
  resources.threads = 2;
  resources.driver = &driver;
  MemoryPlan memory;
  memory.limit = std::uint64_t{1} << 40;
  memory.sorting = 1000;
  const build_internal::Job job{inputs, output, options, resources, memory, {}};
  test::ToldWorker worker([](const Task& task) { return std::to_string(task.bytes); });
  TaskList list(TaskKind::kRead, std::vector<std::uint64_t>(tasks, 1), bytes);
  job.run_tasks()(list, worker);
  std::string shares = std::to_string(driver.threads) + ":";
  for (const auto& [name, result] : list.results()) {
    shares += " " + result.told;
  }
  return shares;
}

TEST(Job, SharesMemoryForSortingAmongTheTasksThatRunAtOnce) {
  EXPECT_EQ(shares_of(4, 0), "2: 500 500 500 500");
  EXPECT_EQ(shares_of(1, 0), "1: 1000") << "nothing runs beside it";
  constexpr std::uint64_t kMoreThanHalf = std::uint64_t{3} << 38;
  EXPECT_EQ(shares_of(3, kMoreThanHalf), "1: 1000 1000 1000") << "the memory holds one at a time";
  EXPECT_EQ(shares_of(2, std::uint64_t{1} << 41), "1: 1000 1000")
      << "it holds none, and one is tried";
}

}  // namespace
}  // namespace ptin
