// SPDX-License-Identifier: GPL-3.0-or-later
//
// What each task of a build reads and takes: a function of the tree of tiles, and of the results of
// the tasks before it.
#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "engine/construct/hierarchy/tile_bytes.h"
#include "engine/construct/tasks/task.h"
#include "engine/construct/tile/tile_tree.h"

namespace ptin {

/// What the tasks of a build may take.
struct TaskMemory {
  TileBytes tile_bytes;                         ///< What each kind of task takes.
  std::uint64_t for_tiles = ~std::uint64_t{0};  ///< Bytes, for all tasks of one process at once.
  /// Bytes for reading the source, besides. The last join takes them too: nothing is read beside it.
  std::uint64_t for_reading = 0;
};

/// A task that is done with its result, as one line of a manifest.
[[nodiscard]] nlohmann::json line_of(const TaskName& name, const TaskResult& result);
/// Takes such a line up; lines of other kinds are left alone.
void take_line(const nlohmann::json& line, TaskResults& results);

/// Threads: any number at once.
class TaskGraph {
 public:
  /// `tree` and `memory` must outlive the graph.
  TaskGraph(const TileTree& tree, const TaskMemory& memory) : tree_(tree), memory_(memory) {}

  /// The files that a task reads, in the order of Task::inputs.
  [[nodiscard]] std::vector<std::pair<TileId, TileFile>> inputs_of(const TaskName& name) const;
  /// Memory that a task takes, in bytes, by estimate.
  /// @param results  Results of the tasks that write its inputs, at least.
  /// @throws Error resource_exhausted  a join needs more than there is
  [[nodiscard]] std::uint64_t bytes_of(const TaskName& name, const TaskResults& results) const;
  /// True when the results of all tasks that write its inputs are there.
  [[nodiscard]] bool can_be_done(const TaskName& name, const TaskResults& results) const;
  /// The task as a worker is given it, but for Task::offset.
  /// @throws Error as bytes_of()
  [[nodiscard]] Task describe(const TaskName& name, const TaskResults& results) const;

 private:
  [[nodiscard]] std::uint64_t bytes_of_join(const TileId& id, const TaskResults& results) const;

  const TileTree& tree_;
  const TaskMemory& memory_;
};

}  // namespace ptin
