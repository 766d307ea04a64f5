// SPDX-License-Identifier: GPL-3.0-or-later
//
// ptin sight: is one point seen from another.
#include <cmath>
#include <cstdio>
#include <memory>

#include "engine/crs/crs_facts.h"
#include "engine/crs/ground.h"
#include "engine/error.h"
#include "engine/query/terrain.h"
#include "tools/error_status.h"
#include "tools/facts/answers.h"
#include "tools/facts/counts.h"
#include "tools/formats/number_text.h"
#include "tools/output/standard_output.h"
#include "tools/ptin/number_rows.h"
#include "tools/ptin/query_options.h"

namespace ptin::tools {

namespace {

constexpr double kSpeedOfLight = 299792458.0;  // m/s
constexpr std::size_t kFewPairs = 16;          // Fewer pairs are not worth a coarse mesh.

struct SightOptions {
  TerrainOptions terrain;
  std::vector<double> pair;
  std::string pairs;
  bool absolute = false;
  bool verdict_only = false;
  double curvature = Curvature{}.coefficient;
  std::optional<double> frequency;
  DetailOptions detail;
  std::optional<std::uint64_t> budget;
  std::string memory;
};

std::vector<SightPair> pairs_of(const SightOptions& options) {
  if (options.pair.empty() == options.pairs.empty()) {
    throw Error(ErrorCode::invalid_argument, "give either X1 Y1 H1 X2 Y2 H2 or --pairs FILE");
  }
  const std::vector<double> rows =
      options.pairs.empty() ? options.pair : read_rows(options.pairs, 6);
  std::vector<SightPair> pairs;
  for (std::size_t i = 0; i + 5 < rows.size(); i += 6) {
    pairs.push_back({{rows[i], rows[i + 1]}, rows[i + 2], {rows[i + 3], rows[i + 4]}, rows[i + 5]});
  }
  return pairs;
}

SightRequest request_of(const SightOptions& options, const Ground& ground, const Context& context) {
  if (options.frequency && !(*options.frequency > 0 && std::isfinite(*options.frequency))) {
    throw Error(ErrorCode::invalid_argument, "--frequency must be a number > 0, in hertz");
  }
  SightRequest request;
  request.absolute = options.absolute;
  request.curvature = {options.curvature, ground.earth_diameter};
  request.ground_distance = ground.distance;
  if (options.frequency) {
    request.wavelength = kSpeedOfLight / *options.frequency / ground.metres_per_height;
  }
  request.detail = detail_of(options.detail);
  request.limits.memory_bytes = memory_limit_of(options.memory);
  request.budget = options.budget;
  request.verdict_only = options.verdict_only;
  request.limits.stop = context.stop;
  return request;
}

nlohmann::json json_of(const std::optional<SightPoint>& p) {
  if (!p) return nullptr;
  return {
      {"x", p->position.x}, {"y", p->position.y}, {"distance", p->distance}, {"height", p->height}};
}

nlohmann::json json_of(const SightResult& r) {
  nlohmann::json json = {{"verdict", nullptr},
                         {"ends", {name_of(r.state_a), name_of(r.state_b)}},
                         {"length", r.length},
                         {"obstruction", json_of(r.obstruction)},
                         {"clearance", nullptr},
                         {"void_length", r.void_length},
                         {"certified_deviation", r.certified_deviation},
                         {"exact", r.exact},
                         {"cost", cost_json(r.cost)}};
  if (r.verdict != SightVerdict::kUndefined) json["verdict"] = name_of(r.verdict);
  if (r.clearance_at) {
    json["clearance"] = json_of(r.clearance_at);
    json["clearance"]["min"] = r.clearance_min;
    json["clearance"]["max"] = r.clearance_max;
  }
  if (r.fresnel_ratio) {
    json["fresnel"] = json_of(r.fresnel_at);
    json["fresnel"]["ratio"] = *r.fresnel_ratio;
  }
  return json;
}

void append_if_finite(std::string& text, double value) {
  text += ',';
  if (std::isfinite(value)) append_number(text, value);
}

void append_row(std::string& text, const SightResult& r) {
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  text += name_of(r.verdict);
  append_if_finite(text, r.length);
  const SightPoint none{{kNone, kNone}, kNone, kNone, kNone};
  const SightPoint& at = r.obstruction ? *r.obstruction : none;
  for (const double value : {at.position.x, at.position.y, at.distance, r.clearance_min,
                             r.clearance_max, r.clearance_at ? r.clearance_at->distance : kNone,
                             r.void_length, r.fresnel_ratio.value_or(kNone)}) {
    append_if_finite(text, value);
  }
  text += '\n';
}

int run_sight(const SightOptions& options, const Context& context) {
  check_detail(options.detail);
  const std::vector<SightPair> pairs = pairs_of(options);
  const Terrain terrain = open_terrain(options.terrain);
  warn_of_base_error(terrain.store(), options.detail.error, context);
  const CrsFacts crs = crs_facts(terrain.store());
  const SightRequest request = request_of(options, ground_of(crs), context);
  SightSolver solver =
      terrain.sight_lines(request, pairs.size() < kFewPairs ? 0 : std::uint64_t{1} << 15);
  nlohmann::json answers = nlohmann::json::array();
  std::string text =
      "verdict,length,obstruction_x,obstruction_y,obstruction_distance,clearance_min,"
      "clearance_max,clearance_distance,void_length,fresnel_ratio\n";
  for (const SightPair& pair : pairs) {
    SightResult result = solver.solve(pair);
    if (options.pairs.empty()) result.cost.add_counts(solver.base_cost());
    if (context.json) {
      answers.push_back(json_of(result));
    } else {
      append_row(text, result);
    }
  }
  if (!context.json) {
    write_to_stdout(text);
    return kExitDone;
  }
  nlohmann::json units = units_json(crs);
  units["length"] = unit_of_ground(crs);
  if (options.pairs.empty()) {
    nlohmann::json answer = answers.at(0);
    answer["units"] = units;
    print_json(answer);
  } else {
    print_json(
        {{"units", units}, {"base_cost", cost_json(solver.base_cost())}, {"pairs", answers}});
  }
  return kExitDone;
}

}  // namespace

Action declare_sight(CLI::App& app, Context& context) {
  const auto options = std::make_shared<SightOptions>();
  add_terrain_options(app, options->terrain, true);
  app.add_option("PAIR", options->pair,
                 "The two ends in map units, each with its height above ground")
      ->expected(6)
      ->type_name("X1 Y1 H1 X2 Y2 H2");
  app.add_option("--pairs", options->pairs,
                 "Text with such six numbers in each row (- reads standard input)")
      ->type_name("FILE");
  app.add_flag("--absolute", options->absolute, "Heights of the ends are absolute");
  auto* verdict =
      app.add_flag("--verdict", options->verdict_only,
                   "Only the verdict: faster; obstruction is then any point below ground");
  add_curvature_option(app, options->curvature);
  app.add_option("--frequency", options->frequency,
                 "Measure the first Fresnel zone at this frequency, in hertz")
      ->excludes(verdict)
      ->type_name("HZ");
  add_detail_options(app, options->detail, ": finer records are left out; may answer undecided",
                     "Leave out what is not among the terrain's N most important vertices; may "
                     "answer undecided");
  app.add_option("--budget", options->budget,
                 "Stop after this many records for a pair; may answer undecided")
      ->type_name("RECORDS")
      ->check(counts());
  add_memory_option(app, options->memory);
  return [options, &context] { return run_sight(*options, context); };
}

}  // namespace ptin::tools
