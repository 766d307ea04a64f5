// SPDX-License-Identifier: GPL-3.0-or-later
//
// Isolines of a window, as GeoJSON.
#include <array>
#include <string>
#include <vector>

#include "tools/ask/questions.h"
#include "tools/http/problem.h"
#include "tools/serve/answer_parts.h"
#include "tools/serve/questions.h"

namespace ptin::serve {

namespace {

using http::Problem;

constexpr std::size_t kMostAnswered = 1000;  // Levels of one question.

[[noreturn]] void throw_many_levels(const char* parameter) {
  throw Problem(413, "more than " + std::to_string(kMostAnswered) +
                         " levels are asked for; ask for fewer at once, or for a larger interval")
      .at(parameter);
}

/// Levels that the terrain has, and not too many of them.
std::vector<double> levels_of(const Asked& asked, const ask::Levels& levels) {
  if (!levels.given() && !asked.question.has("level")) {
    throw Problem(400, "give interval or level: the heights of the lines").at("interval");
  }
  const double low = asked.facts().min_height, high = asked.facts().max_height;
  if (levels.interval && !((high - low) / *levels.interval < static_cast<double>(kMostAnswered))) {
    throw_many_levels("interval");
  }
  if (levels.levels.size() > kMostAnswered) throw_many_levels("level");
  return levels.interval ? levels_at(*levels.interval, levels.base, low, high) : levels.levels;
}

/// The lines as features.
std::string isolines_text(const Asked& asked, const Isolines& lines, const Places& places,
                          const Json& more) {
  std::vector<MapPoint> points, client;
  Isoline line;
  const auto add_geometry = [&](LongText& text, std::size_t i) {
    line = lines.line(i, points);
    client.assign(line.points.begin(), line.points.end());
    places.from_terrain(client);
    text.add(R"({"type":"LineString","coordinates":[)");
    for (std::size_t k = 0; k < client.size(); ++k) {
      add_pair(k == 0 ? text : text.add(","), client[k]);
    }
    text.add("]}");
  };
  const auto row_at = [&](std::size_t) {
    return ask::IsolineRow{0, lines.levels()[line.level], line.ring};
  };
  return features_text(asked, ask::isoline_row_fields(), lines.size(), row_at, add_geometry, more);
}

}  // namespace

http::Response answer_isolines(const Asked& asked) {
  const ask::Format& format = format_of(asked);
  auto question = read<ask::IsolineQuestion>(asked);
  const Places places = places_of(asked);
  IsolineRequest& request = question.request;
  request.levels = levels_of(asked, question.levels);
  check_detail(asked, request.detail);
  request.limits = engine_limits(asked);
  request.region = window_on_terrain(asked, places, question.region.window);
  if (request.levels.empty()) {
    const Certificate base{asked.facts().base_error, asked.facts().base_deviation};
    const bool is_exact = base.error == 0;
    const Json none = {
        {"type", "FeatureCollection"},
        {"features", Json::array()},
        {"ptin:certainty", certainty_json(asked, base.error, base.deviation, is_exact)}};
    return answered(asked, text_of(none), format.media, {}, base.error, is_exact);
  }
  const Isolines lines = asked.terrain().isolines(request);
  check_count(lines.points(), asked.options.question.vertices, "points of lines", "vertices",
              "bbox");
  return answered(
      asked, isolines_text(asked, lines, places, {{"ptin:certainty", certainty_of(asked, lines)}}),
      format.media, lines);
}

}  // namespace ptin::serve
