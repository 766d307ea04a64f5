// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/facts/quantity.h"

#include <charconv>
#include <cmath>
#include <system_error>
#include <utility>

namespace ptin::tools {

std::optional<Quantity> quantity_of(const std::string& text) {
  Quantity quantity;
  const char* const end = text.data() + text.size();
  const char* begin = text.data();
  if (text.starts_with('+')) ++begin;
  const auto [rest, fault] = std::from_chars(begin, end, quantity.number);
  if (fault != std::errc() || !std::isfinite(quantity.number)) return std::nullopt;
  quantity.unit.assign(rest, end);
  quantity.unit.erase(0, quantity.unit.find_first_not_of(' '));
  return quantity;
}

std::optional<Length> length_of(const std::string& text) {
  const std::optional<Quantity> quantity = quantity_of(text);
  if (!quantity || !(quantity->number > 0)) return std::nullopt;
  if (quantity->unit.empty()) return Length{quantity->number, false};
  for (const auto& [unit, metres] : {std::pair{"m", 1.0}, {"km", 1000.0}, {"ft", 0.3048}}) {
    if (quantity->unit == unit) return Length{quantity->number * metres, true};
  }
  return std::nullopt;
}

}  // namespace ptin::tools
