// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/serve/lines.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>

#include "tools/ask/questions.h"
#include "tools/http/problem.h"
#include "tools/region/straight_sides.h"
#include "tools/serve/wkt_places.h"

namespace ptin::serve {

namespace {

using Lines = std::vector<std::vector<MapPoint>>;

/// Lines in the terrain's CRS, with the number of the client's line that each of them is: one that
/// leaves a terrain around the whole Earth at one end and enters it at the other is there twice.
struct LinesThere {
  Lines lines;
  std::vector<std::uint32_t> number;
};

/// The lines of `coords`.
LinesThere lines_of(const Asked& asked, const Places& places, const tools::SideTarget& sides) {
  Lines lines = lines_of_wkt(asked.question.text("coords"), "coords");
  std::size_t positions = 0;
  for (const std::vector<MapPoint>& line : lines) positions += line.size();
  check_count(positions, asked.options.question.points, "positions", "points", "coords");
  LinesThere there;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    for (std::vector<MapPoint>& line : places.line_to_terrain(std::move(lines[i]), sides)) {
      there.lines.push_back(std::move(line));
      there.number.push_back(static_cast<std::uint32_t>(i));
    }
  }
  return there;
}

/// Makes one line of those that are the same one in several turns around the Earth: of each what lies
/// in the terrain's turn.
void join_turns(std::vector<ProfilePoint>& points, const LinesThere& there, const Places& places) {
  std::vector<std::size_t> copies(there.number.empty() ? 0 : there.number.back() + 1);
  for (const std::uint32_t number : there.number) ++copies[number];
  std::erase_if(points, [&](ProfilePoint& p) {
    p.line = there.number[p.line];
    return copies[p.line] > 1 && !places.is_in_turn_of_terrain(p.position.x);
  });
  std::stable_sort(points.begin(), points.end(), [](const ProfilePoint& a, const ProfilePoint& b) {
    return a.line != b.line ? a.line < b.line : a.distance < b.distance;
  });
}

double length_of(const LinesThere& there, const ProfileRequest& request) {
  const auto& distance = request.ground_distance;
  double length = 0.0;
  for (std::size_t l = 0; l < there.lines.size(); ++l) {
    if (l > 0 && there.number[l] == there.number[l - 1]) continue;
    const std::vector<MapPoint>& line = there.lines[l];
    for (std::size_t i = 1; i < line.size(); ++i) {
      const MapPoint &a = line[i - 1], &b = line[i];
      length += distance ? distance(a, b) : std::hypot(b.x - a.x, b.y - a.y);
    }
  }
  return length;
}

void check_stations(const Asked& asked, double step, double length) {
  const std::size_t most = asked.options.question.vertices;
  if (step == 0 || length / step <= static_cast<double>(most)) return;
  throw http::Problem(413, "the lines have more than " + std::to_string(most) +
                               " stations so near to each other; ask for a larger distance")
      .at("stations")
      .beyond("vertices");
}

}  // namespace

AlongLines walk_lines(const Asked& asked, ProfileRequest request, const Places& places) {
  const Collection& collection = *asked.collection;
  tools::SideTarget sides = tools::side_target(asked.terrain().store().facts(), 0.0);
  sides.most_points = asked.options.question.vertices;
  const LinesThere there = lines_of(asked, places, sides);
  ask::set_ground(request, collection.ground);
  const double length = length_of(there, request);
  if (length == 0) throw http::Problem(400, "no line has a length").at("coords");
  check_stations(asked, request.station_step, length);
  check_detail(asked, request.detail);
  request.limits = engine_limits(asked);
  AlongLines along;
  if (!places.is_native()) along.bent_at_most = sides.most_bend;
  along.profile = asked.terrain().profile(there.lines, request);
  if (there.number.back() + 1 < there.number.size()) {
    join_turns(along.profile.points, there, places);
  }
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
