// SPDX-License-Identifier: GPL-3.0-or-later
//
// Which tasks of tiles may be done next, and what follows from those that are done.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <mutex>
#include <optional>
#include <set>
#include <vector>

#include "engine/construct/tasks/task_schedule.h"
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
/// What failed on a damaged input comes again, after the task that wrote the input.
class TileSchedule final : public TaskSchedule {
 public:
  /// Called with the samples and leaves that are done, by one thread at a time; may be empty.
  using Tell = std::function<void(const StageProgress& progress)>;
  /// Takes up what the log says is done. All arguments must outlive the schedule.
  TileSchedule(const TileTree& tree, const BatchOrder& order, const TaskMemory& memory,
               BuildLog& log, Tell tell);

  /// @throws Error resource_exhausted  a join needs more than there is
  [[nodiscard]] std::optional<std::uint64_t> next_bytes() const override;
  [[nodiscard]] Task take() override;
  /// @throws Error as the log and the output
  void done(const TaskName& name, const TaskResult& result) override;
  /// @throws Error  the damage, when the same file was written anew twice already
  void failed(const TaskName& name, const DamagedInput& damage) override;
  void progress(const TaskName& name, std::uint64_t done) override;
  void take_up(const TaskResults& results) override;
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
  /// Leaves, and the samples in them.
  struct Counts {
    std::uint64_t samples = 0, leaves = 0;
  };
  bool count(const TaskName& name, std::uint64_t done);

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
  Tell tell_;
  std::mutex mutex_;                    ///< Guards what follows.
  std::map<TaskName, Counts> counted_;  ///< What was done of each batch.
  std::map<TaskKind, Counts> all_;      ///< What was done of all batches.
};

}  // namespace ptin
