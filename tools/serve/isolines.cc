// SPDX-License-Identifier: GPL-3.0-or-later
//
// Isolines of a window, as GeoJSON.
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

constexpr auto kIsolinesParameters = std::to_array<ParameterFact>(
    {{"interval", "number", "a line at every multiple of this height", "100"},
     {"base", "number", "from which intervals count", "0"},
     {"level", "array", "heights of the lines, instead of an interval"},
     kBboxParameter,
     kErrorParameter,
     kVerticesParameter,
     kCrsParameter,
     {"f", "string", "geojson", "geojson"}});
constexpr auto kIsolinesFormats = std::to_array<OfferedFormat>({{"geojson", kGeoJson}});

[[noreturn]] void throw_many_levels(const char* parameter) {
  throw Problem(413, "more than " + std::to_string(kMostAnswered) +
                         " levels are asked for; ask for fewer at once, or for a larger interval")
      .at(parameter);
}

std::vector<double> levels_of(const Asked& asked) {
  const Question& q = asked.question;
  if (q.has("level") == q.has("interval")) {
    throw Problem(400, "give interval or level: the heights of the lines").at("interval");
  }
  if (q.has("level")) return q.numbers("level");
  const double interval = *q.number("interval"), base = q.number("base", 0.0);
  if (interval <= 0) throw Problem(400, "an interval is above 0").at("interval");
  const double low = asked.facts().min_height, high = asked.facts().max_height;
  if (!((high - low) / interval < static_cast<double>(kMostAnswered)))
    throw_many_levels("interval");
  return levels_at(interval, base, low, high);
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

std::span<const ParameterFact> isolines_parameters() noexcept { return kIsolinesParameters; }

http::Response answer_isolines(const Asked& asked) {
  static_cast<void>(format_of(asked, kIsolinesFormats));
  const Places places(asked.collection->crs, asked.question.text("crs"), asked.collection->bounds,
                      asked.request.share);
  IsolineRequest request;
  request.levels = levels_of(asked);
  if (request.levels.size() > kMostAnswered) throw_many_levels("level");
  request.detail = detail_of(asked);
  request.limits = engine_limits(asked);
  request.region = window_on_terrain(asked, places);
  LongText text(asked);
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
  http::Response response = text_response(text.add("}\n").take(), kGeoJson);
  add_cost(response, cost);
  add_certainty(response, certified, is_exact);
  return response;
}

}  // namespace ptin::serve
