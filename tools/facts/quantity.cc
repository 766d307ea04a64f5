// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/facts/quantity.h"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "engine/crs/height_unit.h"
#include "engine/number.h"

namespace ptin::tools {

namespace {

/// Names of height_unit_named().
constexpr const char* kLengthUnits[] = {"mm", "cm", "m", "km", "in", "ft", "us-ft", "yd", "mi"};

}  // namespace

std::optional<Quantity> quantity_of(const std::string& text) {
  Quantity quantity;
  std::string_view rest = text;
  const std::optional<double> number = take_number<double>(rest);
  if (!number || !std::isfinite(*number)) return std::nullopt;
  quantity.number = *number;
  quantity.unit = rest;
  quantity.unit.erase(0, quantity.unit.find_first_not_of(' '));
  return quantity;
}

double Length::in(double metres_of_unit) const noexcept {
  constexpr double kAlike = 1e-5;  // of the metres of two units: no two known ones but the feet
  const bool is_alike = std::abs(metres / metres_of_unit - 1) <= kAlike;
  return is_alike ? number : number * metres / metres_of_unit;
}

std::optional<Length> length_of(const std::string& text) {
  const std::optional<Quantity> quantity = quantity_of(text);
  if (!quantity) return std::nullopt;
  if (quantity->unit.empty()) return Length{quantity->number};
  const auto* const known =
      std::find(std::begin(kLengthUnits), std::end(kLengthUnits), quantity->unit);
  if (known == std::end(kLengthUnits)) return std::nullopt;
  return Length{quantity->number, *metres_in(height_unit_named(quantity->unit))};
}

std::string known_length_units() {
  std::string all;
  for (const char* unit : kLengthUnits) all.append(all.empty() ? "" : ", ").append(unit);
  return all;
}

}  // namespace ptin::tools
