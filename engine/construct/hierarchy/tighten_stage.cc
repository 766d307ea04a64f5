// SPDX-License-Identifier: GPL-3.0-or-later
//
// How the bounds of inner segments become final (engine/DESIGN.md, section 5.7).
//
// A piece of work is a batch. Its worker starts each leaf anew with a starter of its own, and
// replays over it the segments of all ancestors of the batch, root first. Workers share these
// segments: they are mapped files, only read, and closed with their last user (segment_of()). The
// worker owns what comes of that, the raises for each ancestor, and keeps them in a `.bounds` file
// too. Everything else is the stage's, and changes in commit() alone, which no two threads run at
// once:
// 1. A result waits until its batch has the turn. Raises are maxima and commute, so the turn does
//    not decide bounds: it decides the order of the output, and keeps few segments open.
// 2. The raises go to the bounds of the ancestors' segments. The first raise opens a segment.
// 3. The last batch below an ancestor closes it: its bounds are saturated, its records go to the
//    output, and the bounds of what it pushed up go to a file and to its parent. The lowest
//    ancestor is closed first, since a parent saturates with the final bounds of its children.
// 4. The log notes all that, and a checkpoint makes it durable.
// A resumed build reads raises and bounds from these files as far as open segments need them
// (take_up()), and replays the other batches.
#include "engine/construct/hierarchy/tighten_stage.h"

#include <algorithm>
#include <utility>

#include "engine/construct/hierarchy/tighten.h"
#include "engine/error.h"
#include "engine/stop.h"

namespace ptin {

namespace {

/// Joins the raises of several leaves: leaves one entry for each record, the maxima.
void combine(std::vector<BoundsRaise>& raises) {
  std::sort(raises.begin(), raises.end(),
            [](const BoundsRaise& a, const BoundsRaise& b) { return a.record < b.record; });
  std::size_t kept = 0;
  for (const BoundsRaise& r : raises) {
    if (kept > 0 && raises[kept - 1].record == r.record) {
      RecordBounds& bounds = raises[kept - 1].bounds;
      bounds.error = std::max(bounds.error, r.bounds.error);
      bounds.deviation = std::max(bounds.deviation, r.bounds.deviation);
    } else {
      raises[kept++] = r;
    }
  }
  raises.resize(kept);
}

}  // namespace

TightenStage::TightenStage(const std::function<LeafStarter()>& make_starter, const TileTree& tree,
                           const BatchOrder& order, const Tin& t0, const HierarchyOptions& options,
                           BuildLog& log)
    : tree_(tree),
      order_(order),
      t0_(t0),
      options_(options),
      log_(log),
      next_batch_(log.batches_written()),
      turn_(log.batches_written()) {
  for (int i = 0; i < options.threads; ++i) {
    starters_.push_back(make_starter());
  }
  for (std::size_t i = 0; i < turn_; ++i) {
    take_up(order.batches()[i]);
    samples_done_ += tree.window(order.batches()[i].top).samples();
    leaves_done_ += order.batches()[i].leaves.size();
  }
}

TightenStage::SharedSegment TightenStage::segment_of(const TileId& id) {
  const std::lock_guard lock(mutex_);
  std::weak_ptr<const SegmentFile>& known = files_[id];
  SharedSegment file = known.lock();
  if (!file) {
    file = std::make_shared<const SegmentFile>(id, log_.path(id, kSegmentEnding),
                                               log_.collapsed().at(id).segment);
    known = file;
  }
  return file;
}

TightenStage::Open& TightenStage::open(const TileId& id) {
  const auto found = open_.find(id);
  if (found != open_.end()) {
    return found->second;
  }
  SharedSegment file = segment_of(id);
  SegmentBounds bounds(file->view());
  return open_.emplace(id, Open{std::move(file), std::move(bounds)}).first->second;
}

// -------------------------------------------------------------------------------------------------
// Handing out.

std::optional<std::uint64_t> TightenStage::next_bytes() {
  // Results that wait for their turn are counted by no piece, so few batches may run ahead.
  const auto most_waiting = 2 * static_cast<std::size_t>(options_.threads);
  if (next_batch_ == order_.batches().size() || next_batch_ - turn_ >= most_waiting) {
    return std::nullopt;
  }
  return options_.tile_bytes.of_replay(
      BatchOrder::largest_leaf(tree_, order_.batches()[next_batch_]));
}

Piece TightenStage::take(int worker) {
  const std::uint64_t bytes = *next_bytes();
  const std::size_t number = next_batch_++;
  const LeafStarter& start = starters_[static_cast<std::size_t>(worker)];
  return {bytes, [this, number, &start](const std::stop_token& stop) -> std::function<void()> {
            auto replayed =
                std::make_shared<Replayed>(replay(order_.batches()[number], start, stop));
            return [this, number, replayed] { commit(number, std::move(*replayed)); };
          }};
}

TightenStage::Replayed TightenStage::replay(const Batch& batch, const LeafStarter& start,
                                            const std::stop_token& stop) {
  std::vector<SharedSegment> files;
  std::vector<std::vector<BoundsRaise>> raises(batch.ancestors.size());
  std::vector<ReplaySegment> chain;
  for (const TileId& id : batch.ancestors) {
    files.push_back(segment_of(id));
  }
  for (std::size_t i = 0; i < files.size(); ++i) {
    chain.push_back({files[i]->view().records, &raises[i]});
  }
  for (const TileId& leaf : batch.leaves) {
    stop_if_asked(stop, "the build");
    const SampleRange window = tree_.window(leaf);
    replay_over_leaf(chain, t0_, start(window));
    report(window.samples());
  }
  Replayed result;
  for (std::vector<BoundsRaise>& r : raises) {
    combine(r);
  }
  result.raises = std::move(raises);
  for (const SharedSegment& file : files) {
    file->require_undamaged();
  }
  ArrayFileWriter file(log_.workspace().files(), log_.path(batch.top, kBoundsEnding));
  for (const std::vector<BoundsRaise>& r : result.raises) {
    file.put(r);
  }
  result.facts = file.facts();
  return result;
}

// -------------------------------------------------------------------------------------------------
// Taking results, in order.

void TightenStage::commit(std::size_t batch, Replayed&& replayed) {
  waiting_.emplace(batch, std::move(replayed));
  for (auto next = waiting_.find(turn_); next != waiting_.end(); next = waiting_.find(turn_)) {
    write(order_.batches()[turn_], next->second);
    waiting_.erase(next);
    ++turn_;
    log_.note_written(order_.batches().size(), turn_);
    log_.checkpoint(false);
  }
}

void TightenStage::write(const Batch& batch, Replayed& replayed) {
  log_.note_tightened(batch.top, replayed.facts);
  raise_ancestors(batch, replayed.raises);
  for (const TileId& id : batch.closed) {
    write_closed(id);
  }
}

/// Closes a tile: all its leaves have raised, and all its children are final.
void TightenStage::write_closed(const TileId& id) {
  Open& tile = open(id);
  const std::vector<RecordBounds> exported = tile.bounds.saturate();
  StarredRecords records = tile.bounds.records();
  tile.file->require_undamaged();
  log_.output().add_segment(records);
  open_.erase(id);
  ArrayFileWriter file(log_.workspace().files(), log_.path(id, kBoundsEnding));
  file.put(exported);
  log_.note_tightened(id, file.facts());
  log_.remove_later(id, kSegmentEnding);
  hand_to_parent(id, exported);
}

void TightenStage::raise_ancestors(const Batch& batch,
                                   const std::vector<std::vector<BoundsRaise>>& raises) {
  for (std::size_t i = 0; i < raises.size(); ++i) {
    open(batch.ancestors[i]).bounds.raise(raises[i]);
  }
}

void TightenStage::hand_to_parent(const TileId& id, std::span<const RecordBounds> exported) {
  if (id != tree_.root()) {
    open(BatchOrder::parent_of(id))
        .bounds.set_foreign(BatchOrder::place_in_parent(tree_, id), exported);
  }
}

/// Takes up what an earlier run did of a batch, as far as tiles that are not written yet need it.
void TightenStage::take_up(const Batch& batch) {
  const auto is_written = [&](const TileId& id) { return log_.tightened().contains(id); };
  if (std::all_of(batch.ancestors.begin(), batch.ancestors.end(), is_written)) {
    return;
  }
  ArrayFileReader file(log_.path(batch.top, kBoundsEnding), log_.tightened().at(batch.top));
  for (const TileId& id : batch.ancestors) {
    const auto raises = file.take<BoundsRaise>();
    if (!is_written(id)) {
      open(id).bounds.raise(raises);
      file.require_undamaged();
    }
  }
  for (const TileId& id : batch.closed) {
    if (id != tree_.root() && !is_written(BatchOrder::parent_of(id))) {
      ArrayFileReader closed(log_.path(id, kBoundsEnding), log_.tightened().at(id));
      hand_to_parent(id, closed.take<RecordBounds>());
      closed.require_undamaged();
    }
  }
}

void TightenStage::report(std::uint64_t samples) {
  const std::lock_guard lock(report_mutex_);
  samples_done_ += samples;
  ++leaves_done_;
  if (options_.progress) {
    options_.progress({"tightening", samples_done_, tree_.window(tree_.root()).samples(),
                       leaves_done_, tree_.leaves()});
  }
}

}  // namespace ptin
