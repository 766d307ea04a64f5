// SPDX-License-Identifier: GPL-3.0-or-later
//
// Which vertex goes next: the priority of each cost, and a queue over it.
#pragma once

#include <array>
#include <compare>
#include <cstdint>
#include <vector>

#include "engine/construct/tile/cost.h"
#include "engine/geometry/box.h"
#include "engine/geometry/point.h"
#include "engine/mesh/tin.h"

namespace ptin {

/// A vertex in the queue; smaller goes first. Ties end with the vertex id, whose order is that of
/// the keys.
struct QueueEntry {
  std::uint64_t priority = 0;
  VertexId vertex = kNone;
  // NOLINTNEXTLINE(modernize-use-nullptr)
  friend auto operator<=>(const QueueEntry&, const QueueEntry&) = default;
};

/// What a priority is made from.
struct CollapseMeasure {
  GridPoint vertex;
  double error_quanta =
      0.0;  ///< Error of the collapse's own samples, in height quanta; may be +infinity.
  double height_quanta = 0.0;  ///< Length of the saturated height interval, in height quanta.
  GridBox roi;                 ///< Saturated box.
  std::uint32_t chain = 0;     ///< Collapses that this one would come to depend on, one on another.
};

/// Class of an error: 0 below one height quantum, 1 for just that, then one class for each third of
/// an octave, its upper end included: whole errors, which are many, end a class and do not begin
/// one (engine/DECISIONS.md, section 2.1). Exact on every machine: exponent and comparisons, no
/// logarithm.
[[nodiscard]] std::uint32_t error_class(double error_quanta) noexcept;

/// Turns measures into priorities of 64 bits, the highest ten of which are a class.
///   error:     error class, octave of the box's half-perimeter, neighbourhood, sixteenth of that
///              octave, chain, half-perimeter
///   roi:       half-perimeter (its class is its octave)
///   elevation: height interval, half-perimeter
/// Neighbourhoods are squares of the plane, about 16384 vertices of the full TIN large, or 16 boxes
/// where boxes have grown. Within class and octave one is finished before the next begins: nearly
/// the order by box alone, but the mesh that is worked on stays in the processor's caches
/// (engine/DECISIONS.md, section 2.2). The octave comes first, because a class can be large (on a
/// lake everything is of class 0) and a neighbourhood finished to the end would leave huge
/// triangles beside small ones.
///
/// The chain comes before the last of the box: where boxes are nearly equal, as along a seam of
/// tiles across a lake, an order by box alone takes one vertex after its neighbour, each depending
/// on the one before; by chain every other one goes first.
class PriorityScale {
 public:
  /// @param bounds    Of all vertices.
  /// @param vertices  Their number.
  PriorityScale(CostModel cost, const GridBox& bounds, std::uint64_t vertices) noexcept;
  [[nodiscard]] std::uint64_t operator()(const CollapseMeasure& measure) const noexcept;

 private:
  [[nodiscard]] std::uint64_t neighbourhood(GridPoint p, int octave) const noexcept;
  CostModel cost_;
  GridPoint origin_;
  int shift_ = 0;  ///< log2 of the side of the smallest neighbourhoods, grid units.
};

/// Number of classes, the highest bits of a priority.
inline constexpr int kClassBits = 10;

/// Vertices, least entry first. A vertex is in it at most once; the caller sees to that.
///
/// Entries of later classes wait unsorted; a class is sorted when its turn comes, and what arrives
/// meanwhile for it (or for an earlier one) goes through a heap. So most entries cost one append
/// and one sort in sequence instead of a walk through a large heap. The next few dozen are drawn
/// ahead, so that a caller sees what will come and can ask for its memory (upcoming()).
class CollapseQueue {
 public:
  void push(const QueueEntry& entry);
  /// Draws entries ahead when few are left, and sorts the next class when the present one is used
  /// up. Amortised cost: logarithmic.
  [[nodiscard]] bool empty();
  /// REQUIRES: empty() was just asked and false.
  [[nodiscard]] const QueueEntry& top() const noexcept { return ahead_[first_]; }
  /// REQUIRES: as top().
  void pop() noexcept { ++first_; }
  /// The entry `n` places behind the least, or null: it will come then, but for entries that arrive
  /// meanwhile. Known for kLookahead places unless the end is near.
  [[nodiscard]] const QueueEntry* upcoming(std::size_t n) const noexcept {
    return n < ahead_.size() - first_ ? &ahead_[first_ + n] : nullptr;
  }
  static constexpr std::size_t kLookahead = 24;
  /// Renames all vertices in it. REQUIRES: the order of the names stays.
  void rename(const std::vector<VertexId>& new_name) noexcept;

 private:
  void draw_ahead();

  std::vector<QueueEntry> ahead_;  ///< Ascending, from first_; nothing elsewhere is less.
  std::size_t first_ = 0;
  std::vector<QueueEntry> run_;  ///< The present class, ascending, from next_.
  std::size_t next_ = 0;
  std::vector<QueueEntry> late_;  ///< Heap.
  std::size_t present_ = 0;       ///< Class of run_; classes below are used up.
  std::array<std::vector<QueueEntry>, std::size_t{1} << kClassBits> waiting_;
};

}  // namespace ptin
