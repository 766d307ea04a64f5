// SPDX-License-Identifier: GPL-3.0-or-later
//
// The splits of a stream in a cell of the terrain, each as the symbols that it is coded by.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "engine/geometry/height.h"
#include "engine/mesh/star.h"
#include "engine/mesh/tin.h"
#include "engine/query/select/accounting.h"
#include "engine/query/shape/grid_cell.h"
#include "engine/query/stream/frame_cuts.h"
#include "engine/query/stream/growing_mesh.h"
#include "engine/query/stream/split_code.h"
#include "engine/query/stream/split_turns.h"
#include "engine/query/stream/vertex_ranks.h"

namespace ptin {

/// What stands before the symbols of a split.
struct CodedSplit {
  /// Where w was there when the frame began: the number of its cell, times 2^32, and its place among
  /// the vertices of that cell along the curve. Else SplitTurn::kMadeHere and its key.
  std::uint64_t w;
  VertexKey u;
  std::uint16_t level;
  std::uint8_t symbols;  ///< Bytes.
  static constexpr std::size_t kBytes = 8 + 8 + 2 + 1;
};

/// Applies the splits of a cell frame by frame, and writes down those whose w lies in the cell. Their
/// w has its whole link there: splits whose roi does not meet the cell change no triangle that does
/// (engine/DESIGN.md, section 6.11). Threads: one owner.
class CellCoder {
 public:
  /// @param base    T0 and what is held, as far as it meets the cell; vertices ascend by key. Copied.
  /// @param splits  Those to be sent whose roi meets the cell, in any order.
  /// @param cuts    Borrowed, as `context`.
  /// @param number  Of the cell, along the curve.
  CellCoder(const Tin& base, std::vector<PendingSplit> splits, const FrameCuts& cuts,
            const GridCell& cell, std::uint32_t number, HeightType type,
            const QueryContext& context);

  /// Most bytes of a cell of so many splits, and of what it writes of one frame.
  [[nodiscard]] static std::uint64_t bytes_of(std::uint64_t base_vertices,
                                              std::uint64_t splits) noexcept;

  /// Writes down the splits of the next frame, each a CodedSplit and its symbols, in any order.
  /// @throws Error corruption  a record does not fit the mesh; cancelled
  void code(std::vector<std::byte>& out);

  /// Vertices of the cell: of the base, and those that came with the last frame.
  [[nodiscard]] std::uint32_t base_vertices() const noexcept { return base_vertices_; }
  [[nodiscard]] std::uint32_t born() const noexcept { return born_; }
  /// Digest of the vertices of all splits that were written down.
  [[nodiscard]] std::uint64_t digest() const noexcept { return digest_; }

 private:
  [[nodiscard]] std::size_t put_in_places(const Tin& base, const FrameCuts& cuts);
  void place_along_curve(const Tin& base);
  void sort(const FrameCuts& cuts);
  [[nodiscard]] std::vector<SplitTurn> turns_of(std::span<const PendingSplit> frame);
  [[nodiscard]] std::uint32_t level_of(const PendingSplit& split, const SplitSite& site);
  void code_one(const PendingSplit& split, const SplitTurn& turn, const SplitSite& site,
                std::vector<std::byte>& out);
  [[nodiscard]] bool is_inside(std::uint32_t along) const noexcept {
    return along >= inside_ && along < inside_end_;
  }

  GridCell cell_;
  std::uint64_t number_;
  const QueryContext& context_;
  SplitCode code_;
  std::vector<PendingSplit> splits_;   ///< By frame, falling rank, and along the curve.
  std::vector<std::uint32_t> begins_;  ///< Of each frame in `splits_`, and the end.
  std::size_t frame_ = 0;
  std::vector<std::uint32_t> split_along_;  ///< For each of `splits_` where u lies along the curve.
  std::vector<std::uint32_t> along_;        ///< The same for each vertex of `mesh_`.
  std::uint32_t inside_ = 0, inside_end_ = 0;  ///< The part of the curve that is the cell.
  VertexRanks ranks_;
  GrowingMesh mesh_;
  /// The mesh on which levels are found, one frame ahead: there splits come by falling rank.
  GrowingMesh ahead_;
  std::vector<std::uint32_t>
      marks_;               ///< For each triangle of `ahead_` mark_ + 1 + its maker's level.
  std::uint32_t mark_ = 0;  ///< Marks up to here are of earlier frames.
  std::uint32_t base_vertices_ = 0, born_ = 0;
  std::uint64_t digest_ = 0;
  Star star_;
};

}  // namespace ptin
