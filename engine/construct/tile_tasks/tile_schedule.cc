// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/tile_tasks/tile_schedule.h"

#include <algorithm>
#include <tuple>
#include <utility>

#include "engine/check.h"

namespace ptin {

namespace {

/// How often a file may be found damaged before the disk is taken to be broken.
constexpr int kMostDamages = 3;

}  // namespace

TileSchedule::TileSchedule(const TileTree& tree, const BatchOrder& order, const TaskMemory& memory,
                           BuildLog& log, Tell tell)
    : tree_(tree),
      order_(order),
      graph_(tree, memory),
      log_(log),
      next_place_(static_cast<std::size_t>(log.written())),
      end_of_places_(log.output().page_bytes()),
      tell_(std::move(tell)) {
  for (const auto& [name, result] : log.results()) {
    follow(name);
    std::ignore = count(name, ~std::uint64_t{0});
  }
}

// -------------------------------------------------------------------------------------------------
// Handing out.

bool TileSchedule::are_inputs_there(const TaskName& name) const {
  const auto inputs = graph_.inputs_of(name);
  return std::all_of(inputs.begin(), inputs.end(), [&](const auto& input) {
    const TaskName producer = producer_of(input.first, input.second);
    return log_.is_done(producer) && !again_.contains(producer) && !running_.contains(producer);
  });
}

/// The first batch from `from` on that this was not done with.
std::optional<TaskName> TileSchedule::next_batch(TaskKind kind, std::size_t from) const {
  for (std::size_t i = from; i < order_.batches().size(); ++i) {
    const TaskName name{kind, order_.batches()[i]};
    if (!log_.is_done(name) && !again_.contains(name)) {
      return are_inputs_there(name) ? std::optional(name) : std::nullopt;
    }
  }
  return std::nullopt;
}

/// The first that can be handed out now.
std::optional<TaskName> TileSchedule::first_of(const std::set<TaskName>& names) const {
  const auto found = std::find_if(names.begin(), names.end(), [&](const TaskName& name) {
    return !running_.contains(name) && are_inputs_there(name);
  });
  return found == names.end() ? std::nullopt : std::optional(*found);
}

std::optional<TaskName> TileSchedule::next() const {
  if (const auto again = first_of(again_)) {
    return again;
  }
  if (!to_place_.empty() && are_inputs_there(to_place_.front())) {
    return to_place_.front();
  }
  if (const auto above = first_of(ready_)) {
    return above;
  }
  if (const auto batch = next_batch(TaskKind::kCollapse, next_collapse_)) {
    return batch;
  }
  return tree_.root().level > 1 ? next_batch(TaskKind::kTighten, next_tighten_) : std::nullopt;
}

std::optional<std::uint64_t> TileSchedule::next_bytes() const {
  const std::optional<TaskName> name = next();
  return name ? std::optional(graph_.bytes_of(*name, log_.results())) : std::nullopt;
}

Task TileSchedule::described(const TaskName& name) const {
  Task task = graph_.describe(name, log_.results());
  task.offset = name.kind == TaskKind::kPlace ? places_.at(name.tile) : 0;
  return task;
}

Task TileSchedule::take() {
  const std::optional<TaskName> name = next();
  PTIN_CHECK(name.has_value());
  running_[*name] = ++clock_;
  const auto pass = [&](std::size_t& batch) {
    while (batch < order_.batches().size() &&
           (log_.is_done({name->kind, order_.batches()[batch]}) ||
            order_.batches()[batch] == name->tile)) {
      ++batch;
    }
  };
  if (again_.contains(*name)) {
    return described(*name);  // stays there until it is done
  }
  if (name->kind == TaskKind::kPlace) {
    to_place_.pop_front();
  } else if (name->kind == TaskKind::kCollapse) {
    pass(next_collapse_);
  } else if (name->kind == TaskKind::kTighten) {
    pass(next_tighten_);
  } else {
    ready_.erase(*name);
  }
  return described(*name);
}

// -------------------------------------------------------------------------------------------------
// What follows.

void TileSchedule::done(const TaskName& name, const TaskResult& result) {
  progress(name, ~std::uint64_t{0});  // another process does not report how far it is
  running_.erase(name);
  const bool was_again = again_.erase(name) > 0;
  if (name.kind == TaskKind::kPlace) {
    placed_.insert(name.tile);
  } else {
    log_.note_done(name, result);
    follow(name);
    drop_inputs(name);
    if (was_again) {
      renewed_[name] = ++clock_;
      drop_what_nobody_needs(name);
    }
  }
  take_placed();
  log_.checkpoint(false);
}

void TileSchedule::take_up(const TaskResults& results) {
  for (const auto& [name, result] : results) {
    log_.note_done(name, result);
  }
  for (const auto& [name, result] : results) {
    follow(name);
  }
}

/// Makes a tile above ready when this task was done with all its children, unless that is past.
void TileSchedule::make_ready(TaskKind kind, const TileId& parent) {
  const TaskName name{kind, parent};
  if (!log_.is_done(name) && !running_.contains(name) && !again_.contains(name) &&
      are_inputs_there(name)) {
    ready_.insert(name);
  }
}

void TileSchedule::follow(const TaskName& name) {
  const bool is_root = name.tile == tree_.root();
  if (name.kind == TaskKind::kCollapse || name.kind == TaskKind::kJoin) {
    if (!is_root) {
      make_ready(TaskKind::kJoin, parent_of(name.tile));
    }
  } else if (!is_root) {
    make_ready(TaskKind::kClose, parent_of(name.tile));
  }
  find_places();
}

/// Removes what nobody reads any more. The last closing's bounds stay: T0 is finished with them.
void TileSchedule::drop_inputs(const TaskName& name) {
  if (name.kind == TaskKind::kJoin || name.kind == TaskKind::kClose) {
    for (const auto& [tile, file] : graph_.inputs_of(name)) {
      log_.remove_later(tile, file);
    }
  }
}

/// Gives pages their place, as far as the sizes of all before them are known.
void TileSchedule::find_places() {
  for (; next_place_ < order_.output().size(); ++next_place_) {
    const TileId& tile = order_.output()[next_place_];
    const auto result = log_.results().find(producer_of(tile, TileFile::kPages));
    if (result == log_.results().end()) {
      return;
    }
    places_[tile] = end_of_places_;
    to_place_.push_back({TaskKind::kPlace, tile});
    end_of_places_ += result->second.page_bytes;
  }
}

/// Adds to the output what is in its place, as far as nothing before it is missing.
void TileSchedule::take_placed() {
  while (!is_complete()) {
    const TileId& tile = order_.output()[static_cast<std::size_t>(log_.written())];
    const TaskName producer = producer_of(tile, TileFile::kDescriptions);
    if (!placed_.contains(tile) || again_.contains(producer)) {
      return;
    }
    try {
      add_segments(tile);
    } catch (const DamagedInput& damage) {
      write_again(damage);
      return;
    }
    placed_.erase(tile);
    places_.erase(tile);
    log_.remove_later(tile, TileFile::kPages);
    log_.remove_later(tile, TileFile::kDescriptions);
    log_.note_written(log_.written() + 1);
  }
}

void TileSchedule::add_segments(const TileId& tile) {
  const TaskName producer = producer_of(tile, TileFile::kDescriptions);
  const InputFile input{tile, TileFile::kDescriptions,
                        log_.results().at(producer).facts(TileFile::kDescriptions)};
  std::vector<PreparedSegment> segments;  // all are sound before the first is added
  read_input(log_.workspace().temporary_folder(), input, [&](ArrayFileReader& file) {
    while (!file.at_end()) {
      file.values(segments.emplace_back());
    }
  });
  for (const PreparedSegment& segment : segments) {
    log_.output().add(segment);
  }
}

// -------------------------------------------------------------------------------------------------
// Progress.

/// Counts those leaves of a batch that are done, by the samples of them that are.
/// @return  Whether there are more than before: a batch that is done again counts once.
bool TileSchedule::count(const TaskName& name, std::uint64_t done) {
  if (name.kind != TaskKind::kCollapse && name.kind != TaskKind::kTighten) {
    return false;
  }
  Counts now;
  for (const TileId& leaf : leaves_of_batch(tree_, name.tile)) {
    const std::uint64_t samples = tree_.window(leaf).samples();
    if (now.samples + samples > done) {
      break;
    }
    now.samples += samples;
    ++now.leaves;
  }
  Counts& before = counted_[name];
  if (now.leaves <= before.leaves) {
    return false;
  }
  all_[name.kind].samples += now.samples - before.samples;
  all_[name.kind].leaves += now.leaves - before.leaves;
  before = now;
  return true;
}

void TileSchedule::progress(const TaskName& name, std::uint64_t done) {
  const std::lock_guard lock(mutex_);
  if (count(name, done) && tell_) {
    const std::uint64_t all = tree_.window(tree_.root()).samples();
    const Counts& counts = all_[name.kind];
    tell_({stage_of(name.kind), std::min(counts.samples, all), all, counts.leaves, tree_.leaves()});
  }
}

// -------------------------------------------------------------------------------------------------
// Damage.

/// Removes files of a task that was done again for the sake of another one, where their readers are
/// done already.
void TileSchedule::drop_what_nobody_needs(const TaskName& name) {
  const auto drop_after = [&](TileFile file, const TaskName& reader) {
    if (log_.is_done(reader) && !again_.contains(reader)) {
      log_.remove_later(name.tile, file);
    }
  };
  if (producer_of(name.tile, TileFile::kPages) == name &&
      order_.place_of(name.tile) < log_.written()) {
    log_.remove_later(name.tile, TileFile::kPages);
    log_.remove_later(name.tile, TileFile::kDescriptions);
  }
  if (name.kind == TaskKind::kJoin) {
    drop_after(TileFile::kSegment, {TaskKind::kClose, name.tile});
  }
  if (name.tile != tree_.root()) {
    const TileId parent = parent_of(name.tile);
    const bool collapses = name.kind == TaskKind::kCollapse || name.kind == TaskKind::kJoin;
    drop_after(collapses ? TileFile::kPushed : TileFile::kBounds,
               {collapses ? TaskKind::kJoin : TaskKind::kClose, parent});
  }
}

void TileSchedule::write_again(const DamagedInput& damage) {
  const TaskName name = damage.producer();
  if (running_.contains(name) || again_.contains(name)) {
    return;  // somebody met the same damage before
  }
  if (++damages_[name] == kMostDamages) {
    throw Error(
        damage.code(),
        damage.message() + "; it was written anew, and is damaged again: is the disk sound?",
        damage.context());
  }
  again_.insert(name);
}

void TileSchedule::failed(const TaskName& name, const DamagedInput& damage) {
  const auto renewed = renewed_.find(damage.producer());
  const bool read_the_new = renewed == renewed_.end() || renewed->second < running_.at(name);
  running_.erase(name);
  again_.insert(name);
  if (read_the_new) {
    write_again(damage);
  }
}

}  // namespace ptin
