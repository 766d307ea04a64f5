// SPDX-License-Identifier: GPL-3.0-or-later
//
// What a record, a page and a node of the index are asked by: the arguments of a monotone
// predicate.
#pragma once

#include <cstdint>
#include <limits>

#include "engine/geometry/box.h"
#include "engine/geometry/interval.h"

namespace ptin {

/// The saturated attributes of a record, or the union and maximum of those of a page's or a
/// subtree's records.
struct Attributes {
  GridBox roi;         ///< Region of influence, grid units, closed.
  Interval heights;    ///< Height codes (geometry/height.h); empty where everything is void.
  double error = 0.0;  ///< Certified error at samples, in the height's unit; may be +infinity.
  /// Certified deviation at any point, in the height's unit; may be +infinity.
  double deviation = 0.0;
  friend bool operator==(const Attributes&, const Attributes&) = default;
};

/// Every height, and those of stars that have none.
inline constexpr Interval kAllHeights{-std::numeric_limits<double>::infinity(),
                                      std::numeric_limits<double>::infinity()};

/// The triangles of a star, or of those of a page or a subtree. A page's or a subtree's are the
/// union, the largest error and the least death.
struct StarAttributes {
  GridBox box;         ///< Box of the polygons, grid units, closed.
  Interval heights;    ///< Codes of the vertices that have one; empty when none has.
  double error = 0.0;  ///< All triangles live below it; may be +infinity.
  /// None dies below it; -infinity when one lives on.
  double death = 0.0;
  friend bool operator==(const StarAttributes&, const StarAttributes&) = default;
};

/// A test of stars for the index: true for a page or a subtree when it is true for a star below.
/// Threads: const, callable from several threads at once.
class StarPredicate {
 public:
  StarPredicate() = default;
  StarPredicate(const StarPredicate&) = default;
  StarPredicate& operator=(const StarPredicate&) = default;
  virtual ~StarPredicate() = default;
  [[nodiscard]] virtual bool may_hold(const StarAttributes& a) const noexcept = 0;
  /// A box around S, if this test means "the box meets a fixed set S"; else the box of everything.
  /// Callers may then cut a box into pieces: if the test holds for the whole, it holds for at least
  /// one piece grown by one unit.
  [[nodiscard]] virtual GridBox reach() const noexcept {
    return {INT32_MIN, INT32_MIN, INT32_MAX, INT32_MAX};
  }
};

/// What is asked of stars: a triangle that lives at a level, meets a box and has heights within an
/// interval. All stars of a page that have such a triangle are found, and some others.
struct StarFilter {
  GridBox box{INT32_MIN, INT32_MIN, INT32_MAX, INT32_MAX};
  Interval heights = kAllHeights;  ///< Codes.
  double level = -1.0;             ///< An error; negative: the finest TIN.
  /// Ask for the stars of records of the level's own error too, whatever lives of them.
  bool with_ties = false;
  /// A further condition of pages and subtrees, borrowed; null: none.
  const StarPredicate* also = nullptr;
};

/// A monotone test: once true, it stays true when the arguments grow (engine/DESIGN.md, section
/// 2.3). The index asks it of nodes and pages, the refinement of records. Implementations are in
/// engine/query/select/predicate.h. Threads: const, callable from several threads at once.
class AttributePredicate {
 public:
  AttributePredicate() = default;
  AttributePredicate(const AttributePredicate&) = default;
  AttributePredicate& operator=(const AttributePredicate&) = default;
  virtual ~AttributePredicate() = default;
  [[nodiscard]] virtual bool holds(const Attributes& a) const noexcept = 0;
  /// A box that meets the roi of every record for which the predicate is true: records whose roi
  /// lies elsewhere need not be asked. Where nothing better is known, it is the box of everything.
  [[nodiscard]] virtual GridBox reach() const noexcept {
    return {INT32_MIN, INT32_MIN, INT32_MAX, INT32_MAX};
  }
  /// True only when holds(r) is certain for every record r whose roi is not empty and lies in
  /// `all.roi`, whose heights lie in `all.heights` (or are empty), and whose error is at least
  /// `least_error`. False where that is not certain. Once false, it stays false while `all` grows
  /// or `least_error` falls. No record is asked of a page for which it is true, and a moving window
  /// skips the pages on which its old and its new predicate agree (engine/query/refine).
  [[nodiscard]] virtual bool holds_for_all(const Attributes& all,
                                           double least_error) const noexcept {
    static_cast<void>(all);
    static_cast<void>(least_error);
    return false;
  }
};

}  // namespace ptin
