// SPDX-License-Identifier: GPL-3.0-or-later
//
// Isolines of a window, as GeoJSON.
#include "tools/ask/isolines.h"

#include <array>
#include <string>
#include <vector>

#include "tools/http/problem.h"
#include "tools/serve/answer_parts.h"
#include "tools/serve/questions.h"

namespace ptin::serve {

namespace {

using http::Problem;

constexpr std::size_t kMostAnswered = 1000;  // Levels of one question.

struct ContourQuestion : ask::IsolineQuestion {
  std::string crs;
};

ask::Parameters parameters_of(ContourQuestion& question) {
  ask::Parameters rows;
  ask::add_isolines(rows, question);
  rows.push_back(ask::crs_row(question.crs));
  return rows;
}

[[noreturn]] void throw_many_levels(const char* parameter) {
  throw Problem(413, "more than " + std::to_string(kMostAnswered) +
                         " levels are asked for; ask for fewer at once, or for a larger interval")
      .at(parameter);
}

/// Levels that the terrain has, and not too many of them.
std::vector<double> levels_of(const Asked& asked, const ask::Levels& levels) {
  if (!levels.given()) {
    throw Problem(400, "give interval or level: the heights of the lines").at("interval");
  }
  const double low = asked.facts().min_height, high = asked.facts().max_height;
  if (levels.interval && !((high - low) / *levels.interval < static_cast<double>(kMostAnswered))) {
    throw_many_levels("interval");
  }
  if (levels.levels.size() > kMostAnswered) throw_many_levels("level");
  return levels.interval ? levels_at(*levels.interval, levels.base, low, high) : levels.levels;
}

/// The positions of a line as arrays of JSON, in the client's CRS.
void add_line(LongText& text, std::span<const MapPoint> points, const Places& places,
              std::vector<MapPoint>& scratch) {
  scratch.assign(points.begin(), points.end());
  places.from_terrain(scratch);
  const char* before = "[[";
  for (const MapPoint& p : scratch) {
    text.add(before).number(p.x).add(",").number(p.y).add("]");
    before = ",[";
  }
  text.add("]");
}

void add_features(LongText& text, const Isolines& lines, const Places& places) {
  std::vector<MapPoint> points, scratch;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    const Isoline line = lines.line(i, points);
    text.add(i == 0 ? "" : ",\n").add(R"({"type":"Feature","properties":{"elev":)");
    text.number(lines.levels()[line.level]).add(R"(,"ring":)").truth(line.ring);
    text.add(R"(},"geometry":{"type":"LineString","coordinates":)");
    add_line(text, line.points, places, scratch);
    text.add("}}");
  }
}

}  // namespace

ask::Parameters isolines_parameters() { return described<ContourQuestion>(); }

http::Response answer_isolines(const Asked& asked) {
  const ask::Format& format = format_of(asked);
  auto question = read<ContourQuestion>(asked);
  const Places places = places_of(asked, question.crs);
  IsolineRequest& request = question.request;
  request.levels = levels_of(asked, question.levels);
  check_detail(asked, request.detail);
  request.limits = engine_limits(asked);
  request.region = window_on_terrain(asked, places, question.region.window);
  LongText text = long_text(asked);
  text.add("{\"type\":\"FeatureCollection\",\"features\":[");
  double certified = asked.facts().base_error, deviation = asked.facts().base_deviation;
  bool is_exact = certified == 0;
  QueryCost cost;
  if (!request.levels.empty()) {
    const Isolines lines = asked.terrain().isolines(request);
    check_count(lines.points(), asked.options.question.vertices, "points of lines", "vertices",
                "bbox");
    add_features(text, lines, places);
    certified = lines.certified_error;
    deviation = lines.certified_deviation;
    is_exact = lines.exact;
    cost = lines.cost;
  }
  text.add("],\"ptin:certainty\":").json(certainty_json(asked, certified, deviation, is_exact));
  return answered(asked, text.add("}\n").take(), format.media, cost, certified, is_exact);
}

}  // namespace ptin::serve
