// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/tasks/task_driver.h"

#include <utility>

namespace ptin {

namespace {

class TaskPieces final : public PieceSource {
 public:
  TaskPieces(TaskSchedule& schedule, TaskWorker& worker) : schedule_(schedule), worker_(worker) {}

  [[nodiscard]] std::optional<std::uint64_t> next_bytes() override {
    return schedule_.next_bytes();
  }

  [[nodiscard]] Piece take(int thread) override {
    const Task task = schedule_.take();
    return {task.bytes, [this, task, thread](const std::stop_token& stop) {
              return run(task, static_cast<std::size_t>(thread), stop);
            }};
  }

 private:
  std::function<void()> run(const Task& task, std::size_t thread, const std::stop_token& stop) {
    try {
      return [this, name = task.name, result = worker_.run(task, thread, stop)] {
        schedule_.done(name, result);
      };
    } catch (const DamagedInput& damage) {
      return [this, name = task.name, damage] { schedule_.failed(name, damage); };
    }
  }

  TaskSchedule& schedule_;
  TaskWorker& worker_;
};

}  // namespace

void TaskDriver::begin_reading(const BuildNote& /*note*/) {}

std::vector<std::string> TaskDriver::run_stage(const SourceStage& stage, StageWorker& worker,
                                               const StageLimits& limits) {
  return ptin::run_stage(stage, worker, limits);
}

bool TaskDriver::begin(const BuildNote& /*note*/) { return true; }

std::uint64_t ThreadDriver::run(TaskSchedule& schedule, TaskWorker& worker,
                                const PieceLimits& limits, const std::stop_token& stop) {
  TaskPieces pieces(schedule, worker);
  return run_pieces(pieces, limits, stop);
}

}  // namespace ptin
