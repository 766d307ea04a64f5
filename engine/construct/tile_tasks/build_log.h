// SPDX-License-Identifier: GPL-3.0-or-later
//
// The log of a build: which tasks are done and what is written, in memory and in the manifest.
#pragma once

#include <chrono>
#include <cstdint>
#include <map>
#include <set>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "engine/construct/scratch/workspace.h"
#include "engine/construct/tile_tasks/segment_output.h"
#include "engine/construct/tile_tasks/task_graph.h"

namespace ptin {

/// Collects notes of finished work, and writes them to the manifest at checkpoints. A checkpoint
/// syncs the output and the temporary files that the notes name, then appends the notes to the
/// manifest, then removes the files that are superfluous by these notes. So the manifest never
/// speaks of work that is not durable. After a crash the work since the last checkpoint is done
/// again.
/// Threads: one at a time.
class BuildLog {
 public:
  /// Takes up the notes of an interrupted build, if the workspace has any, and sets the output back
  /// to the position that they name. Workspace and output must outlive the log.
  /// @param interval  Least time between checkpoints that are not forced.
  /// @throws Error as SegmentOutput::resume
  BuildLog(Workspace& workspace, SegmentOutput& output, std::chrono::milliseconds interval);

  [[nodiscard]] Workspace& workspace() const noexcept { return workspace_; }
  [[nodiscard]] SegmentOutput& output() const noexcept { return output_; }

  /// The tasks that are done, but for placing.
  [[nodiscard]] const TaskResults& results() const noexcept { return results_; }
  [[nodiscard]] bool is_done(const TaskName& name) const { return results_.contains(name); }
  /// Number of places of BatchOrder::output() whose segments are in the output.
  [[nodiscard]] std::uint64_t written() const noexcept { return written_; }

  void note_done(const TaskName& name, const TaskResult& result);
  /// Sets that number, and takes the position of the output, which stands at the end of these.
  void note_written(std::uint64_t written);
  /// Removes the file at the next checkpoint, when all notes so far are durable.
  void remove_later(const TileId& tile, TileFile file);
  /// Makes a checkpoint, unless the last one is more recent than the interval.
  /// @param force  A checkpoint in any case.
  /// @throws Error resource_exhausted, io_error
  void checkpoint(bool force);

 private:
  void take_up(const nlohmann::json& line);

  Workspace& workspace_;
  SegmentOutput& output_;
  std::chrono::milliseconds interval_;
  std::chrono::steady_clock::time_point last_ = std::chrono::steady_clock::now();
  TaskResults results_;
  std::uint64_t written_ = 0;
  nlohmann::json position_;  ///< The output's, at the last note_written().
  std::vector<nlohmann::json> lines_;
  std::set<std::string> unsynced_, superfluous_;  ///< Names of files.
};

}  // namespace ptin
