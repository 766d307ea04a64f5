// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/geometry/morton.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

namespace ptin {
namespace {

RC_GTEST_PROP(Morton, InterleavesTheBitsOfBothCoordinates, (std::uint32_t x, std::uint32_t y)) {
  const std::uint64_t place = morton_position(x, y);
  for (int bit = 0; bit < 32; ++bit) {
    RC_ASSERT((place >> (2 * bit) & 1) == (x >> bit & 1));
    RC_ASSERT((place >> (2 * bit + 1) & 1) == (y >> bit & 1));
  }
}

}  // namespace
}  // namespace ptin
