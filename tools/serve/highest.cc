// SPDX-License-Identifier: GPL-3.0-or-later
//
// The highest or lowest point of a window, as GeoJSON.
#include <array>
#include <string>
#include <vector>

#include "tools/facts/answers.h"
#include "tools/serve/answer_parts.h"
#include "tools/serve/questions.h"

namespace ptin::serve {

namespace {

constexpr auto kHighestParameters = std::to_array<ParameterFact>(
    {kBboxParameter,
     {"lowest", "boolean", "the lowest instead", "true"},
     {"listed", "integer", "so many of the highest vertices, 1 without it", "10"},
     kErrorParameter,
     kVerticesParameter,
     kCrsParameter,
     {"f", "string", "geojson", "geojson"}});
constexpr auto kHighestFormats = std::to_array<OfferedFormat>({{"geojson", kGeoJson}});

Json feature_of(const HeightAt& at, const Places& places, Json properties) {
  MapPoint p = at.position;
  places.from_terrain({&p, 1});
  properties["height"] = at.height;
  return {{"type", "Feature"},
          {"geometry", {{"type", "Point"}, {"coordinates", {p.x, p.y}}}},
          {"properties", std::move(properties)}};
}

}  // namespace

std::span<const ParameterFact> highest_parameters() noexcept { return kHighestParameters; }

http::Response answer_highest(const Asked& asked) {
  static_cast<void>(format_of(asked, kHighestFormats));
  const Places places(asked.collection->crs, asked.question.text("crs"), asked.collection->bounds,
                      asked.request.share);
  HighestRequest request;
  if (const auto bbox = asked.question.bbox()) request.region = places.to_terrain(*bbox);
  request.lowest = asked.question.flag("lowest");
  const std::uint64_t listed = asked.question.count("listed").value_or(1);
  check_count(listed, asked.options.question.points, "vertices", "points", "listed");
  request.listed = static_cast<std::uint32_t>(listed);
  request.detail = detail_of(asked);
  request.limits = engine_limits(asked, listed * kAnswerBytesOfPlace);
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
  http::Response response = json_response(
      {{"type", "FeatureCollection"},
       {"state", tools::name_of(result.state)},
       {"features", std::move(features)},
       {"ptin:certainty",
        certainty_json(asked, result.certified_error, result.certified_deviation, result.exact)}},
      kGeoJson);
  add_cost(response, result.cost);
  add_certainty(response, result.certified_error, result.exact);
  return response;
}

}  // namespace ptin::serve
