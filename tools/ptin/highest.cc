// SPDX-License-Identifier: GPL-3.0-or-later
//
// ptin highest: the highest or the lowest point of a window or a polygon.
#include <cstdio>
#include <memory>

#include <nlohmann/json.hpp>

#include "engine/crs/crs_facts.h"
#include "engine/query/questions.h"
#include "tools/error_status.h"
#include "tools/facts/answers.h"
#include "tools/facts/human.h"
#include "tools/ptin/query_options.h"

namespace ptin::tools {

namespace {

struct HighestOptions {
  TerrainOptions terrain;
  RegionOptions region;
  DetailOptions detail;
  bool lowest = false;
  std::uint32_t listed = 1;
  std::string memory;
};

nlohmann::json position_json(const HeightAt& p) {
  return {{"x", p.position.x}, {"y", p.position.y}, {"height", p.height}};
}

void print_text(const HighestResult& result, const HighestOptions& options, bool has_voids) {
  if (result.state != PointState::kSurface) {
    std::printf("%s\n", name_of(result.state));
    return;
  }
  const auto text = [](const HeightAt& v) {
    return exact_number(v.height) + " at " + exact_number(v.position.x) + " " +
           exact_number(v.position.y);
  };
  const char* border =
      options.region.polygon.empty() ? "on the window's border" : "on the polygon's border";
  std::printf("%s %s (%s)\n", options.lowest ? "lowest" : "highest", text(result.point).c_str(),
              result.at_vertex ? "a vertex" : border);
  if (!result.exact) {
    std::printf("  the source's lies between %s and %s%s\n",
                exact_number(result.height_min).c_str(), exact_number(result.height_max).c_str(),
                has_voids ? ", as long as no void of either comes into it" : "");
  }
  for (const HeightAt& v : result.vertices) std::printf("  vertex %s\n", text(v).c_str());
}

int run_highest(const HighestOptions& options, const Context& context) {
  const Terrain terrain = open_terrain(options.terrain, context);
  warn_of_terrain(terrain.store(), options.detail.error, context);
  const CrsFacts crs = crs_facts(terrain.store());
  const AskedRegion asked = region_of(options.region, terrain.store().facts(), crs);
  tell_transformed(asked.transformed, "the polygon", crs, context);
  HighestRequest request;
  request.region = asked.region;
  request.lowest = options.lowest;
  request.listed = options.listed;
  request.detail = detail_of(options.detail);
  request.limits = limits_of(options.memory, context);
  const HighestResult result = terrain.highest(request);
  if (!context.json) {
    print_text(result, options, !terrain.store().facts().free_of_voids);
    return kExitDone;
  }
  nlohmann::json answer = {
      {"state", name_of(result.state)},
      {"lowest", options.lowest},
      {"point", nullptr},
      {"vertices", nlohmann::json::array()},
      {"certified_error", result.certified_error},
      {"certified_deviation", result.certified_deviation},
      {"border_moved_at_most", border_move_json(terrain.store(), result.certified_error)},
      {"exact", result.exact},
      {"transformed", transformed_json(asked.transformed)},
      {"units", units_json(crs)},
      {"cost", cost_json(result.cost)}};
  if (result.state == PointState::kSurface) {
    answer["point"] = position_json(result.point);
    answer["point"]["at_vertex"] = result.at_vertex;
    answer["point"]["height_min"] = result.height_min;
    answer["point"]["height_max"] = result.height_max;
  }
  for (const HeightAt& v : result.vertices) answer["vertices"].push_back(position_json(v));
  print_json(answer);
  return kExitDone;
}

}  // namespace

Action declare_highest(CLI::App& app, Context& context) {
  const auto options = std::make_shared<HighestOptions>();
  add_terrain_options(app, options->terrain, false);
  add_region_options(app, options->region, RegionKinds::kWithInside);
  app.add_flag("--lowest", options->lowest, "The lowest point instead");
  app.add_option("-k", options->listed, "How many of the highest vertices to list")
      ->type_name("K")
      ->check(CLI::Range(1U, 1000000U))
      ->capture_default_str();
  add_detail_options(
      app, options->terrain.measures, options->detail, "; the height comes with an interval",
      "The highest of the TIN of the terrain's N most important vertices; its height "
      "comes with an interval");
  add_memory_option(app, options->memory);
  return [options, &context] { return run_highest(*options, context); };
}

}  // namespace ptin::tools
