// SPDX-License-Identifier: GPL-3.0-or-later
//
// The highest or lowest point of a window, as GeoJSON.
#include "tools/ask/highest.h"

#include <array>
#include <string>
#include <vector>

#include "tools/facts/answers.h"
#include "tools/serve/answer_parts.h"
#include "tools/serve/questions.h"

namespace ptin::serve {

namespace {

struct PeakQuestion : ask::HighestQuestion {
  std::string crs;
};

ask::Parameters parameters_of(PeakQuestion& question) {
  ask::Parameters rows;
  ask::add_highest(rows, question);
  rows.push_back(ask::crs_row(question.crs));
  return rows;
}

Json feature_of(const HeightAt& at, const Places& places, Json properties) {
  MapPoint p = at.position;
  places.from_terrain({&p, 1});
  properties["height"] = at.height;
  return {{"type", "Feature"},
          {"geometry", {{"type", "Point"}, {"coordinates", {p.x, p.y}}}},
          {"properties", std::move(properties)}};
}

}  // namespace

ask::Parameters highest_parameters() { return described<PeakQuestion>(); }

http::Response answer_highest(const Asked& asked) {
  const ask::Format& format = format_of(asked);
  auto question = read<PeakQuestion>(asked);
  const Places places = places_of(asked, question.crs);
  HighestRequest& request = question.request;
  if (question.region.window) request.region = places.to_terrain(*question.region.window);
  check_count(request.listed, asked.options.question.points, "vertices", "points", "listed");
  check_detail(asked, request.detail);
  request.limits = engine_limits(asked, request.listed * kAnswerBytesOfPlace);
  const HighestResult result = asked.terrain().highest(request);
  Json features = Json::array();
  if (result.state == PointState::kSurface) {
    features.push_back(feature_of(result.point, places,
                                  {{"rank", 1},
                                   {"at_vertex", result.at_vertex},
                                   {"height_min", result.height_min},
                                   {"height_max", result.height_max}}));
    for (std::size_t i = result.at_vertex ? 1 : 0; i < result.vertices.size(); ++i) {
      features.push_back(
          feature_of(result.vertices[i], places,
                     {{"rank", i + (result.at_vertex ? 1 : 2)}, {"at_vertex", true}}));
    }
  }
  const Json json = {{"type", "FeatureCollection"},
                     {"state", tools::name_of(result.state)},
                     {"features", std::move(features)},
                     {"ptin:certainty", certainty_of(asked, result)}};
  return answered(asked, text_of(json), format.media, result.cost, result.certified_error,
                  result.exact);
}

}  // namespace ptin::serve
