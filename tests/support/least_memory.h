// SPDX-License-Identifier: GPL-3.0-or-later
//
// How much memory a question wants, found by asking it with less and less.
#pragma once

#include <cstdint>

#include <gtest/gtest.h>

#include "engine/error.h"

namespace ptin::reference {

/// The least limit, to `step` bytes, at which `ask(limit)` is not refused for want of memory.
template <typename Ask>
std::uint64_t least_memory(const Ask& ask, std::uint64_t step = 1024) {
  std::uint64_t refused = 0, enough = std::uint64_t{1} << 30;
  ask(enough);
  while (enough - refused > step) {
    const std::uint64_t middle = (refused + enough) / 2;
    try {
      ask(middle);
      enough = middle;
    } catch (const Error& e) {
      EXPECT_EQ(e.code(), ErrorCode::resource_exhausted) << e.what();
      refused = middle;
    }
  }
  return enough;
}

}  // namespace ptin::reference
