// SPDX-License-Identifier: GPL-3.0-or-later
//
// Which stars of a page may have what is asked for, by the numbers of their records alone.
#pragma once

#include <cstdint>

#include "engine/query/living/living_page.h"

namespace ptin {

/// Bits of the greatest error of which no record has a star that lives at a filter's level; negative:
/// any record may have one.
[[nodiscard]] inline std::int64_t most_error_below(const LivingFilter& filter) noexcept {
  return std::int64_t{level_bits(filter.level)} - (filter.with_ties ? 1 : 0);
}

/// Which records of a run may have a star that a filter asks for, as far as box, level and heights
/// tell: bit k for record k of the run. Nothing is checked.
/// @param is_within  All stars of the page lie in the filter's box.
[[nodiscard]] std::uint64_t chosen_stars(const RecordPage& page, const LivingFilter& filter,
                                         bool is_within, PageRun& run);

}  // namespace ptin
