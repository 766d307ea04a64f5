// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/grid/depth_names.h"

#include <gtest/gtest.h>

namespace ptin {
namespace {

TEST(NameOfDepths, HasAWordForThem) {
  for (const char* name : {"depth", "Depth (m)", "sea_floor_depth_below_geoid", "SOUNDG",
                           "water-depths", "Soundings 2019", "VALSOU"}) {
    EXPECT_TRUE(is_name_of_depths(name)) << name;
  }
}

TEST(NameOfDepths, IsNoOtherWordThatBeginsAlike) {
  for (const char* name : {"", "elevation", "surface_altitude", "sound", "in-depthness", "z"}) {
    EXPECT_FALSE(is_name_of_depths(name)) << name;
  }
}

}  // namespace
}  // namespace ptin
