// SPDX-License-Identifier: GPL-3.0-or-later
//
// The facts of a store, to and from the header's bytes.
#pragma once

#include "storage/layout.h"
#include "storage/store_file.h"

namespace ptin {

/// Fills the header's fields of facts; `page_bytes` is left alone.
void put_facts(const StoreFacts& facts, layout::FileHeader& header) noexcept;
[[nodiscard]] StoreFacts facts_of(const layout::FileHeader& header) noexcept;

/// What is wrong with facts, as a sentence; null when nothing is: finite map with positive steps,
/// known height type with a positive step, bounds on the grid and not empty, errors not negative,
/// no NaN.
[[nodiscard]] const char* fault_in(const StoreFacts& facts) noexcept;

}  // namespace ptin
