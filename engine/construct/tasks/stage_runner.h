// SPDX-License-Identifier: GPL-3.0-or-later
//
// Runs the tasks of a stage of reading on threads of this process.
#pragma once

#include <cstdint>
#include <functional>
#include <mutex>
#include <stop_token>
#include <string>
#include <vector>

#include "engine/construct/grid/source_stage.h"

namespace ptin {

struct StageLimits {
  int threads = 1;
  std::uint64_t memory = 0;  ///< Bytes, for all tasks that run at once in one process.
  std::stop_token stop;
  /// Told how much is done, of how much. Never called by two threads at once; may be empty.
  std::function<void(std::uint64_t done, std::uint64_t total)> progress;
};

/// Adds up the progress of the tasks of a stage, and tells it. Threads: any number.
class StageCount {
 public:
  /// Both must outlive the count.
  StageCount(const SourceStage& stage, const StageLimits& limits);

  /// @param done  Of the task's size; never less than what was told before.
  void tell(std::size_t number, std::uint64_t done);
  void tell_all_of(std::size_t number) { tell(number, stage_.sizes[number]); }

 private:
  const SourceStage& stage_;
  const StageLimits& limits_;
  std::mutex mutex_;
  std::vector<std::uint64_t> done_;  ///< By task.
  std::uint64_t all_done_ = 0, total_ = 0;
};

/// As RunStage. When a task fails, those of lower numbers go on to their end, since their errors
/// come first.
[[nodiscard]] std::vector<std::string> run_stage(const SourceStage& stage, StageWorker& worker,
                                                 const StageLimits& limits);

}  // namespace ptin
