// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/serve/lines.h"

#include <cmath>
#include <functional>
#include <span>

#include "tools/http/problem.h"
#include "tools/region/straight_sides.h"
#include "tools/serve/wkt_places.h"

namespace ptin::serve {

namespace {

using Lines = std::vector<std::vector<MapPoint>>;

/// The lines of `coords`, in the terrain's CRS.
Lines lines_of(const Asked& asked, const Places& places, const tools::SideTarget& sides) {
  Lines lines = lines_of_wkt(asked.question.needed("coords"), "coords");
  std::size_t positions = 0;
  for (const std::vector<MapPoint>& line : lines) positions += line.size();
  check_count(positions, asked.options.question.points, "positions", "points", "coords");
  for (std::vector<MapPoint>& line : lines) line = places.line_to_terrain(line, sides, "coords");
  return lines;
}

/// Distances as the command line has them: in map units, of degrees in metres.
std::function<double(MapPoint, MapPoint)> distance_of(const Collection& collection) {
  if (!collection.ground.geographic) return {};
  return [ground = collection.ground](MapPoint a, MapPoint b) {
    return ground.distance(a, b) * ground.metres_per_height;
  };
}

double length_of(const Lines& lines, const Collection& collection) {
  const auto distance = distance_of(collection);
  double length = 0.0;
  for (const std::vector<MapPoint>& line : lines) {
    for (std::size_t i = 1; i < line.size(); ++i) {
      const MapPoint &a = line[i - 1], &b = line[i];
      length += distance ? distance(a, b) : std::hypot(b.x - a.x, b.y - a.y);
    }
  }
  return length;
}

double station_step_of(const Asked& asked, double length) {
  const double step = asked.question.number("stations", 0.0);
  if (step < 0) {
    throw http::Problem(400, "the distance between stations is not negative").at("stations");
  }
  const std::size_t most = asked.options.question.vertices;
  if (step == 0 || length / step <= static_cast<double>(most)) return step;
  throw http::Problem(413, "the lines have more than " + std::to_string(most) +
                               " stations so near to each other; ask for a larger distance")
      .at("stations")
      .beyond("vertices");
}

}  // namespace

AlongLines walk_lines(const Asked& asked, const Places& places) {
  const Collection& collection = *asked.collection;
  tools::SideTarget sides = tools::side_target(asked.terrain().store().facts(), false);
  sides.most_points = asked.options.question.vertices;
  const Lines lines = lines_of(asked, places, sides);
  const double length = length_of(lines, collection);
  if (length == 0) throw http::Problem(400, "no line has a length").at("coords");
  ProfileRequest request;
  request.ground_distance = distance_of(collection);
  request.station_step = station_step_of(asked, length);
  request.detail = detail_of(asked);
  request.limits = engine_limits(asked);
  AlongLines along;
  if (!places.is_native()) along.bent_at_most = sides.most_bend;
  along.length_unit = collection.ground.geographic ? "metre" : collection.crs.horizontal_unit;
  along.profile = asked.terrain().profile(lines, request);
  check_count(along.profile.points.size(), asked.options.question.vertices, "points of the profile",
              "vertices", "coords");
  along.client.reserve(along.profile.points.size());
  for (const ProfilePoint& p : along.profile.points) along.client.push_back(p.position);
  for (std::size_t begin = 0, end = 0; begin < along.client.size(); begin = end) {
    while (end < along.client.size() &&
           along.profile.points[end].line == along.profile.points[begin].line) {
      ++end;
    }
    places.from_terrain(std::span(along.client).subspan(begin, end - begin));
  }
  return along;
}

}  // namespace ptin::serve
