// SPDX-License-Identifier: GPL-3.0-or-later
//
// Which vertex goes next: the priority of each cost, and a queue over it.
#pragma once

#include <array>
#include <compare>
#include <cstdint>
#include <vector>

#include "engine/construct/collapse/cost.h"
#include "engine/geometry/box.h"
#include "engine/geometry/point.h"
#include "engine/mesh/tin.h"

namespace ptin {

/// A vertex in the queue; the smaller entry goes first. Equal priorities go by vertex id, whose
/// order is that of the keys.
struct QueueEntry {
  std::uint64_t priority = 0;
  VertexId vertex = kNone;
  // NOLINTNEXTLINE(modernize-use-nullptr)
  friend auto operator<=>(const QueueEntry&, const QueueEntry&) = default;
};

/// What a priority is made from.
struct CollapseMeasure {
  GridPoint vertex;
  /// Error of the collapse's own samples, in height quanta; may be +infinity.
  double error_quanta = 0.0;
  double height_quanta = 0.0;  ///< Length of the saturated height interval, in height quanta.
  GridBox roi;                 ///< Saturated box.
  std::uint32_t chain = 0;     ///< saturated_chain() of the collapse.
};

/// Class of an error: 0 below one height quantum, 1 at exactly one quantum, then one class for each
/// third of an octave. A class includes its upper end, so that whole errors, which are many, end a
/// class and do not begin one (engine/DECISIONS.md, section 2.1). The same on every machine:
/// computed from the exponent and by comparisons, without a logarithm.
[[nodiscard]] std::uint32_t error_class(double error_quanta) noexcept;

/// Turns measures into priorities of 64 bits, the highest ten of which are a class. Each cost
/// compares in this order:
///   error:     error class, octave of the half-perimeter of the box, neighbourhood, sixteenth of
///              that octave, chain, half-perimeter
///   roi:       half-perimeter (its class is its octave)
///   elevation: length of the height interval, half-perimeter
///
/// A neighbourhood is a square of the plane that holds about 16384 of the vertices that the tile
/// begins with, or 16 boxes a side where boxes have grown. Within a class and an octave one
/// neighbourhood is finished before the next begins. This is nearly the order by box alone, but the
/// part of the mesh that is worked on stays in the processor's caches (engine/DECISIONS.md, section
/// 2.2). The octave is compared before the neighbourhood, because a class can be large: a lake is
/// all of class 0, and a neighbourhood finished to the end would leave huge triangles beside small
/// ones.
///
/// The chain is compared before the last bits of the half-perimeter. Where boxes are nearly equal,
/// as along a seam of tiles across a lake, an order by box alone takes one vertex after its
/// neighbour, each depending on the one before. By chain, every other vertex goes first.
class PriorityScale {
 public:
  /// @param bounds    Box of all vertices of the tile.
  /// @param vertices  Their number.
  PriorityScale(CostModel cost, const GridBox& bounds, std::uint64_t vertices) noexcept;
  [[nodiscard]] std::uint64_t operator()(const CollapseMeasure& measure) const noexcept;

 private:
  [[nodiscard]] std::uint64_t neighbourhood(GridPoint p, int octave) const noexcept;
  CostModel cost_;
  GridPoint origin_;
  int shift_ = 0;  ///< log2 of the side of the smallest neighbourhoods, grid units.
};

/// Bits of the class, the highest of a priority.
inline constexpr int kClassBits = 10;
/// Bits that the queue tells entries apart by before it sorts them: the class and, with
/// CostModel::kError, the octave.
inline constexpr int kBucketBits = 15;

/// A queue of vertices, least entry first. A vertex is in it at most once; the caller sees to that.
///
/// Entries wait unsorted in buckets by their highest bits. A bucket is sorted when its turn comes; an
/// entry that arrives later for this bucket, or for an earlier one, goes through a heap. So most entries
/// cost one append and a part of one sort, instead of a walk through a large heap. The next few dozen
/// entries are drawn ahead, so that a caller sees what will come and can ask for its memory
/// (upcoming()).
class CollapseQueue {
 public:
  void push(const QueueEntry& entry);
  /// True when no entry is left. Draws entries ahead when few are drawn, and sorts the next class
  /// when the present one is used up. Amortised cost: logarithmic.
  [[nodiscard]] bool empty();
  /// The least entry. REQUIRES: empty() was called since the last push() or pop(), and was false.
  [[nodiscard]] const QueueEntry& top() const noexcept { return ahead_[first_]; }
  /// Removes the least entry. REQUIRES: as top().
  void pop() noexcept { ++first_; }
  /// The entry `n` places behind the least one, or null. It comes to the top after n calls of
  /// pop(), unless smaller entries arrive meanwhile. Right after empty() it is not null for n <
  /// kLookahead while so many entries are left.
  [[nodiscard]] const QueueEntry* upcoming(std::size_t n) const noexcept {
    return n < ahead_.size() - first_ ? &ahead_[first_ + n] : nullptr;
  }
  static constexpr std::size_t kLookahead = 24;
  /// Gives all vertices in the queue new ids. REQUIRES: the order of the ids stays.
  void rename(const std::vector<VertexId>& new_name) noexcept;

 private:
  void draw_ahead();

  std::vector<QueueEntry> ahead_;  ///< Ascending, from first_; no entry elsewhere is less.
  std::size_t first_ = 0;
  std::vector<QueueEntry> run_;  ///< The present bucket, ascending, from next_.
  std::size_t next_ = 0;
  std::vector<QueueEntry> late_;  ///< Heap: entries of bucket present_ and below that came late.
  std::size_t present_ = 0;       ///< Bucket of run_; buckets below are used up.
  std::vector<std::vector<QueueEntry>> waiting_{std::size_t{1} << kBucketBits};  ///< By bucket.
};

}  // namespace ptin
