// SPDX-License-Identifier: GPL-3.0-or-later
//
// Lines of sight: one pair, or a thousand.
#include <algorithm>
#include <array>
#include <limits>
#include <string>
#include <vector>

#include "tools/facts/answers.h"
#include "tools/http/problem.h"
#include "tools/serve/answer_parts.h"
#include "tools/serve/questions.h"
#include "tools/serve/wkt_places.h"

namespace ptin::serve {

namespace {

using http::Problem;

constexpr double kSpeedOfLight = 299792458.0;  // metres a second
constexpr double kLeastHertz = 1e6;

constexpr auto kSightParameters = std::to_array<ParameterFact>(
    {{"coords", "string", "the two ends as WKT, LINESTRING of two positions, or a MULTILINESTRING",
      "LINESTRING(-118.3 34.34, -118.29 34.35)"},
     {"pairs", "array", "instead of coords: [x, y, height, x, y, height] each"},
     {"heights", "array", "of the two ends above ground; 2,2 without it", "2,10"},
     {"absolute", "boolean", "heights are not above ground but those of the terrain", "true"},
     {"frequency", "number", "hertz; the first Fresnel zone is measured", "5.8e9"},
     {"curvature", "number", "coefficient of the Earth's curvature and refraction; 0: flat",
      "0.857"},
     {"verdict", "boolean", "only visible or hidden, quicker", "true"},
     kErrorParameter,
     kVerticesParameter,
     kCrsParameter,
     {"f", "string", "json", "json"}});
constexpr auto kSightFormats = std::to_array<OfferedFormat>({{"json", kJson}});

std::vector<SightPair> pairs_of_coords(const Question& question) {
  std::vector<double> heights = question.numbers("heights");
  if (heights.empty()) heights = {2.0, 2.0};
  if (heights.size() != 2) throw Problem(400, "two ends have two heights").at("heights");
  std::vector<SightPair> pairs;
  for (const std::vector<MapPoint>& line : lines_of_wkt(question.needed("coords"), "coords")) {
    if (line.size() != 2) throw Problem(400, "a line of sight has two positions").at("coords");
    pairs.push_back({line[0], heights[0], line[1], heights[1]});
  }
  return pairs;
}

std::vector<SightPair> pairs_of_json(const Question& question, std::size_t most) {
  const nlohmann::json json = question.json("pairs");
  if (!json.is_array() || json.empty()) {
    throw Problem(400, "pairs is an array of [x, y, height, x, y, height]").at("pairs");
  }
  check_count(json.size(), most, "pairs", "pairs", "pairs");
  std::vector<SightPair> pairs;
  for (const nlohmann::json& one : json) {
    std::array<double, 6> n{};
    bool is_pair = one.is_array() && one.size() == n.size();
    for (std::size_t i = 0; is_pair && i < n.size(); ++i) {
      is_pair = one[i].is_number();
      if (is_pair) n[i] = one[i].get<double>();
    }
    if (!is_pair) {
      throw Problem(
          400, "pair " + std::to_string(pairs.size() + 1) + " is no [x, y, height, x, y, height]")
          .at("pairs");
    }
    pairs.push_back({{n[0], n[1]}, n[2], {n[3], n[4]}, n[5]});
  }
  return pairs;
}

SightRequest request_of(const Asked& asked) {
  const Question& q = asked.question;
  const Ground& ground = asked.collection->ground;
  SightRequest request;
  request.absolute = q.flag("absolute");
  request.curvature = {q.number("curvature", Curvature{}.coefficient), ground.earth_diameter};
  request.ground_distance = ground.distance;
  if (const auto hertz = q.number("frequency")) {
    if (*hertz < kLeastHertz) {
      throw Problem(400, "a radio link has 1 MHz at least; give hertz").at("frequency");
    }
    request.wavelength = kSpeedOfLight / *hertz / ground.metres_per_height;
  }
  request.verdict_only = q.flag("verdict");
  request.detail = detail_of(asked);
  request.limits = asked.limits;
  return request;
}

Json point_json(const std::optional<SightPoint>& p, const Places& places) {
  if (!p) return nullptr;
  MapPoint at = p->position;
  places.from_terrain({&at, 1});
  return {{"x", at.x}, {"y", at.y}, {"distance", p->distance}, {"height", p->height}};
}

Json result_json(const SightResult& r, const Places& places) {
  // Of heights above ground that an end does not have there is no verdict.
  const bool is_defined = r.verdict != SightVerdict::kUndefined;
  Json json = {{"verdict", is_defined ? Json(tools::name_of(r.verdict)) : Json()},
               {"ends", {tools::name_of(r.state_a), tools::name_of(r.state_b)}},
               {"length", r.length},
               {"obstruction", point_json(r.obstruction, places)},
               {"clearance", point_json(r.clearance_at, places)},
               {"void_length", r.void_length},
               {"certified_deviation", r.certified_deviation},
               {"exact", r.exact}};
  if (r.clearance_at) {
    json["clearance"]["min"] = r.clearance_min;
    json["clearance"]["max"] = r.clearance_max;
  }
  if (r.fresnel_ratio) {
    json["fresnel"] = point_json(r.fresnel_at, places);
    json["fresnel"]["ratio"] = *r.fresnel_ratio;
  }
  return json;
}

std::vector<SightPair> pairs_of(const Asked& asked, const Places& places) {
  const Question& q = asked.question;
  if (q.has("coords") == q.has("pairs")) {
    throw Problem(400, "give coords (two ends) or pairs").at("coords");
  }
  const std::size_t most = asked.options.question.pairs;
  std::vector<SightPair> pairs = q.has("pairs") ? pairs_of_json(q, most) : pairs_of_coords(q);
  check_count(pairs.size(), most, "pairs", "pairs", "coords");
  const char* parameter = q.has("pairs") ? "pairs" : "coords";
  tools::SideTarget ends_alone;  // A line of sight is straight in the terrain's CRS.
  ends_alone.most_bend = std::numeric_limits<double>::infinity();
  for (SightPair& pair : pairs) {
    const auto lines = places.line_to_terrain({pair.a, pair.b}, ends_alone, parameter);
    if (lines.size() > 1) {
      throw Problem(400,
                    "a line of sight crosses the longitude at which this terrain begins and ends; "
                    "it is answered on one side of it alone")
          .at(parameter);
    }
    pair.a = lines[0][0];
    pair.b = lines[0][1];
  }
  return pairs;
}

/// The certified error of the level of detail at which the lines are looked at.
double certified_error_of(const Asked& asked) {
  LocateRequest request;
  request.detail = detail_of(asked);
  request.limits = asked.limits;
  return asked.terrain().locate({}, request).certified_error;
}

}  // namespace

std::span<const ParameterFact> sight_parameters() noexcept { return kSightParameters; }

http::Response answer_sight(const Asked& asked) {
  static_cast<void>(format_of(asked, kSightFormats));
  const Places places(asked.collection->crs, asked.question.text("crs"), asked.collection->bounds,
                      asked.request.share);
  const std::vector<SightPair> pairs = pairs_of(asked, places);
  constexpr std::size_t kFew = 16;  // For which a coarse level of the whole terrain does not pay.
  SightSolver solver = asked.terrain().sight_lines(
      request_of(asked), pairs.size() > kFew ? SightSolver::kCoarseRecords : 0);
  QueryCost cost = solver.base_cost();
  Json results = Json::array();
  bool is_exact = true;
  double deviation = 0.0;
  for (const SightPair& pair : pairs) {
    const SightResult result = solver.solve(pair);
    cost.add_counts(result.cost);
    cost.seconds += result.cost.seconds;
    is_exact = is_exact && result.exact;
    deviation = std::max(deviation, result.certified_deviation);
    results.push_back(result_json(result, places));
  }
  const double error = certified_error_of(asked);
  Json json = certainty_json(asked, error, deviation, is_exact);
  json["pairs"] = std::move(results);
  http::Response response = json_response(json);
  add_cost(response, cost);
  add_certainty(response, error, is_exact);
  return response;
}

}  // namespace ptin::serve
