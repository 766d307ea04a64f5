// SPDX-License-Identifier: GPL-3.0-or-later
//
// What each task of a build takes, for bench/cluster.py: builds with one worker that syncs its files, as
// a rank of an MPI job does, and writes a line of JSON for each task and for what is no task. It cannot
// show what workers take from each other: for that, start several at once.
//   cluster_times INPUT OUT.jsonl [--tile SIDE] [--memory MIB]
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <memory>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

#include "engine/construct/build.h"
#include "engine/construct/build_worker.h"
#include "engine/construct/tasks/task_driver.h"
#include "engine/construct/tasks/task_messages.h"
#include "engine/error.h"
#include "engine/memory_units.h"
#include "tools/kept_memory.h"

namespace {

using ptin::Task;
using ptin::TaskResult;

/// Seconds of the processor, by all threads.
double processor_seconds() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

class Stopwatch {
 public:
  /// Seconds since the last call.
  double lap() {
    const auto now = std::chrono::steady_clock::now();
    const std::chrono::duration<double> passed = now - last_;
    last_ = now;
    return passed.count();
  }

 private:
  std::chrono::steady_clock::time_point last_ = std::chrono::steady_clock::now();
};

/// Does with freed memory what `ptin build` does.
class Memory final : public ptin::BuildObserver {
 public:
  Memory() { ptin::tools::return_freed_memory(1); }
  void plan(const ptin::BuildPlan& plan) override { ptin::tools::keep_freed_memory(plan); }
  void progress(const ptin::StageProgress& /*progress*/) override {}
  void give_back_memory() override { ptin::tools::give_back_freed_memory(); }
};

class TimedTasks final : public ptin::TaskDriver {
 public:
  TimedTasks(const std::vector<std::string>& inputs, const ptin::BuildOptions& options,
             const ptin::BuildResources& resources, std::ofstream& out)
      : inputs_(inputs), options_(options), resources_(resources), out_(out) {}

  [[nodiscard]] bool begin(const ptin::BuildNote& note) override {
    if (note.index.is_null()) return true;
    tell("reading");
    worker_ =
        std::make_unique<ptin::BuildWorker>(inputs_, options_, resources_, ptin::message_of(note));
    tell("opening");
    return true;
  }

  std::uint64_t run(ptin::TaskSchedule& schedule, ptin::TaskWorker& worker,
                    const ptin::TaskLimits& limits, const std::stop_token& stop) override {
    if (!worker_) return TaskDriver::run(schedule, worker, limits, stop);  // it is being read
    std::uint64_t most_bytes = 0;
    double last = processor_seconds(), scheduling = 0.0;
    const auto lap = [&last] {
      const double now = processor_seconds();
      return now - std::exchange(last, now);
    };
    while (schedule.next_bytes()) {
      const Task task = schedule.take();
      const double before = watch_.lap();
      scheduling += lap();
      const TaskResult result = worker_->tasks().run(task);
      const double seconds = watch_.lap();
      std::ignore = lap();
      schedule.done(task.name, result);
      scheduling += lap();
      tell(task, result, before, seconds);
      std::ignore = lap();
      most_bytes = std::max(most_bytes, task.bytes);
    }
    scheduling += lap();
    out_ << nlohmann::json{{"scheduling", scheduling}, {"processor", processor_seconds()}} << "\n";
    return most_bytes;
  }

  void tell(const char* stage) {
    out_ << nlohmann::json{{"stage", stage}, {"seconds", watch_.lap()}} << "\n";
  }

 private:
  void tell(const Task& task, const TaskResult& result, double before, double seconds) {
    std::uint64_t in = 0, out = 0;
    for (const ptin::InputFile& input : task.inputs) in += input.facts.bytes;
    nlohmann::json files = nlohmann::json::array();
    for (const ptin::ArrayFileFacts& f : result.files) {
      out += f.bytes;
      files.push_back(f.bytes);
    }
    const bool is_tile = task.name.kind == ptin::TaskKind::kCollapse;
    const std::uint64_t samples =
        is_tile ? worker_->tree().window(task.name.tile).samples() : std::uint64_t{0};
    out_ << nlohmann::json{{"task", static_cast<int>(task.name.kind)},
                           {"tile", {task.name.tile.level, task.name.tile.x, task.name.tile.y}},
                           {"seconds", seconds},
                           {"schedule_seconds", before + watch_.lap()},
                           {"samples", samples},
                           {"in", in},
                           {"out", out},
                           {"files", files},
                           {"page_bytes", result.page_bytes},
                           {"memory", task.bytes}}
         << "\n";
    watch_.lap();
  }

  const std::vector<std::string>& inputs_;
  const ptin::BuildOptions& options_;
  const ptin::BuildResources& resources_;
  std::ofstream& out_;
  std::unique_ptr<ptin::BuildWorker> worker_;
  Stopwatch watch_;
};

int run(const std::vector<std::string>& arguments) {
  const std::vector<std::string> inputs{arguments.at(0)};
  std::ofstream out(arguments.at(1));
  ptin::BuildOptions options;
  ptin::BuildResources resources;
  for (std::size_t i = 2; i + 1 < arguments.size(); i += 2) {
    const auto value = static_cast<std::uint64_t>(std::stoll(arguments[i + 1]));
    if (arguments[i] == "--tile") options.tile = static_cast<std::int64_t>(value);
    if (arguments[i] == "--memory") resources.memory_bytes = value * ptin::kMiB;
  }
  Memory memory;
  resources.observer = &memory;
  TimedTasks driver(inputs, options, resources, out);
  ptin::BuildResources timed = resources;
  timed.driver = &driver;
  timed.overwrite = true;
  const std::string output = arguments.at(1) + ".ptin";
  const ptin::BuildReport report = ptin::build(inputs, output, options, timed);
  driver.tell("publishing");
  out << nlohmann::json{{"total", report.seconds},
                        {"samples", report.source_samples},
                        {"records", report.records},
                        {"bytes", report.file_bytes}}
      << "\n";
  std::filesystem::remove(output);
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 3) {
    std::fprintf(stderr, "usage: cluster_times INPUT OUT.jsonl [--tile SIDE] [--memory MIB]\n");
    return 2;
  }
  try {
    return run({argv + 1, argv + argc});
  } catch (const std::exception& e) {
    std::fprintf(stderr, "cluster_times: %s\n", e.what());
    return 1;
  }
}
