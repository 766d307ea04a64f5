// SPDX-License-Identifier: GPL-3.0-or-later
//
// The living triangles of a page, taken out of its bytes run by run of records.
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>

#include "engine/query/living/living_stars.h"
#include "storage/attributes.h"
#include "storage/record_page.h"

namespace ptin {

/// Those of ascending steps, ordered heights (storage/page_columns.h), that lie above `low` and not
/// above `high`: with such heights at its corners a triangle has some below and some at or above each.
[[nodiscard]] inline std::span<const std::uint64_t> steps_within(
    std::span<const std::uint64_t> steps, std::uint64_t low, std::uint64_t high) noexcept {
  const auto first = std::upper_bound(steps.begin(), steps.end(), low);
  auto last = first;
  while (last != steps.end() && *last <= high) {
    ++last;
  }
  return {first, last};
}

/// What is asked of the stars of a page. `also` is asked of pages alone.
struct LivingFilter : StarFilter {
  /// Ascending ordered heights, borrowed: only stars around a vertex with a height, with
  /// steps_within() what the corners of their living triangles span. Empty: all.
  std::span<const std::uint64_t> steps;
  /// A condition of the roi of a star's record, borrowed: only the box is set. Null: none.
  const StarPredicate* each = nullptr;
};

/// Appends the triangles of a page that live at the filter's level and whose box meets the filter's,
/// of the stars that are asked for. A star's numbers are unpacked only when one of its triangles
/// lives, and a corner only when it is one of such a triangle's; both are checked, so any bytes are
/// safe. What else a whole ring must be is not looked at (is_star()).
///
/// With `with_ties` the triangles come too that die at the level's own error, and the stars of the
/// records of that error, whole: LivingTies decides which of them are gone.
/// @throws Error corruption  a number cannot be what was written, or the descriptor excludes it;
///                           `out` is as before
void take_living(const RecordPage& page, const LivingFilter& filter, LivingStars& out);

}  // namespace ptin
