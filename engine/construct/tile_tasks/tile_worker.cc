// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/tile_tasks/tile_worker.h"

#include <algorithm>
#include <utility>

#include "engine/construct/hierarchy/tighten.h"
#include "engine/construct/tasks/await_file.h"
#include "engine/construct/tile_tasks/batch_order.h"
#include "engine/error.h"
#include "engine/stop.h"

namespace ptin {

namespace {

void append(std::vector<BoundsRaise>& to, std::span<const BoundsRaise> raises) {
  to.insert(to.end(), raises.begin(), raises.end());
}

std::string path_of(const TaskSetup& setup, const TileId& tile, TileFile file) {
  return setup.folder + "/" + file_name(tile, file);
}

/// Writes segments: their pages into one file, what is reported of them into another.
class SegmentFiles {
 public:
  SegmentFiles(const TaskSetup& setup, const TileId& tile)
      : packer_(setup.packer),
        syncs_(setup.syncs),
        pages_(setup.files, path_of(setup, tile, TileFile::kPages)),
        descriptions_(setup.files, path_of(setup, tile, TileFile::kDescriptions)) {}

  void add(StarredRecords& records) {
    const PreparedSegment segment = packer_.prepare(records);
    page_bytes_ += segment.pages.size();
    pages_.put(segment.pages);
    descriptions_.values(segment);
  }
  /// Tells in `result` what was written.
  void finish(TaskResult& result) {
    for (const auto& [file, kind] : {std::pair(&pages_, TileFile::kPages),
                                     std::pair(&descriptions_, TileFile::kDescriptions)}) {
      if (syncs_) {
        file->sync();
      }
      result.facts(kind) = file->finish();
    }
    result.page_bytes = page_bytes_;
  }

 private:
  const SegmentPacker& packer_;
  bool syncs_;
  ArrayFileWriter pages_, descriptions_;
  std::uint64_t page_bytes_ = 0;
};

}  // namespace

TaskResult TileWorker::run(const Task& task) {
  for (const InputFile& input : task.inputs) {
    await_file(path_of(setup_, input.tile, input.file), setup_.patience, task.stop);
  }
  try {
    return run_one(task);
  } catch (const DamagedInput&) {
    const std::lock_guard lock(mutex_);  // what is kept open may be what is damaged
    segments_.clear();
    coarsest_.reset();
    throw;
  }
}

TaskResult TileWorker::run_one(const Task& task) {
  switch (task.name.kind) {
    case TaskKind::kCollapse:
      return collapse(task);
    case TaskKind::kJoin:
      return join(task);
    case TaskKind::kTighten:
      return tighten(task);
    case TaskKind::kClose:
      return close(task);
    default:
      break;
  }
  return place(task);
}

// -------------------------------------------------------------------------------------------------
// What several tasks need.

ArrayFileWriter TileWorker::writer(const TileId& tile, TileFile file) const {
  return {setup_.files, path_of(setup_, tile, file)};
}

void TileWorker::finish(ArrayFileWriter& file, ArrayFileFacts& facts) const {
  if (setup_.syncs) {
    file.sync();
  }
  facts = file.finish();
}

void TileWorker::write_pushed_of(const TileId& tile, const Tile& pushed, TaskResult& result) const {
  ArrayFileWriter file = writer(tile, TileFile::kPushed);
  write_pushed(file, pushed);
  finish(file, result.facts(TileFile::kPushed));
}

LeafStarter TileWorker::take_starter() {
  const std::lock_guard lock(mutex_);
  if (starters_.empty()) {
    return setup_.make_starter();
  }
  LeafStarter starter = std::move(starters_.back());
  starters_.pop_back();
  return starter;
}

void TileWorker::put_back(LeafStarter starter) {
  const std::lock_guard lock(mutex_);
  starters_.push_back(std::move(starter));
}

TileWorker::SharedSegment TileWorker::segment_of(const InputFile& input) {
  const std::lock_guard lock(mutex_);
  std::weak_ptr<const SegmentFile>& known = segments_[input.tile];
  SharedSegment segment = known.lock();
  if (!segment) {
    segment = use_input(input, [&] {
      return std::make_shared<const SegmentFile>(
          input.tile, path_of(setup_, input.tile, input.file), input.facts);
    });
    known = segment;
  }
  return segment;
}

std::shared_ptr<const Tin> TileWorker::coarsest(const InputFile& root) {
  const std::lock_guard lock(mutex_);
  if (!coarsest_) {
    coarsest_ = read_input(setup_.folder, root, [&](ArrayFileReader& file) {
      return std::make_shared<const Tin>(read_pushed(file, setup_.collapse.units).tin);
    });
  }
  return coarsest_;
}

// -------------------------------------------------------------------------------------------------
// Collapsing.

TaskResult TileWorker::collapse(const Task& task) {
  const TileId& top = task.name.tile;
  LeafStarter start = take_starter();
  TaskResult result;
  SegmentFiles segments(setup_, top);
  std::vector<CollapsedLeaf> leaves;
  std::uint64_t samples = 0;
  for (const TileId& id : leaves_of_batch(setup_.tree, top)) {
    CollapsedLeaf leaf = collapse_leaf(id, setup_.tree, start, setup_.collapse, task.stop);
    segments.add(leaf.records);
    result.lone_samples += leaf.lone_samples;
    leaf.records = {};
    leaves.push_back(std::move(leaf));
    task.tell(samples += setup_.tree.window(id).samples());
  }
  put_back(std::move(start));
  if (top.level == 0) {
    write_pushed_of(top, leaves.front().pushed, result);
  } else {
    CollapsedGroup group =
        collapse_group(top, setup_.tree, std::move(leaves), setup_.collapse, task.stop);
    segments.add(group.records);
    write_pushed_of(top, group.pushed, result);
  }
  segments.finish(result);
  return result;
}

TaskResult TileWorker::join(const Task& task) {
  const TileId& id = task.name.tile;
  if (id == setup_.tree.root()) {
    const std::lock_guard lock(mutex_);
    starters_.clear();  // All leaves are done: what they were read by is closed until tightening.
  }
  std::vector<Tile> parts;
  for (const InputFile& child : task.inputs) {
    parts.push_back(read_input(setup_.folder, child, [&](ArrayFileReader& file) {
      return read_pushed(file, setup_.collapse.units);
    }));
  }
  const CollapsedInner inner =
      collapse_inner(id, setup_.tree, std::move(parts), setup_.collapse, task.stop);
  TaskResult result;
  ArrayFileWriter segment = writer(id, TileFile::kSegment);
  write_segment(segment, inner.segment);
  finish(segment, result.facts(TileFile::kSegment));
  write_pushed_of(id, inner.pushed, result);
  return result;
}

// -------------------------------------------------------------------------------------------------
// Tightening (engine/DESIGN.md, section 5.7). Raises are maxima: they commute, and those of a tile's
// leaves are joined on their way up, level by level.

TaskResult TileWorker::tighten(const Task& task) {
  const std::shared_ptr<const Tin> t0 = coarsest(task.inputs.front());
  const auto above = std::span(task.inputs).subspan(1);
  std::vector<SharedSegment> segments;
  std::vector<std::vector<BoundsRaise>> raises(above.size());
  std::vector<ReplaySegment> chain;
  for (std::size_t i = 0; i < above.size(); ++i) {
    segments.push_back(segment_of(above[i]));
    chain.push_back({segments[i]->view().records, &raises[i]});
  }
  LeafStarter start = take_starter();
  std::uint64_t samples = 0;
  for (const TileId& leaf : leaves_of_batch(setup_.tree, task.name.tile)) {
    stop_if_asked(task.stop, "the build");
    const SampleRange window = setup_.tree.window(leaf);
    replay_over_leaf(chain, *t0, start(window));
    task.tell(samples += window.samples());
  }
  put_back(std::move(start));
  for (std::size_t i = 0; i < above.size(); ++i) {
    use_input(above[i], [&] { segments[i]->require_undamaged(); });
  }
  TaskResult result;
  ArrayFileWriter bounds = writer(task.name.tile, TileFile::kBounds);
  for (std::vector<BoundsRaise>& r : raises) {
    combine(r);
    bounds.put(r);
  }
  finish(bounds, result.facts(TileFile::kBounds));
  return result;
}

TaskResult TileWorker::close(const Task& task) {
  const TileId& id = task.name.tile;
  const std::size_t above = ancestors_of(setup_.tree, id).size();
  const SharedSegment segment = segment_of(task.inputs.front());
  SegmentBounds bounds(segment->view());
  std::vector<std::vector<BoundsRaise>> raises(above);
  for (std::size_t child = 0; child + 1 < task.inputs.size(); ++child) {
    read_input(setup_.folder, task.inputs[child + 1], [&](ArrayFileReader& file) {
      for (std::vector<BoundsRaise>& r : raises) {
        append(r, file.take<BoundsRaise>());
      }
      bounds.raise(file.take<BoundsRaise>());
      if (id.level > 2) {  // of batches all bounds are final
        bounds.set_foreign(child, file.take<RecordBounds>());
      }
      file.require_undamaged();
    });
  }
  TaskResult result;
  ArrayFileWriter upward = writer(id, TileFile::kBounds);
  for (std::vector<BoundsRaise>& r : raises) {
    combine(r);
    upward.put(r);
  }
  upward.put(bounds.saturate());
  finish(upward, result.facts(TileFile::kBounds));
  StarredRecords records = bounds.records();
  use_input(task.inputs.front(), [&] { segment->require_undamaged(); });
  SegmentFiles packed(setup_, id);
  packed.add(records);
  packed.finish(result);
  return result;
}

TaskResult TileWorker::place(const Task& task) {
  std::uint64_t offset = task.offset;
  read_input(setup_.folder, task.inputs.front(), [&](ArrayFileReader& file) {
    while (!file.at_end()) {
      const std::span<const std::byte> pages = file.take<std::byte>();
      setup_.packer.place(pages, offset);
      offset += pages.size();
    }
    file.require_undamaged();
  });
  return {};
}

}  // namespace ptin
