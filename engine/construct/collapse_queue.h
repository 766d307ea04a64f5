// SPDX-License-Identifier: GPL-3.0-or-later
//
// Which vertex goes next: the priority of each cost, and a heap over it.
#pragma once

#include <compare>
#include <cstdint>
#include <vector>

#include "engine/construct/cost.h"
#include "engine/geometry/box.h"
#include "engine/geometry/interval.h"
#include "engine/mesh/tin.h"

namespace ptin {

/// A vertex in the queue; smaller goes first. Ties end with the vertex id, whose order is that of the keys.
struct QueueEntry {
  std::uint64_t priority = 0;
  VertexId vertex = kNone;
  friend auto operator<=>(const QueueEntry&, const QueueEntry&) = default;
};

/// What a priority is made from.
struct CollapseMeasure {
  double error_quanta = 0.0;   ///< Error of the collapse's own samples, in height quanta; may be +infinity.
  double height_quanta = 0.0;  ///< Length of the saturated height interval, in height quanta.
  GridBox roi;                 ///< Saturated box.
};

/// Class of an error: 0 below one height quantum, then one class for each quarter of an octave (DESIGN.md, section 5).
/// Exact on every machine: exponent and three comparisons, no logarithm.
[[nodiscard]] std::uint32_t error_class(double error_quanta) noexcept;

/// Priority of a collapse: `error`: (class, half-perimeter); `roi`: half-perimeter; `elevation`: (interval, half-perimeter).
[[nodiscard]] std::uint64_t priority_of(CostModel cost, const CollapseMeasure& measure) noexcept;

/// A binary heap of vertices, least entry first. A vertex is in it at most once; the caller sees to that.
class CollapseQueue {
 public:
  void reserve(std::size_t n) { heap_.reserve(n); }
  /// Replaces the contents. Cost: linear.
  void assign(std::vector<QueueEntry> entries);
  void push(const QueueEntry& entry);
  [[nodiscard]] bool empty() const noexcept { return heap_.empty(); }
  [[nodiscard]] const QueueEntry& top() const noexcept { return heap_.front(); }
  void pop();
  /// pop() and push(entry) in one descent.
  void replace_top(const QueueEntry& entry);

 private:
  void sift_down(std::size_t hole, const QueueEntry& entry);
  std::vector<QueueEntry> heap_;
};

}  // namespace ptin
