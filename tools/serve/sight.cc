// SPDX-License-Identifier: GPL-3.0-or-later
//
// Lines of sight: one pair, or a thousand.
#include <algorithm>
#include <array>
#include <limits>
#include <string>
#include <vector>

#include "tools/ask/questions.h"
#include "tools/http/problem.h"
#include "tools/serve/answer_parts.h"
#include "tools/serve/questions.h"
#include "tools/serve/wkt_places.h"

namespace ptin::serve {

namespace {

using http::Problem;

std::vector<SightPair> pairs_of_coords(const Question& question,
                                       const std::vector<double>& heights) {
  std::vector<SightPair> pairs;
  for (const std::vector<MapPoint>& line : lines_of_wkt(question.text("coords"), "coords")) {
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

std::vector<SightPair> pairs_of(const Asked& asked, const ask::SightQuestion& question,
                                const Places& places) {
  const Question& q = asked.question;
  if (!q.has("coords") && !q.has("pairs")) {
    throw Problem(400, "give coords (two ends) or pairs").at("coords");
  }
  const std::size_t most = asked.options.question.pairs;
  std::vector<SightPair> pairs =
      q.has("pairs") ? pairs_of_json(q, most) : pairs_of_coords(q, question.end_heights);
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
double certified_error_of(const Asked& asked, const DetailRequest& detail) {
  LocateRequest request;
  request.detail = detail;
  request.limits = asked.limits;
  return asked.terrain().locate({}, request).certified_error;
}

}  // namespace

http::Response answer_sight(const Asked& asked) {
  const ask::Format& format = format_of(asked);
  auto question = read<ask::SightQuestion>(asked);
  const Places places = places_of(asked);
  const std::vector<SightPair> pairs = pairs_of(asked, question, places);
  check_detail(asked, question.request.detail);
  ask::set_ground(question, asked.collection->ground);
  question.request.limits = asked.limits;
  SightSolver solver =
      asked.terrain().sight_lines(question.request, ask::coarse_records_for(pairs.size()));
  QueryCost cost = solver.base_cost();
  const auto to_client = [&](std::span<MapPoint> at) { places.from_terrain(at); };
  const auto fields = ask::sight_fields().told(kObject);
  Json results = Json::array();
  bool is_exact = true;
  double deviation = 0.0;
  for (const SightPair& pair : pairs) {
    const SightResult result = solver.solve(pair);
    cost.add_counts(result.cost);
    cost.seconds += result.cost.seconds;
    is_exact = is_exact && result.exact;
    deviation = std::max(deviation, result.certified_deviation);
    results.push_back(fields.object_of(ask::SightRow(result, to_client)));
  }
  const double error = certified_error_of(asked, question.request.detail);
  Json json = certainty_json(asked, error, deviation, is_exact);
  json["pairs"] = std::move(results);
  return answered(asked, text_of(json), format.media, cost, error, is_exact);
}

}  // namespace ptin::serve
