// SPDX-License-Identifier: GPL-3.0-or-later
//
// LAS files for tests of LAZ, whose points change as those of scans do.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <random>
#include <string>

#include "tests/support/las_file.h"

namespace ptin::oracle {

/// Much stays from point to point, some of it moves a little, and at times anything comes. In formats 6
/// to 10 nothing else changes than what is read of LAZ, and the time.
inline std::string made_las(int format, int extra, std::size_t points, std::uint32_t seed) {
  LasFileMaker las;
  las.minor = format < 6 ? 3 : 4;
  las.format = format;
  las.extra_bytes = extra;
  las.points.resize(points);
  std::string file = las.bytes();
  std::uint32_t first = 0;
  std::uint16_t step = 0;
  std::memcpy(&first, file.data() + 96, sizeof first);
  std::memcpy(&step, file.data() + 105, sizeof step);
  std::mt19937 random(seed);
  const auto chance = [&](std::uint32_t of) { return random() % of == 0; };
  for (std::size_t i = 1; i < points; ++i) {
    char* const p = file.data() + first + i * step;
    std::memcpy(p, p - step, step);
    for (std::size_t at = 0; at < step; at += at < 12 ? 4 : 1) {
      if (format >= 6 && (at == 12 || at == 13 || (at > 16 && at != 22))) continue;
      std::int32_t value = 0;
      if (at < 12 && !chance(20)) {
        std::memcpy(&value, p + at, 4);
        value += static_cast<std::int32_t>(random() % 2000) - 1000;
        std::memcpy(p + at, &value, 4);
      } else if (at < 12 ? chance(4) : chance(12)) {
        value = static_cast<std::int32_t>(random());
        std::memcpy(p + at, &value, at < 12 ? 4 : 1);
      } else if (at >= 12 && chance(6)) {
        ++p[at];
      }
    }
  }
  return file;
}

}  // namespace ptin::oracle
