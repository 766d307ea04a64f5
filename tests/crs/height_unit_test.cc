// SPDX-License-Identifier: GPL-3.0-or-later
//
// Names of units of height, and their lengths.
#include "engine/crs/height_unit.h"

#include <array>
#include <string>
#include <utility>

#include <gtest/gtest.h>

namespace ptin {
namespace {

TEST(HeightUnit, HasOneName) {
  for (const char* name : {"m", "M", "metre", "Meter", "metres", "METERS"}) {
    EXPECT_EQ(height_unit_named(name), "metre") << name;
  }
  for (const char* name : {"ft", "foot", "Feet", "International Foot"}) {
    EXPECT_EQ(height_unit_named(name), "foot") << name;
  }
  for (const char* name : {"us-ft", "ftUS", "US survey foot", "US Survey Feet", "foot_us"}) {
    EXPECT_EQ(height_unit_named(name), "US survey foot") << name;
  }
  EXPECT_EQ(height_unit_named("km"), "kilometre");
  EXPECT_EQ(height_unit_named("DM"), "decimetre");
  EXPECT_EQ(height_unit_named("centimeters"), "centimetre");
  EXPECT_EQ(height_unit_named("mm"), "millimetre");
  EXPECT_EQ(height_unit_named("yards"), "yard");
  EXPECT_EQ(height_unit_named("Fathoms"), "fathom");
}

TEST(HeightUnit, KeepsANameThatNobodyKnows) {
  EXPECT_EQ(height_unit_named("Cubit"), "Cubit");
  EXPECT_EQ(height_unit_named("m "), "m ");
  EXPECT_EQ(height_unit_named("unknown"), "unknown");
  EXPECT_EQ(height_unit_named(""), "unknown");
}

TEST(HeightUnit, IsSoLong) {
  const std::array<std::pair<const char*, double>, 9> lengths = {{{"m", 1.0},
                                                                  {"ft", 0.3048},
                                                                  {"us-ft", 1200.0 / 3937.0},
                                                                  {"km", 1000.0},
                                                                  {"dm", 0.1},
                                                                  {"cm", 0.01},
                                                                  {"mm", 0.001},
                                                                  {"yd", 0.9144},
                                                                  {"fathom", 1.8288}}};
  for (const auto& [name, metres] : lengths) {
    const std::string unit = height_unit_named(name);
    EXPECT_EQ(metres_in(unit), metres) << name;
    EXPECT_EQ(height_unit_named(unit), unit);
  }
}

TEST(HeightUnit, IsOfNoLengthUnlessItIsKnownByItsOneName) {
  for (const char* name : {"", "unknown", "Cubit", "m", "Metre", "degree"}) {
    EXPECT_FALSE(metres_in(name)) << name;
  }
}

}  // namespace
}  // namespace ptin
