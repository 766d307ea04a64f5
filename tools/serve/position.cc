// SPDX-License-Identifier: GPL-3.0-or-later
//
// Heights at positions: OGC EDR's `position`.
#include <array>
#include <string>
#include <vector>

#include "tools/serve/answer_parts.h"
#include "tools/serve/coverage.h"
#include "tools/serve/questions.h"
#include "tools/serve/wkt_places.h"

namespace ptin::serve {

namespace {

constexpr auto kPositionParameters = std::to_array<ParameterFact>(
    {{"coords", "string", "positions as WKT, POINT or MULTIPOINT", "POINT(-118.3 34.34)", true},
     kErrorParameter,
     kVerticesParameter,
     kCrsParameter,
     kNamesParameter,
     kDatetimeParameter,
     kZParameter,
     {"f", "string", "covjson, geojson, csv or json", "geojson"}});

/// The member `triangle`: its corners in the CRS of the client, null where there is none.
void add_triangle(LongText& text, const LocatedPoint& p, const Asked& asked, const Places& places) {
  text.add(",\"triangle\":");
  if (p.state == PointState::kOutside) {
    text.add("null");
    return;
  }
  std::array<MapPoint, 3> corners{};
  for (std::size_t c = 0; c < 3; ++c) {
    const GridPoint at = p.triangle[c].position;
    corners[c] = asked.facts().map.to_map(at.x, at.y);
  }
  places.from_terrain(corners);
  for (std::size_t c = 0; c < 3; ++c) {
    text.add(c == 0 ? "[[" : ",[").number(corners[c].x).add(",").number(corners[c].y).add(",");
    text.number(p.triangle[c].height).add("]");
  }
  text.add("]");
}

/// The same with the triangles, in the CRS of the client, for a program that shows them.
std::string plain_json(std::span<const MapPoint> client, const LocateResult& result,
                       const Asked& asked, const Places& places) {
  LongText text(asked);
  text.add("{\"points\":[");
  for (std::size_t i = 0; i < client.size(); ++i) {
    text.add(i == 0 ? "{\"x\":" : ",{\"x\":").number(client[i].x);
    text.add(",\"y\":").number(client[i].y).add(",");
    add_members(text, result.points[i]);
    add_triangle(text, result.points[i], asked, places);
    text.add("}");
  }
  text.add("]");
  const Json certainty = certainty_of(asked, result);
  for (const auto& [name, value] : certainty.items()) {
    text.add(",\"").add(name).add("\":").json(value);
  }
  return text.add("}\n").take();
}

}  // namespace

std::span<const ParameterFact> position_parameters() noexcept { return kPositionParameters; }

http::Response answer_position(const Asked& asked) {
  static_cast<void>(asked_names(asked.question));
  const OfferedFormat& format = format_of(asked, kPlaceFormats);
  const Places places(asked.collection->crs, asked.question.text("crs"), asked.collection->bounds,
                      asked.request.share);
  const std::vector<MapPoint> client = points_of_wkt(asked.question.needed("coords"), "coords");
  check_count(client.size(), asked.options.question.points, "positions", "points", "coords");
  std::vector<MapPoint> at = client;
  places.to_terrain(at);
  LocateRequest request;
  request.detail = detail_of(asked);
  request.limits = engine_limits(asked, at.size() * kAnswerBytesOfPlace);
  const LocateResult result = asked.terrain().locate(at, request);

  std::string text;
  if (format.name == "csv") {
    text = points_csv(asked, client, result);
  } else if (format.name == "json") {
    text = plain_json(client, result, asked, places);
  } else if (format.name == "geojson") {
    text = points_geojson(asked, client, result);
  } else {
    const auto value = [&](std::size_t i) { return value_of(result.points[i]); };
    text = coverage_text(asked, places, coverage_at(client, value), certainty_of(asked, result));
  }
  http::Response response = text_response(std::move(text), format.media);
  add_choice(response, asked);
  add_cost(response, result.cost);
  add_certainty(response, result.certified_error, result.exact);
  return response;
}

}  // namespace ptin::serve
