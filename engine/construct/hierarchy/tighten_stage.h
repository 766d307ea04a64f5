// SPDX-License-Identifier: GPL-3.0-or-later
//
// The second half of a build: every leaf shows the records above it their true errors, and segments
// of level 2 and above get their final bounds and are written.
#pragma once

#include <map>
#include <memory>
#include <mutex>
#include <vector>

#include "engine/construct/hierarchy/batch_order.h"
#include "engine/construct/hierarchy/build_log.h"
#include "engine/construct/hierarchy/hierarchy.h"
#include "engine/construct/hierarchy/piece_runner.h"
#include "engine/construct/hierarchy/segment.h"
#include "engine/construct/hierarchy/tile_files.h"

namespace ptin {

/// A piece is a batch: its leaves are replayed. Results are taken in the order of batches, so that
/// only segments on one path from the root are open at a time.
class TightenStage final : public PieceSource {
 public:
  /// Takes up what the log says is done. `tree`, `order`, `t0`, `options` and `log` must outlive
  /// the stage.
  /// @param make_starter  Called once for each thread, here.
  TightenStage(const std::function<LeafStarter()>& make_starter, const TileTree& tree,
               const BatchOrder& order, const Tin& t0, const HierarchyOptions& options,
               BuildLog& log);

  [[nodiscard]] std::optional<std::uint64_t> next_bytes() override;
  [[nodiscard]] Piece take(int worker) override;
  /// Makes all work durable. To be called when all pieces are done.
  void finish() { log_.checkpoint(true); }

 private:
  using SharedSegment = std::shared_ptr<const SegmentFile>;
  /// A segment that some leaves below it have raised, but not all.
  struct Open {
    SharedSegment file;
    SegmentBounds bounds;
  };
  /// What replaying the leaves of a batch gave.
  struct Replayed {
    std::vector<std::vector<BoundsRaise>> raises;  ///< For each ancestor, the root first.
    ArrayFileFacts facts;                          ///< Of the `.bounds` file that keeps the raises.
  };

  Replayed replay(const Batch& batch, const LeafStarter& start, const std::stop_token& stop);
  void commit(std::size_t batch, Replayed&& replayed);
  void write(const Batch& batch, Replayed& replayed);
  void write_closed(const TileId& id);
  void take_up(const Batch& batch);
  void raise_ancestors(const Batch& batch, const std::vector<std::vector<BoundsRaise>>& raises);
  void hand_to_parent(const TileId& id, std::span<const RecordBounds> exported);
  [[nodiscard]] Open& open(const TileId& id);
  [[nodiscard]] SharedSegment segment_of(const TileId& id);
  void report(std::uint64_t samples);

  const TileTree& tree_;
  const BatchOrder& order_;
  const Tin& t0_;
  const HierarchyOptions& options_;
  BuildLog& log_;
  std::vector<LeafStarter> starters_;  ///< One for each thread.
  std::size_t next_batch_, turn_;  ///< The next to be handed out; the next whose result is taken.
  std::map<std::size_t, Replayed> waiting_;  ///< Results of batches after turn_.
  std::map<TileId, Open> open_;              ///< The segments on one path from the root.
  std::mutex mutex_;                         ///< Guards files_.
  std::map<TileId, std::weak_ptr<const SegmentFile>> files_;  ///< Mapped while somebody reads them.
  std::mutex report_mutex_;  ///< Guards what follows, and calls of options_.progress.
  std::uint64_t samples_done_ = 0, leaves_done_ = 0;
};

}  // namespace ptin
