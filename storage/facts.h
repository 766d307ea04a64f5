// SPDX-License-Identifier: GPL-3.0-or-later
//
// The facts of a store, to and from the header's bytes.
#pragma once

#include "storage/layout.h"
#include "storage/store_facts.h"

namespace ptin {

/// Fills the fields of the header that hold facts; `page_bytes` and all other fields are left
/// alone.
void put_facts(const StoreFacts& facts, layout::FileHeader& header) noexcept;
[[nodiscard]] StoreFacts facts_of(const layout::FileHeader& header) noexcept;

/// What is wrong with facts, as a sentence; null when nothing is. Sound facts have a finite map
/// with positive steps, a known height type, a finite height encoding with a positive step (step 1
/// and offset 0 for float32), bounds on the grid that are not empty, errors that are not negative,
/// and no NaN.
[[nodiscard]] const char* fault_in(const StoreFacts& facts) noexcept;

}  // namespace ptin
