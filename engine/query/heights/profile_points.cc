// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/query/heights/profile_points.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "engine/error.h"
#include "engine/geometry/infinity.h"

namespace ptin {

namespace {

/// "line 3 of 7"; where there is one only, "the line".
std::string name_of_line(std::size_t number, std::size_t count) {
  if (count == 1) return "the line";
  std::string name = "line ";
  return name.append(std::to_string(number + 1)).append(" of ").append(std::to_string(count));
}

double distance_between(const MapPoint& a, const MapPoint& b, const ProfileRequest& request) {
  if (request.ground_distance) {
    return request.ground_distance(a, b);
  }
  const double dx = b.x - a.x;
  const double dy = b.y - a.y;
  return std::sqrt(dx * dx + dy * dy);
}

/// The ground where the segment touches the surface in one point alone.
std::optional<double> touched(std::span<const GroundStretch> stretches) {
  const auto found = std::find_if(stretches.begin(), stretches.end(),
                                  [](const GroundStretch& s) { return s.is_surface; });
  return found == stretches.end() ? std::nullopt : std::optional(found->to_code);
}

}  // namespace

SpotLine spot_line(std::span<const MapPoint> line, std::size_t number, std::size_t count,
                   const StoreFacts& facts, const ProfileRequest& request) {
  const SpotMap map(facts.map, facts.bounds);
  SpotLine made;
  made.number = static_cast<std::uint32_t>(number);
  for (const MapPoint& p : line) {
    const std::optional<Spot> spot = map.spot(p);
    if (!spot) {
      refuse("a point of " + name_of_line(number, count) +
             " lies too far from the terrain: give map units of its CRS");
    }
    if (!made.spots.empty() && made.spots.back() == *spot) {
      continue;
    }
    double distance = 0.0;
    if (!made.spots.empty()) {
      distance = made.distances.back() + distance_between(made.positions.back(), p, request);
    }
    made.spots.push_back(*spot);
    made.positions.push_back(p);
    made.distances.push_back(distance);
  }
  return made;
}

void SegmentWriter::write(std::uint32_t part, std::span<const GroundStretch> stretches) {
  part_ = part;
  find_ground(stretches);
  const auto any = [&](auto is_so) {
    return std::any_of(stretches.begin(), stretches.end(), is_so);
  };
  if (!any([](const GroundStretch& s) { return s.from == 0.0; })) {
    put(0.0, std::nullopt, PointState::kOutside);
  }
  double reached = 0.0;
  const GroundStretch* last = nullptr;
  for (const GroundStretch& s : stretches) {
    // Along an edge two triangles hold the same stretch, the surface one of them first.
    if (s.is_point || (last != nullptr && s.from == last->from && s.to == last->to)) continue;
    const PointState state = s.is_surface ? PointState::kSurface : PointState::kVoid;
    put(s.from, ground_at(s.from), state);
    put(s.to, ground_at(s.to), state);
    reached = s.to;
    last = &s;
  }
  if (any([](const GroundStretch& s) { return s.to == 1.0; })) {
    // A line without a stretch touches the domain with its end alone.
    put(1.0, last == nullptr ? touched(stretches) : std::nullopt,
        points_.empty() ? PointState::kOutside : points_.back().state);
  } else {
    put(reached, std::nullopt, PointState::kOutside);
    if (last == nullptr && !stretches.empty()) {  // The line touches a corner of the domain.
      put(stretches.front().from, touched(stretches), PointState::kOutside);
    }
    put(1.0, std::nullopt, PointState::kOutside);
  }
}

/// Ground is where surface is beside the point, and at a vertex that touches surface.
void SegmentWriter::find_ground(std::span<const GroundStretch> stretches) {
  ground_.clear();
  for (const GroundStretch& s : stretches) {
    if (s.is_surface && (!s.is_point || s.is_vertex)) {
      ground_.push_back({s.from, s.from_code});
      ground_.push_back({s.to, s.to_code});
    }
  }
  std::sort(ground_.begin(), ground_.end());
}

std::optional<double> SegmentWriter::ground_at(double share) const {
  const auto found =
      std::lower_bound(ground_.begin(), ground_.end(), GroundPoint{share, -kInfinity});
  return found == ground_.end() || found->share != share ? std::nullopt
                                                         : std::optional(found->code);
}

void SegmentWriter::put(double share, std::optional<double> ground, PointState state) {
  const MapPoint& a = line_.positions[part_];
  const MapPoint& b = line_.positions[part_ + 1];
  const double from = line_.distances[part_];
  const double distance = from + share * (line_.distances[part_ + 1] - from);
  if (points_.empty() || points_.back().line != line_.number ||
      points_.back().distance != distance) {
    ProfilePoint point;
    point.position =
        share == 1.0 ? b : MapPoint{a.x + share * (b.x - a.x), a.y + share * (b.y - a.y)};
    point.distance = distance;
    points_.push_back(point);
  }
  ProfilePoint& point = points_.back();
  point.state = state;
  point.part = part_;
  point.line = line_.number;
  if (ground) {
    point.height = facts_.heights.height_of_code(*ground);
  }
}

}  // namespace ptin
