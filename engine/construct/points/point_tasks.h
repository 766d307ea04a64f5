// SPDX-License-Identifier: GPL-3.0-or-later
//
// Reading and sorting a source of points as tasks, each from files to files.
#pragma once

#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "engine/construct/grid/source_options.h"
#include "engine/construct/grid/source_stage.h"
#include "engine/construct/points/point_files.h"
#include "engine/construct/points/point_reading.h"
#include "engine/construct/points/sort_plan.h"
#include "engine/construct/scratch/array_file.h"

namespace ptin {

// The stages, in their order. What is told between processes are the facts of files.
inline constexpr const char* kReadingStage = "reading";      ///< Portions (points/point_reading.h).
inline constexpr const char* kSharingStage = "sharing out";  ///< Shares (points/point_shares.h).
inline constexpr const char* kSortingStage = "sorting";      ///< Ranges (points/range_buckets.h).

/// Does these tasks. Whoever gives the inputs and options of the build, and sees its folder, can do each
/// of them.
class PointTasks final : public StageWorker {
 public:
  PointTasks(std::vector<std::string> inputs, SourceOptions options, PointFiles files);
  ~PointTasks() override;

  /// @throws Error  as PortionReader::read(), share_out() and sort_range()
  [[nodiscard]] std::string run(const StageTask& task) override;

  /// A stage of reading, whose plan is written to a file.
  [[nodiscard]] SourceStage reading(const ReadingPlan& plan) const;
  /// What task `number` of it tells: the facts of what was read, or none where it has quotes.
  [[nodiscard]] static std::optional<ArrayFileFacts> portion_in(const std::string& told);
  /// A stage that shares out by a plan, which is kept for the tasks of this process.
  [[nodiscard]] SourceStage sharing(std::shared_ptr<const SortPlan> plan);
  /// A stage that sorts what that one shared out.
  /// @param told  By its tasks.
  [[nodiscard]] SourceStage sorting(const std::vector<std::string>& told);
  /// The facts that a task of the stages tells but that of reading.
  [[nodiscard]] static ArrayFileFacts facts_in(const std::string& told);

  [[nodiscard]] const PointFiles& files() const noexcept { return files_; }

 private:
  [[nodiscard]] std::string read(const StageTask& task);
  [[nodiscard]] std::shared_ptr<const SortPlan> plan_of(const ArrayFileFacts& facts);

  std::vector<std::string> inputs_;
  SourceOptions options_;
  PointFiles files_;
  PortionReader reader_;
  std::mutex mutex_;  ///< Guards the plan.
  ArrayFileFacts plan_facts_;
  std::shared_ptr<const SortPlan> plan_;
};

}  // namespace ptin
