// SPDX-License-Identifier: GPL-3.0-or-later
//
// The first half of a build: all tiles are collapsed, from the leaves to the root.
#pragma once

#include <cstdint>
#include <functional>
#include <mutex>
#include <optional>
#include <set>
#include <vector>

#include "engine/construct/hierarchy/batch_order.h"
#include "engine/construct/hierarchy/build_log.h"
#include "engine/construct/hierarchy/hierarchy.h"
#include "engine/construct/hierarchy/in_order_segments.h"
#include "engine/construct/hierarchy/piece_runner.h"
#include "engine/construct/hierarchy/tile_collapse.h"

namespace ptin {

/// A piece is a batch, or one tile above the batches. Batches are handed out in their order. A tile
/// above them is handed out as soon as all its children are collapsed, and before the next batch,
/// since it makes the temporary files of its children superfluous.
class CollapseStage final : public PieceSource {
 public:
  /// Takes up what the log says is done. `tree`, `order`, `options` and `log` must outlive the
  /// stage.
  /// @param make_starter  Called once for each thread, here.
  CollapseStage(const std::function<LeafStarter()>& make_starter, const TileTree& tree,
                const BatchOrder& order, const HierarchyOptions& options, BuildLog& log);

  [[nodiscard]] std::optional<std::uint64_t> next_bytes() override;
  [[nodiscard]] Piece take(int worker) override;
  /// Makes all work durable. To be called when all pieces are done.
  void finish() { segments_.checkpoint(true); }

 private:
  [[nodiscard]] Piece take_batch(int worker);
  [[nodiscard]] Piece take_inner();
  std::function<void()> collapse_batch(std::size_t batch, const LeafStarter& start,
                                       const std::stop_token& stop);
  std::function<void()> collapse_above(const TileId& id,
                                       const std::vector<ArrayFileFacts>& children,
                                       const std::stop_token& stop);
  CollapsedTile write(const CollapsedInner& inner);
  ArrayFileFacts write(const TileId& id, const Tile& pushed);
  void commit(const TileId& id, const CollapsedTile& tile);
  void look_for_parent(const TileId& id);
  void skip_done_batches();
  [[noreturn]] static void refuse_join(std::uint64_t missing);
  void report(std::uint64_t samples);

  const TileTree& tree_;
  const BatchOrder& order_;
  const HierarchyOptions& options_;
  BuildLog& log_;
  InOrderSegments segments_;
  std::vector<LeafStarter> starters_;  ///< One for each thread.
  std::size_t next_batch_ = 0;
  std::set<TileId> ready_;   ///< Tiles above batches, to be handed out: all children are collapsed.
  std::mutex report_mutex_;  ///< Guards what follows, and calls of options_.progress.
  std::uint64_t samples_done_ = 0, leaves_done_ = 0;
};

}  // namespace ptin
