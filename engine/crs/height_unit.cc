// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/crs/height_unit.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace ptin {

namespace {

struct Unit {
  std::string_view name;
  double metres;
  std::array<std::string_view, 9> aliases;  ///< In small letters.
};

constexpr std::array<Unit, 11> kUnits = {{
    {"metre", 1.0, {"metre", "m", "meter", "meters", "metres", "mtr", "metri"}},
    {"foot", 0.3048, {"foot", "ft", "feet", "international foot", "international feet", "ift"}},
    {"US survey foot",
     1200.0 / 3937.0,
     {"us survey foot", "us-ft", "ftus", "us survey feet", "us_survey_foot", "foot_us", "us ft",
      "sft", "ussurveyfoot"}},
    {"kilometre", 1000.0, {"kilometre", "km", "kilometer", "kilometers", "kilometres"}},
    {"decimetre", 0.1, {"decimetre", "dm", "decimeter", "decimeters", "decimetres"}},
    {"centimetre", 0.01, {"centimetre", "cm", "centimeter", "centimeters", "centimetres"}},
    {"millimetre", 0.001, {"millimetre", "mm", "millimeter", "millimeters", "millimetres"}},
    {"yard", 0.9144, {"yard", "yd", "yards"}},
    {"fathom", 1.8288, {"fathom", "fathoms", "ftm"}},
    {"inch", 0.0254, {"inch", "in", "inches"}},
    {"Statute mile", 1609.344, {"statute mile", "mile", "miles", "mi"}},
}};

}  // namespace

std::string height_unit_named(const std::string& text) {
  if (text.empty()) {
    return "unknown";
  }
  std::string small = text;
  std::transform(small.begin(), small.end(), small.begin(), [](char c) {
    return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  });
  for (const Unit& unit : kUnits) {
    if (std::find(unit.aliases.begin(), unit.aliases.end(), small) != unit.aliases.end()) {
      return std::string(unit.name);
    }
  }
  return text;
}

std::optional<double> metres_in(std::string_view unit) noexcept {
  for (const Unit& known : kUnits) {
    if (known.name == unit) {
      return known.metres;
    }
  }
  return std::nullopt;
}

std::string unit_called(const std::string& name, double metres) {
  constexpr double kAlike = 1e-9;  // the two feet differ by 2e-6
  if (name == "unknown" && metres == 1.0) {
    return name;  // a length of 1 stands for none
  }
  const auto known = std::find_if(kUnits.begin(), kUnits.end(), [&](const Unit& unit) {
    return std::abs(metres - unit.metres) <= kAlike * unit.metres;
  });
  return known == kUnits.end() ? height_unit_named(name) : std::string(known->name);
}

}  // namespace ptin
