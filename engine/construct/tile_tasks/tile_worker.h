// SPDX-License-Identifier: GPL-3.0-or-later
//
// Does tasks of tiles, from the files that they name to files again.
#pragma once

#include <chrono>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
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
  std::function<LeafStarter()> make_starter;  ///< Called once for each task that runs at once.
  const SegmentPacker& packer;
  FileLayer& files;
  std::string folder;  ///< Folder of the tasks' files.
  /// Makes files durable before a task is done: for workers whose files another process syncs in
  /// vain, since they are in the cache of another machine.
  bool syncs = false;
  /// How long inputs are waited for that are not there yet (await_file()).
  std::chrono::milliseconds patience{0};
};

class TileWorker final : public TaskWorker {
 public:
  explicit TileWorker(TaskSetup setup) : setup_(std::move(setup)) {}

  /// @throws Error as simplify(), the starters and the packer; cancelled; resource_exhausted,
  ///               io_error
  [[nodiscard]] TaskResult run(const Task& task) override;

 private:
  using SharedSegment = std::shared_ptr<const SegmentFile>;

  TaskResult run_one(const Task& task);
  TaskResult collapse(const Task& task);
  TaskResult join(const Task& task);
  TaskResult tighten(const Task& task);
  TaskResult close(const Task& task);
  TaskResult place(const Task& task);

  [[nodiscard]] ArrayFileWriter writer(const TileId& tile, TileFile file) const;
  void finish(ArrayFileWriter& file, ArrayFileFacts& facts) const;
  void write_pushed_of(const TileId& tile, const Tile& pushed, TaskResult& result) const;
  [[nodiscard]] LeafStarter take_starter();
  void put_back(LeafStarter starter);
  [[nodiscard]] SharedSegment segment_of(const InputFile& input);
  [[nodiscard]] std::shared_ptr<const Tin> coarsest(const InputFile& root);

  TaskSetup setup_;
  std::mutex mutex_;                                             ///< Guards what follows.
  std::vector<LeafStarter> starters_;                            ///< Those that no task uses.
  std::map<TileId, std::weak_ptr<const SegmentFile>> segments_;  ///< Mapped while they are read.
  std::shared_ptr<const Tin> coarsest_;
};

}  // namespace ptin
