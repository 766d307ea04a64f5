// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/grid/far_points.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace ptin {

namespace {

constexpr std::uint64_t kFewestPoints = 10;  // below, what is far is a matter of taste

/// Heights that programs write where there is none.
constexpr std::array<double, 7> kNoHeights = {-9999.0,  -99999.0, -999999.0, -32768.0,
                                              -32767.0, -999.0,   -9999.99};

std::string text_of(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.10g", value);
  return text;
}

std::string text_of(const std::array<double, 3>& place) {
  return text_of(place[0]) + " " + text_of(place[1]) + " " + text_of(place[2]);
}

/// How many of the first values lie far from the others.
std::size_t far_values(const EndValues& ends, const EndValues& other_ends, std::uint64_t points) {
  constexpr double kTimes = 10.0;
  const auto& other = other_ends.values;
  const double other_end = -(other.back().points > 0 ? other.back() : other.front()).value;
  std::uint64_t few = 0;
  for (std::size_t i = 0; i + 1 < EndValues::kKept && ends.values[i + 1].points > 0; ++i) {
    few += ends.values[i].points;
    const double reach = other_end - ends.values[i + 1].value;
    const double gap = ends.values[i + 1].value - ends.values[i].value;
    if (few * kFewestPoints <= points && reach > 0.0 && gap > kTimes * reach) {
      return i + 1;
    }
  }
  return 0;
}

}  // namespace

void EndValues::insert(const Value& v) noexcept {
  const auto at = std::find_if(values.begin(), values.end(),
                               [&](const Value& kept) { return v.value <= kept.value; });
  if (at != values.end() && at->value == v.value) {
    at->points += v.points;
    if (v.place < at->place) {
      at->place = v.place;
      at->input = v.input;
    }
    return;
  }
  std::move_backward(at, values.end() - 1, values.end());
  *at = v;
}

void EndValues::join(const EndValues& other) noexcept {
  for (const Value& v : other.values) {
    if (v.points > 0) {
      add(v);
    }
  }
}

void FarPoints::join(const FarPoints& other) noexcept {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    low_[axis].join(other.low_[axis]);
    high_[axis].join(other.high_[axis]);
  }
}

void FarPoints::set_input(std::uint64_t input) noexcept {
  for (auto* const ends : {&low_, &high_}) {
    for (EndValues& of_axis : *ends) {
      for (EndValues::Value& v : of_axis.values) {
        v.input = input;
      }
    }
  }
}

SourceWarnings FarPoints::warnings(std::uint64_t points, const std::vector<std::string>& files,
                                   bool are_vertices) const {
  constexpr double kNear = 100.0;
  constexpr std::array<const char*, 3> kNames = {"x", "y", "height"};
  const std::string point = are_vertices ? "vertex" : "point";
  SourceWarnings found;
  const auto& lowest = low_[2].values;
  const bool is_no_height =
      std::find(kNoHeights.begin(), kNoHeights.end(), lowest[0].value) != kNoHeights.end() &&
      lowest[1].points > 0 && lowest[1].value - lowest[0].value > kNear;
  if (is_no_height) {
    const std::string value = text_of(lowest[0].value);
    found.add({"undeclared_nodata",
               "the height of a " + point + " is " + value +
                   ", which often means that there is none, and no other height is near it; it is "
                   "taken as it is, at " +
                   text_of(lowest[0].place) + "; --nodata " + value + " leaves " +
                   (are_vertices ? "triangles with such corners out" : "such points out"),
               files[lowest[0].input], value, 0, lowest[0].points});
  }
  for (std::size_t axis = 0; axis < 3 && points >= kFewestPoints; ++axis) {
    for (const bool is_low : {true, false}) {
      const EndValues& ends = is_low ? low_[axis] : high_[axis];
      const std::size_t far = far_values(ends, is_low ? high_[axis] : low_[axis], points);
      // Who is warned of a place is not warned of its other coordinates.
      const bool is_told = !found.is_empty() && axis == 2;
      if (far == 0 || is_told) {
        continue;
      }
      std::uint64_t count = 0;
      for (std::size_t i = 0; i < far; ++i) {
        count += ends.values[i].points;
      }
      found.add({"far_points",
                 "a " + point + " lies far from all others, by its " + kNames[axis] + ", at " +
                     text_of(ends.values[0].place) + "; if it is a fault, " +
                     (are_vertices ? "take it out of the file" : "leave it out by --bbox") +
                     (axis == 2 ? ", or by --nodata with its height" : ""),
                 files[ends.values[0].input], "", 0, count});
      return found;
    }
  }
  return found;
}

}  // namespace ptin
