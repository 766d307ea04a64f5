// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/grid/dataset_crs.h"

#include <gtest/gtest.h>

namespace ptin {
namespace {

/// The message about a shift of heights in `text`; "" for none.
std::string shift_told(const std::string& text) {
  SourceWarnings warnings;
  warn_of_shift(text, "a.tif", warnings);
  return warnings.all().empty() ? "" : warnings.all()[0].message;
}

TEST(VerticalShift, IsToldByItsNumberInEitherWkt) {
  const std::string told = "shifts heights by 1.5 (Vertical_Shift)";
  EXPECT_NE(shift_told(R"(VERTCS["v",PARAMETER["Vertical_Shift",1.5],UNIT["m",1]])").find(told),
            std::string::npos);
  const std::string wkt2 =
      R"(PARAMETER["Vertical_Shift", 1.5,LENGTHUNIT["metre",1]],CS[vertical,1])";
  EXPECT_NE(shift_told(wkt2).find(told), std::string::npos) << shift_told(wkt2);
}

TEST(VerticalShift, OfZeroIsNone) {
  EXPECT_EQ(shift_told(R"(PARAMETER["Vertical_Shift",0.0,LENGTHUNIT["metre",1]])"), "");
}

}  // namespace
}  // namespace ptin
