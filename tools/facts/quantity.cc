// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/facts/quantity.h"

#include <charconv>
#include <cmath>
#include <system_error>

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

}  // namespace ptin::tools
