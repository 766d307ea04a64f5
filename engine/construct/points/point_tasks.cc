// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/points/point_tasks.h"

#include <algorithm>
#include <utility>

#include "engine/construct/grid/point_sorter.h"
#include "engine/construct/points/point_shares.h"
#include "engine/construct/points/range_buckets.h"
#include "engine/error.h"

namespace ptin {

namespace {

// Files of plans, of which there is one at a time.
constexpr const char* kReadingPlan = "portions";
constexpr const char* kSortPlan = "plan";
constexpr const char* kSharedPlan = "shares";

/// Bytes that any task takes for blocks, buffers and what it knows of files.
constexpr std::uint64_t kTaskBytes = std::uint64_t{2} << 20;

}  // namespace

PointTasks::PointTasks(std::vector<std::string> inputs, SourceOptions options, PointFiles files)
    : inputs_(std::move(inputs)),
      options_(std::move(options)),
      files_(std::move(files)),
      reader_(inputs_, options_, files_) {}

TaskList PointTasks::reading(const ReadingPlan& plan) const {
  ArrayFileWriter file(files_.files, files_.path(kReadingPlan, 0));
  file.values(plan);
  std::vector<std::uint64_t> sizes;
  for (const PointPortion& portion : plan.portions) {
    sizes.push_back(portion.bytes);
  }
  return {TaskKind::kRead, std::move(sizes), kTaskBytes, file.finish()};
}

ArrayFileFacts PointTasks::read(const Task& task) {
  ArrayFileReader file = files_.open(files_.path(kReadingPlan, 0), task.inputs.at(0).facts);
  ReadingPlan plan;
  file.values(plan);
  const std::size_t number = number_of(task.name);
  return reader_.read(plan.portions.at(number), plan.first_number + number, task)
      .value_or(ArrayFileFacts{});
}

TaskList PointTasks::sharing(std::shared_ptr<const SortPlan> plan) {
  ArrayFileWriter file(files_.files, files_.path(kSortPlan, 0));
  file.values(*plan);
  const std::lock_guard lock(mutex_);
  plan_ = std::move(plan);
  plan_facts_ = file.finish();
  const std::uint64_t size = std::max<std::uint64_t>(plan_->points / plan_->shares, 1);
  return {TaskKind::kShare, std::vector<std::uint64_t>(plan_->shares, size),
          kTaskBytes + plan_->ranges() * plan_->block_records * sizeof(NumberedHeight),
          plan_facts_};
}

TaskList PointTasks::sorting(const std::vector<ArrayFileFacts>& shares) {
  ArrayFileWriter file(files_.files, files_.path(kSharedPlan, 0));
  const std::lock_guard lock(mutex_);
  file.values(plan_facts_, shares);
  const std::uint64_t size = std::max<std::uint64_t>(plan_->points / plan_->ranges(), 1);
  return {TaskKind::kSort, std::vector<std::uint64_t>(plan_->ranges(), size),
          kTaskBytes + plan_->least_memory, file.finish()};
}

/// The plan, which is read once.
std::shared_ptr<const SortPlan> PointTasks::plan_of(const ArrayFileFacts& facts) {
  const std::lock_guard lock(mutex_);
  if (plan_ == nullptr || plan_facts_ != facts) {
    plan_.reset();
    ArrayFileReader file = files_.open(files_.path(kSortPlan, 0), facts);
    auto plan = std::make_shared<SortPlan>();
    file.values(*plan);
    plan_ = std::move(plan);
    plan_facts_ = facts;
  }
  return plan_;
}

ArrayFileFacts PointTasks::index_of(const Task& task) {
  if (task.name.kind == TaskKind::kRead) {
    return read(task);
  }
  const ArrayFileFacts& plan_of_task = task.inputs.at(0).facts;
  if (task.name.kind == TaskKind::kShare) {
    return share_out(*plan_of(plan_of_task), files_, task);
  }
  ArrayFileReader file = files_.open(files_.path(kSharedPlan, 0), plan_of_task);
  ArrayFileFacts plan;
  std::vector<ArrayFileFacts> shares;
  file.values(plan, shares);
  return sort_range(*plan_of(plan), shares, files_, task);
}

TaskResult PointTasks::run(const Task& task) {
  TaskResult result;
  result.facts(TileFile::kIndex) = index_of(task);
  return result;
}

}  // namespace ptin
