// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/read/dxf_units.h"

#include <algorithm>
#include <array>
#include <string_view>

#include "engine/construct/read/byte_reader.h"
#include "engine/construct/read/text_header.h"

namespace ptin {

namespace {

struct DxfUnit {
  std::string_view code, name;
};
constexpr std::array<DxfUnit, 10> kUnits = {{{"1", "inch"},
                                             {"2", "foot"},
                                             {"3", "Statute mile"},
                                             {"4", "millimetre"},
                                             {"5", "centimetre"},
                                             {"6", "metre"},
                                             {"7", "kilometre"},
                                             {"10", "yard"},
                                             {"14", "decimetre"},
                                             {"21", "US survey foot"}}};

}  // namespace

std::string unit_of_dxf(const std::string& path) {
  constexpr int kMostLines = 10'000;
  ByteReader in(path);
  std::string_view line;
  for (int i = 0; i < kMostLines && in.line(line); ++i) {
    if (trimmed(line) == "ENDSEC") {
      break;
    }
    // A variable, the code of its group, its value: a line each.
    if (trimmed(line) != "$INSUNITS" || !in.line(line) || !in.line(line)) {
      continue;
    }
    const auto unit = std::find_if(kUnits.begin(), kUnits.end(),
                                   [&](const DxfUnit& u) { return u.code == trimmed(line); });
    return unit == kUnits.end() ? "" : std::string(unit->name);
  }
  return {};
}

bool has_geodata(const std::string& path) {
  ByteReader in(path);
  std::string_view code, value;
  // A group is a line with its code and one with its value; an object begins with the code 0.
  while (in.line(code) && in.line(value)) {
    if (trimmed(value) == "GEODATA" && trimmed(code) == "0") {
      return true;
    }
    if (code.size() > 16) {
      return false;
    }
  }
  return false;
}

}  // namespace ptin
