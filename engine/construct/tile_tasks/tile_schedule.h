// SPDX-License-Identifier: GPL-3.0-or-later
//
// Which tasks of a build may be done next, and what follows from those that are done.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <set>
#include <vector>

#include "engine/construct/tasks/task.h"
#include "engine/construct/tile_tasks/batch_order.h"
#include "engine/construct/tile_tasks/build_log.h"
#include "engine/construct/tile_tasks/task_graph.h"

namespace ptin {

/// Hands out the tasks of a build, whoever does them. Batches come in their order; a tile above them
/// comes as soon as its children are done, and before the next batch, since it makes their files
/// superfluous. When the root is collapsed, batches are tightened in the same order, and tiles above
/// closed. Pages are placed in the order of BatchOrder::output() as far as it is complete: they lie
/// where the sizes of those before them say, so several tasks place pages at once; descriptions are
/// added to the output behind them.
///
/// A task that was handed out is either done or failed. What failed on a damaged input comes again,
/// after the task that wrote the input.
/// Threads: one at a time.
class TaskSchedule {
 public:
  /// Takes up what the log says is done. All arguments must outlive the schedule.
  TaskSchedule(const TileTree& tree, const BatchOrder& order, const TaskMemory& memory,
               BuildLog& log);

  /// Memory that the next task takes, in bytes. None when there is no task to hand out, or when
  /// those left must wait for one that is being done.
  /// @throws Error resource_exhausted  a join needs more than there is
  [[nodiscard]] std::optional<std::uint64_t> next_bytes() const;
  /// Hands that task out. REQUIRES: next_bytes() has a value.
  [[nodiscard]] Task take();
  /// To be called when a task was done.
  /// @throws Error as the log and the output
  void done(const TaskName& name, const TaskResult& result);
  /// To be called when a task met a damaged input.
  /// @throws Error  the damage, when the same file was written anew twice already
  void failed(const TaskName& name, const DamagedInput& damage);
  /// Takes up what was done elsewhere, before anything is handed out.
  void take_up(const TaskResults& results);
  /// To be called when somebody else met a damaged file of a task: it is done again.
  /// @throws Error  as failed()
  void write_again(const DamagedInput& damage);

  /// True when all segments are in the output.
  [[nodiscard]] bool is_complete() const { return log_.written() == order_.output().size(); }

 private:
  [[nodiscard]] std::optional<TaskName> next() const;
  [[nodiscard]] std::optional<TaskName> first_of(const std::set<TaskName>& names) const;
  [[nodiscard]] std::optional<TaskName> next_batch(TaskKind kind, std::size_t from) const;
  [[nodiscard]] Task described(const TaskName& name) const;
  [[nodiscard]] bool are_inputs_there(const TaskName& name) const;
  void follow(const TaskName& name);
  void make_ready(TaskKind kind, const TileId& parent);
  void drop_inputs(const TaskName& name);
  void find_places();
  void take_placed();
  void add_segments(const TileId& tile);
  void drop_what_nobody_needs(const TaskName& name);

  const TileTree& tree_;
  const BatchOrder& order_;
  TaskGraph graph_;
  BuildLog& log_;
  std::size_t next_collapse_ = 0, next_tighten_ = 0;  ///< Batches before these are handed out.
  std::set<TaskName> ready_;  ///< Joins and closings whose children are done.
  std::set<TaskName> again_;  ///< To be done again, or tried again.
  std::uint64_t clock_ = 0;   ///< Counts what is handed out and what is done again.
  std::map<TaskName, std::uint64_t> running_;  ///< Handed out, and when.
  std::map<TaskName, std::uint64_t> renewed_;  ///< When tasks were done again.
  std::map<TaskName, int> damages_;            ///< How often files of a task were damaged.
  std::deque<TaskName> to_place_;              ///< Known places, not handed out.
  std::map<TileId, std::uint64_t> places_;     ///< Offsets of pages that are not in the output yet.
  std::set<TileId> placed_;      ///< Pages in their place, ahead of those before them.
  std::size_t next_place_;       ///< In BatchOrder::output(): the first without a place.
  std::uint64_t end_of_places_;  ///< Where its pages go.
};

}  // namespace ptin
