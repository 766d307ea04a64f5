// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/plot/axis.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

namespace ptin::tools {

namespace {

/// The smallest of 1, 2, 5, 10 ... that is not below `value`.
double round_above(double value) {
  const double below = round_below(value);
  if (below >= value) return below;
  const double decade = std::pow(10.0, std::floor(std::log10(below) + 1e-9));
  const double digit = below / decade;
  return digit < 1.5 ? 2 * decade : (digit < 3 ? 5 * decade : 10 * decade);
}

}  // namespace

double round_below(double value) {
  const double decade = std::pow(10.0, std::floor(std::log10(value)));
  for (const double step : {5.0, 2.0}) {
    if (step * decade <= value) return step * decade;
  }
  return decade;
}

Ticks round_ticks(double low, double high, int most) {
  // Steps below what doubles tell apart at these numbers would not move.
  const double least = std::max({std::abs(low), std::abs(high), 1e-290}) * 1e-12;
  Ticks ticks;
  ticks.step = round_above(std::max((high - low) / most, least));
  const auto count = [&] {
    return std::floor(high / ticks.step) - std::ceil(low / ticks.step) + 1;
  };
  while (count() > most) ticks.step = round_above(ticks.step * 1.01);
  const double first = std::ceil(low / ticks.step);
  for (double i = 0; i < count(); ++i) ticks.at.push_back((first + i) * ticks.step);
  return ticks;
}

std::string tick_text(double value, double step) {
  std::array<char, 64> text{};
  const double decimals = std::max(0.0, std::ceil(-std::log10(step) - 1e-9));
  const double shown = std::abs(value) < step / 2 ? 0.0 : value;
  if (std::abs(value) >= 1e9 || decimals > 9) {
    std::snprintf(text.data(), text.size(), "%.14g", shown);
  } else {
    std::snprintf(text.data(), text.size(), "%.*f", static_cast<int>(decimals), shown);
  }
  return text.data();
}

std::string short_unit(const std::string& name) {
  if (name == "unknown") return {};
  if (name == "metre" || name == "m" || name == "meter") return "m";
  if (name == "kilometre") return "km";
  const bool is_foot =
      name.find("foot") != std::string::npos || name.find("feet") != std::string::npos;
  return is_foot ? "ft" : name;
}

std::string ShownUnit::title(const std::string& what) const {
  return name.empty() ? what : what + ", " + name;
}

std::string ShownUnit::text(double length) const {
  // A short part of a long line: 95 m say more than 0.095 km.
  constexpr double kMetresInKilometre = 1000;
  if (name == "km" && size == kMetresInKilometre && std::abs(length) < kMetresInKilometre) {
    return ShownUnit{1.0, "m"}.text(length);
  }
  std::array<char, 32> text{};
  const double shown = length / size;
  std::snprintf(text.data(), text.size(), std::abs(shown) >= 1000 ? "%.0f" : "%.4g", shown);
  return std::string(text.data()).append(name.empty() ? "" : " ").append(name);
}

ShownUnit shown_unit(const std::string& unit_name, double longest) {
  const std::string name = short_unit(unit_name);
  if (name == "m" && longest >= 10'000) return {1000.0, "km"};
  return {1.0, name};
}

}  // namespace ptin::tools
