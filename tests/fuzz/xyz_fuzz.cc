// SPDX-License-Identifier: GPL-3.0-or-later
//
// Text of any kind is read as points, or refused with an Error that names a line.
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string>

#include "engine/construct/read/xyz_reader.h"
#include "engine/error.h"
#include "tests/fuzz/fuzz_target.h"

PTIN_FUZZ_TARGET(xyz, data, size) {
  ptin::XyzReader reader("fuzz.xyz", std::string(reinterpret_cast<const char*>(data), size));
  ptin::SourcePoint point;
  try {
    while (reader.next(point)) {
      for (const ptin::Decimal d : {point.x, point.y, point.z}) {
        constexpr std::int64_t kLimit = ptin::power_of_ten(18);  // 18 digits are less
        if (d.decimals < 0 || d.decimals > 18 || d.mantissa >= kLimit || d.mantissa <= -kLimit) {
          std::abort();
        }
      }
    }
  } catch (const ptin::Error& e) {
    if (e.code() != ptin::ErrorCode::invalid_argument ||
        e.context().find(':') == std::string::npos) {
      std::abort();
    }
  }
  return 0;
}
