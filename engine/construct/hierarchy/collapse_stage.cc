// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/hierarchy/collapse_stage.h"

#include <algorithm>
#include <utility>

#include "engine/construct/hierarchy/tile_collapse.h"
#include "engine/construct/hierarchy/tile_files.h"
#include "engine/error.h"
#include "engine/memory_units.h"

namespace ptin {

CollapseStage::CollapseStage(const std::function<LeafStarter()>& make_starter, const TileTree& tree,
                             const BatchOrder& order, const HierarchyOptions& options,
                             BuildLog& log)
    : tree_(tree), order_(order), options_(options), log_(log), segments_(log, order) {
  for (int i = 0; i < options.threads; ++i) {
    starters_.push_back(make_starter());
  }
  for (const Batch& batch : order.batches()) {
    if (log.collapsed().contains(batch.top)) {
      samples_done_ += tree.window(batch.top).samples();
      leaves_done_ += batch.leaves.size();
    }
  }
  for (const auto& [id, tile] : log.collapsed()) {
    look_for_parent(id);
  }
  segments_.advance();
  skip_done_batches();
}

void CollapseStage::skip_done_batches() {
  while (next_batch_ < order_.batches().size() &&
         log_.collapsed().contains(order_.batches()[next_batch_].top)) {
    ++next_batch_;
  }
}

/// Makes the parent of a collapsed tile ready when all its children are collapsed.
void CollapseStage::look_for_parent(const TileId& id) {
  const TileId parent = BatchOrder::parent_of(id);
  if (id == tree_.root() || log_.collapsed().contains(parent)) {
    return;
  }
  const std::vector<TileId> children = tree_.children(parent);
  if (std::all_of(children.begin(), children.end(),
                  [&](const TileId& child) { return log_.collapsed().contains(child); })) {
    ready_.insert(parent);
  }
}

std::optional<std::uint64_t> CollapseStage::next_bytes() {
  if (!ready_.empty()) {
    std::uint64_t pushed = 0;
    for (const TileId& child : tree_.children(*ready_.begin())) {
      pushed += log_.collapsed().at(child).pushed.bytes;
    }
    const std::uint64_t bytes = options_.tile_bytes.of_join(pushed);
    const std::uint64_t most = options_.memory_for_tiles +
                               (*ready_.begin() == tree_.root() ? options_.memory_for_reading : 0);
    if (bytes > most) {  // the terrain keeps more than the plan expected
      refuse_join(bytes - most);
    }
    return bytes;
  }
  if (next_batch_ == order_.batches().size()) {
    return std::nullopt;
  }
  return options_.tile_bytes.of_batch(
      BatchOrder::largest_leaf(tree_, order_.batches()[next_batch_]));
}

void CollapseStage::refuse_join(std::uint64_t missing) {
  throw Error(ErrorCode::resource_exhausted,
              "a join of four tiles needs " + std::to_string(missing / kMiB + 1) +
                  " MiB more than --memory leaves for it; go on with that much more");
}

Piece CollapseStage::take(int worker) {
  Piece piece = ready_.empty() ? take_batch(worker) : take_inner();
  return piece;
}

Piece CollapseStage::take_batch(int worker) {
  const std::uint64_t bytes = *next_bytes();
  const std::size_t batch = next_batch_++;
  skip_done_batches();
  const LeafStarter& start = starters_[static_cast<std::size_t>(worker)];
  return {bytes, [this, batch, &start](const std::stop_token& stop) {
            return collapse_batch(batch, start, stop);
          }};
}

Piece CollapseStage::take_inner() {
  const std::uint64_t bytes = *next_bytes();
  const TileId id = *ready_.begin();
  ready_.erase(ready_.begin());
  if (id == tree_.root()) {
    starters_.clear();  // All leaves are done: what they were read by is closed.
  }
  std::vector<ArrayFileFacts> children;
  for (const TileId& child : tree_.children(id)) {
    children.push_back(log_.collapsed().at(child).pushed);
  }
  return {bytes, [this, id, children](const std::stop_token& stop) {
            return collapse_above(id, children, stop);
          }};
}

std::function<void()> CollapseStage::collapse_batch(std::size_t number, const LeafStarter& start,
                                                    const std::stop_token& stop) {
  const Batch& batch = order_.batches()[number];
  CollapsedTile result;
  std::vector<CollapsedLeaf> leaves;
  for (const TileId& id : batch.leaves) {
    CollapsedLeaf leaf = collapse_leaf(id, tree_, start, options_.collapse, stop);
    segments_.add(number, leaf.records);
    result.lone_samples += leaf.lone_samples;
    leaf.records = {};
    leaves.push_back(std::move(leaf));
    report(tree_.window(id).samples());
  }
  if (batch.top.level == 0) {
    result.pushed = write(batch.top, leaves.front().pushed);
  } else {
    CollapsedGroup group =
        collapse_group(batch.top, tree_, std::move(leaves), options_.collapse, stop);
    segments_.add(number, group.records);
    result.pushed = write(batch.top, group.pushed);
  }
  result.records = segments_.end(number);
  return [this, id = batch.top, result] { commit(id, result); };
}

std::function<void()> CollapseStage::collapse_above(const TileId& id,
                                                    const std::vector<ArrayFileFacts>& children,
                                                    const std::stop_token& stop) {
  std::vector<Tile> parts;
  const std::vector<TileId> ids = tree_.children(id);
  for (std::size_t i = 0; i < ids.size(); ++i) {
    ArrayFileReader file(log_.path(ids[i], kPushedEnding), children[i]);
    parts.push_back(read_pushed(file, options_.collapse.units));
  }
  const CollapsedTile result =
      write(collapse_inner(id, tree_, std::move(parts), options_.collapse, stop));
  return [this, id, result, ids] {
    commit(id, result);
    for (const TileId& child : ids) {
      log_.remove_later(child, kPushedEnding);
    }
  };
}

ArrayFileFacts CollapseStage::write(const TileId& id, const Tile& pushed) {
  ArrayFileWriter file(log_.workspace().files(), log_.path(id, kPushedEnding));
  write_pushed(file, pushed);
  return file.facts();
}

CollapsedTile CollapseStage::write(const CollapsedInner& inner) {
  CollapsedTile result;
  ArrayFileWriter file(log_.workspace().files(), log_.path(inner.segment.id, kSegmentEnding));
  write_segment(file, inner.segment);
  result.segment = file.facts();
  result.pushed = write(inner.segment.id, inner.pushed);
  return result;
}

void CollapseStage::commit(const TileId& id, const CollapsedTile& tile) {
  log_.note_collapsed(id, tile);
  look_for_parent(id);
  if (id.level <= 1) {
    segments_.advance();
  }
  segments_.checkpoint(false);
}

void CollapseStage::report(std::uint64_t samples) {
  const std::lock_guard lock(report_mutex_);
  samples_done_ += samples;
  ++leaves_done_;
  if (options_.progress) {
    options_.progress({"collapsing", samples_done_, tree_.window(tree_.root()).samples(),
                       leaves_done_, tree_.leaves()});
  }
}

}  // namespace ptin
