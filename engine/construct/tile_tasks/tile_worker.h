// SPDX-License-Identifier: GPL-3.0-or-later
//
// Does tasks: one of them at a time on each thread, from the files that it names to files again.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <stop_token>
#include <string>
#include <vector>

#include "engine/construct/hierarchy/tile_collapse.h"
#include "engine/construct/hierarchy/tile_files.h"
#include "engine/construct/tasks/task.h"
#include "engine/construct/tile/tile_tree.h"
#include "engine/construct/tile_tasks/segment_output.h"
#include "storage/file/file_layer.h"

namespace ptin {

/// What every worker of a build must agree on. Borrows what it names.
struct TaskSetup {
  const TileTree& tree;
  CollapseOptions collapse;
  std::function<LeafStarter()> make_starter;  ///< Called once for each thread.
  const SegmentPacker& packer;
  FileLayer& files;
  std::string folder;  ///< Of the tasks' files.
  /// Makes files durable before a task is done: for workers whose files another process syncs in
  /// vain, since they are in the cache of another machine.
  bool syncs = false;
  /// How long inputs are waited for that are not there yet (await_file()).
  std::chrono::milliseconds patience{0};
};

/// Threads: run() from several at once, each with a number of its own.
class TaskWorker {
 public:
  /// Told when a leaf is done, by any thread; may be empty.
  using LeafDone = std::function<void(TaskKind kind, std::uint64_t samples)>;

  TaskWorker(TaskSetup setup, LeafDone leaf_done)
      : setup_(std::move(setup)), leaf_done_(std::move(leaf_done)) {}

  /// Tells LeafDone the leaves of a task that another process did.
  void tell_done(const TaskName& name) const;
  /// Does a task. A file of its name that is there already is replaced.
  /// @param thread  Number of the calling thread, from 0.
  /// @throws DamagedInput  an input is not what its task wrote
  /// @throws Error as simplify(), the starters and the packer; cancelled; resource_exhausted,
  ///               io_error
  [[nodiscard]] TaskResult run(const Task& task, std::size_t thread, const std::stop_token& stop);

 private:
  using SharedSegment = std::shared_ptr<const SegmentFile>;

  TaskResult run_one(const Task& task, std::size_t thread, const std::stop_token& stop);
  TaskResult collapse(const TileId& top, const LeafStarter& start, const std::stop_token& stop);
  TaskResult join(const Task& task, const std::stop_token& stop);
  TaskResult tighten(const Task& task, const LeafStarter& start, const std::stop_token& stop);
  TaskResult close(const Task& task);
  TaskResult place(const Task& task);

  [[nodiscard]] ArrayFileWriter writer(const TileId& tile, TileFile file) const;
  void finish(ArrayFileWriter& file, ArrayFileFacts& facts) const;
  void write_pushed_of(const TileId& tile, const Tile& pushed, TaskResult& result) const;
  [[nodiscard]] LeafStarter starter(std::size_t thread);
  [[nodiscard]] SharedSegment segment_of(const InputFile& input);
  [[nodiscard]] std::shared_ptr<const Tin> coarsest(const InputFile& root);

  TaskSetup setup_;
  LeafDone leaf_done_;
  std::mutex mutex_;                   ///< Guards what follows.
  std::vector<LeafStarter> starters_;  ///< By thread; empty ones are made when they are asked for.
  std::map<TileId, std::weak_ptr<const SegmentFile>> segments_;  ///< Mapped while they are read.
  std::shared_ptr<const Tin> coarsest_;
};

}  // namespace ptin
