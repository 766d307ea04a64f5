// SPDX-License-Identifier: GPL-3.0-or-later
//
// Chains: parts of isolines, joined by the edges on which they begin and end.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "engine/geometry/affine.h"
#include "engine/growing_array.h"
#include "engine/mesh/tin.h"
#include "engine/query/isoline/isoline_cut.h"
#include "engine/query/isoline/isoline_pieces.h"
#include "engine/query/select/accounting.h"

namespace ptin {

/// Chains of many lines. A chain has a point on each edge that its line crosses, one behind the other;
/// points that are equal in a row may be one. Threads: one owner. What was allocated is used again.
class ChainSet {
 public:
  /// Where a line crosses an edge.
  struct Step {
    CutEdge edge;
    MapPoint point;
  };

  void clear() noexcept;
  [[nodiscard]] std::size_t size() const noexcept { return chains_.size(); }
  [[nodiscard]] std::size_t points() const noexcept { return points_.size(); }

  /// Begins a chain, which extend() goes on with. REQUIRES: size() and points() stay below kNone.
  void begin(const Step& step, std::uint32_t level);
  void extend(const Step& step);
  /// Adds a piece that is no ring. `first` of it is not looked at.
  void add(const IsolinePiece& piece, std::span<const MapPoint> points);

  /// Calls take(const IsolinePiece&, std::span<const MapPoint>) for each line that the chains make up:
  /// open ones, then rings. `first` is not set. May be called once.
  /// @throws Error cancelled
  /// Cost: linear.
  template <class Take>
  void join(const QueryContext& context, const Take& take) {
    link(context);
    for (const bool ring : {false, true}) {  // rings are what is left once all open lines are taken
      for (std::uint32_t i = 0; i < size(); ++i) {
        if (i % kStopInterval == 0) {
          context.check_stop();
        }
        if (!chain(i).is_taken && (ring || !chain(i).is_next)) {
          const IsolinePiece piece = take_line(i, ring);
          take(piece, std::span<const MapPoint>(line_.data(), piece.count));
        }
      }
    }
  }

  /// Most bytes that so many chains of so many points take, with what joining them needs.
  [[nodiscard]] static std::uint64_t bytes_for(std::uint64_t chains,
                                               std::uint64_t points) noexcept {
    return chains * (sizeof(Chain) / 4 * 5 + 2 * sizeof(Slot)) + points * 3 * sizeof(MapPoint);
  }

 private:
  struct Chain {
    CutEdge begin, end;
    CutEdge smallest;  ///< Smallest of the edges that it crosses.
    std::uint32_t level;
    std::uint32_t first = 0, count = 0;
    std::uint32_t smallest_at = 0;  ///< Which of its points lies on `smallest`.
    std::uint32_t next = kNone;     ///< The chain that begins where this one ends.
    bool is_next = false;           ///< Whether it is `next` of another chain.
    bool is_taken = false;
  };
  /// The place of a chain in a table of the edges on which chains begin.
  struct Slot {
    std::uint32_t tag;
    std::uint32_t chain = kNone;
  };

  [[nodiscard]] Chain& chain(std::uint32_t i) noexcept { return chains_.data()[i]; }
  [[nodiscard]] const Chain& chain(std::uint32_t i) const noexcept { return chains_.data()[i]; }
  [[nodiscard]] static std::uint64_t hash_of(const CutEdge& edge, std::uint32_t level) noexcept;
  [[nodiscard]] std::size_t home(std::uint64_t hash) const noexcept {
    return static_cast<std::size_t>(((hash >> 32) * slots_.size()) >> 32);
  }
  void link(const QueryContext& context);
  void note_begin(std::uint32_t i) noexcept;
  [[nodiscard]] std::uint32_t chain_from(const CutEdge& edge, std::uint32_t level) const noexcept;
  [[nodiscard]] IsolinePiece take_line(std::uint32_t start, bool ring);
  void copy_ring(std::uint32_t holder);
  [[nodiscard]] std::uint32_t copy_line(std::uint32_t start, std::uint32_t holder);
  void copy_points(const Chain& chain, std::uint32_t from, std::uint32_t to) noexcept;
  void push(const Chain& chain, std::span<const MapPoint> points);

  GrowingArray<Chain> chains_;
  GrowingArray<MapPoint> points_;
  std::vector<Slot> slots_;
  GrowingArray<MapPoint> line_;  ///< The line at hand; the size is what there is room for.
  std::size_t line_points_ = 0;
};

}  // namespace ptin
