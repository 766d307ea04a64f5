// SPDX-License-Identifier: GPL-3.0-or-later
//
// Heights at positions: OGC EDR's `position`.
#include <string>
#include <vector>

#include "tools/ask/questions.h"
#include "tools/serve/answer_parts.h"
#include "tools/serve/coverage.h"
#include "tools/serve/questions.h"
#include "tools/serve/wkt_places.h"

namespace ptin::serve {

namespace {

/// The same with the triangles, in the CRS of the client, for a program that shows them.
std::string plain_json(std::span<const MapPoint> client, const LocateResult& result,
                       const Asked& asked, const Places& places) {
  const auto row_at = [&](std::size_t i) {
    ask::LocatedRow row(client[i], result.points[i], asked.facts().map);
    if (row.point.state != PointState::kOutside) places.from_terrain(row.corners);
    return row;
  };
  return points_text(asked, ask::located_fields(), client.size(), row_at,
                     certainty_of(asked, result));
}

}  // namespace

http::Response answer_position(const Asked& asked) {
  const ask::Format& format = format_of(asked);
  auto request = read<LocateRequest>(asked);
  const CoverageNames names = coverage_names(asked);
  const Places places = places_of(asked);
  const std::vector<MapPoint> client = points_of_wkt(asked.question.text("coords"), "coords");
  check_count(client.size(), asked.options.question.points, "positions", "points", "coords");
  std::vector<MapPoint> at = client;
  places.to_terrain(at);
  check_detail(asked, request.detail);
  request.limits = engine_limits(asked, at.size() * kAnswerBytesOfPlace);
  const LocateResult result = asked.terrain().locate(at, request);

  const auto value = [&](std::size_t i) { return value_of(result.points[i]); };
  std::string text = format.name == "json" ? plain_json(client, result, asked, places)
                                           : points_in(format, asked, places, names, client, result,
                                                       coverage_at(client, value));
  return answered(asked, std::move(text), format.media, result);
}

}  // namespace ptin::serve
