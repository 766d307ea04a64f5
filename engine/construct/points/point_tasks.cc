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

constexpr const char* kQuotes = "quotes";  ///< A task's word for a portion that has them.

}  // namespace

PointTasks::PointTasks(std::vector<std::string> inputs, SourceOptions options, PointFiles files)
    : inputs_(std::move(inputs)),
      options_(std::move(options)),
      files_(std::move(files)),
      reader_(inputs_, options_, files_) {}

PointTasks::~PointTasks() = default;

SourceStage PointTasks::reading(const ReadingPlan& plan) const {
  ArrayFileWriter file(files_.files, files_.path(kReadingPlan, 0));
  put(file, plan);
  SourceStage stage{kReadingStage, {}, text_of_value(file.finish()), kTaskBytes};
  for (const PointPortion& portion : plan.portions) {
    stage.sizes.push_back(portion.bytes);
  }
  return stage;
}

std::string PointTasks::read(const StageTask& task) {
  ArrayFileReader file = files_.open(files_.path(kReadingPlan, 0), facts_in(task.facts));
  const ReadingPlan plan = take_reading_plan(file);
  const auto facts =
      reader_.read(plan.portions.at(task.number), plan.first_number + task.number, task);
  return facts ? text_of_value(*facts) : kQuotes;
}

std::optional<ArrayFileFacts> PointTasks::portion_in(const std::string& told) {
  return told == kQuotes ? std::nullopt : std::optional(facts_in(told));
}

ArrayFileFacts PointTasks::facts_in(const std::string& told) {
  return value_in_text<ArrayFileFacts>(told);
}

SourceStage PointTasks::sharing(std::shared_ptr<const SortPlan> plan) {
  ArrayFileWriter file(files_.files, files_.path(kSortPlan, 0));
  put(file, *plan);
  const std::lock_guard lock(mutex_);
  plan_ = std::move(plan);
  plan_facts_ = file.finish();
  const std::vector<std::uint64_t> sizes(plan_->shares,
                                         std::max<std::uint64_t>(plan_->points / plan_->shares, 1));
  return {kSharingStage, sizes, text_of_value(plan_facts_),
          kTaskBytes + plan_->ranges() * plan_->block_records * sizeof(NumberedHeight)};
}

SourceStage PointTasks::sorting(const std::vector<std::string>& told) {
  ArrayFileWriter file(files_.files, files_.path(kSharedPlan, 0));
  std::vector<ArrayFileFacts> shares;
  shares.reserve(told.size());
  for (const std::string& facts : told) {
    shares.push_back(facts_in(facts));
  }
  const std::lock_guard lock(mutex_);
  file.put(std::span<const ArrayFileFacts>(&plan_facts_, 1));
  file.put(shares);
  const std::vector<std::uint64_t> sizes(
      plan_->ranges(), std::max<std::uint64_t>(plan_->points / plan_->ranges(), 1));
  return {kSortingStage, sizes, text_of_value(file.finish()), kTaskBytes + plan_->least_memory};
}

/// The plan, which is read once.
std::shared_ptr<const SortPlan> PointTasks::plan_of(const ArrayFileFacts& facts) {
  const std::lock_guard lock(mutex_);
  if (plan_ == nullptr || plan_facts_ != facts) {
    plan_.reset();
    ArrayFileReader file = files_.open(files_.path(kSortPlan, 0), facts);
    plan_ = std::make_shared<const SortPlan>(take_sort_plan(file));
    plan_facts_ = facts;
  }
  return plan_;
}

std::string PointTasks::run(const StageTask& task) {
  if (task.name == kReadingStage) {
    return read(task);
  }
  if (task.name == kSharingStage) {
    return text_of_value(share_out(*plan_of(facts_in(task.facts)), files_, task));
  }
  ArrayFileReader file = files_.open(files_.path(kSharedPlan, 0), facts_in(task.facts));
  const ArrayFileFacts plan = file.take_copy<ArrayFileFacts>()[0];
  const std::vector<ArrayFileFacts> shares = file.take_copy<ArrayFileFacts>();
  return text_of_value(sort_range(*plan_of(plan), shares, files_, task));
}

}  // namespace ptin
