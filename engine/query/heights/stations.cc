// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/query/heights/stations.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>

#include "engine/error.h"

namespace ptin {

namespace {

constexpr double kNear = 1e-9;  // of the line's length; positions are exact to a spot

/// The point at a distance within the stretch from `a` to `b`.
ProfilePoint between(const ProfilePoint& a, const ProfilePoint& b, double distance) {
  const double share = (distance - a.distance) / (b.distance - a.distance);
  ProfilePoint station = a;
  station.position = {std::lerp(a.position.x, b.position.x, share),
                      std::lerp(a.position.y, b.position.y, share)};
  station.distance = distance;
  station.height = a.state == PointState::kSurface ? std::lerp(a.height, b.height, share)
                                                   : std::numeric_limits<double>::quiet_NaN();
  station.is_station = true;
  return station;
}

/// Appends the points of one line and its stations.
void add_line(std::span<const ProfilePoint> line, double step, std::vector<ProfilePoint>& made) {
  const double near = std::min(kNear * line.back().distance, step / 4);
  double next = 0.0;  // a number of steps
  for (std::size_t i = 0; i < line.size(); ++i) {
    for (; next * step < line[i].distance - near; ++next) {
      made.push_back(between(line[i - 1], line[i], next * step));
    }
    const bool is_at_step = next * step <= line[i].distance + near;
    made.push_back(line[i]);
    made.back().is_station = is_at_step || i + 1 == line.size();
    if (is_at_step) ++next;
  }
}

/// A count of any size, as text.
std::string text_of(double count) {
  char text[32];
  std::snprintf(text, sizeof text, count < 1e15 ? "%.0f" : "%.3g", count);
  return text;
}

}  // namespace

StationCount::StationCount(double step) : step_(step) {
  if (!(step >= 0) || std::isinf(step)) {
    refuse("the distance between stations must be a number above 0");
  }
}

void StationCount::add(double length) noexcept {
  if (step_ > 0) count_ += std::floor(length / step_) + 2;
}

std::uint64_t StationCount::bytes_within(std::uint64_t memory_bytes) const {
  const double bytes = count_ * sizeof(ProfilePoint);
  if (bytes <= static_cast<double>(memory_bytes)) return static_cast<std::uint64_t>(bytes);
  throw Error(ErrorCode::resource_exhausted,
              "up to " + text_of(count_) + " stations take " + text_of(bytes) + " bytes, and " +
                  std::to_string(memory_bytes) +
                  " are allowed; take a larger distance between stations, or more memory");
}

std::vector<ProfilePoint> with_stations(std::span<const ProfilePoint> breaks, double step) {
  const auto end_of_line = [&](std::size_t begin) {
    std::size_t end = begin;
    while (end < breaks.size() && breaks[end].line == breaks[begin].line) ++end;
    return end;
  };
  std::size_t count = breaks.size();
  for (std::size_t begin = 0, end = 0; begin < breaks.size(); begin = end) {
    end = end_of_line(begin);
    count += static_cast<std::size_t>(breaks[end - 1].distance / step) + 1;
  }
  std::vector<ProfilePoint> made;
  made.reserve(count);
  for (std::size_t begin = 0, end = 0; begin < breaks.size(); begin = end) {
    end = end_of_line(begin);
    add_line(breaks.subspan(begin, end - begin), step, made);
  }
  return made;
}

}  // namespace ptin
