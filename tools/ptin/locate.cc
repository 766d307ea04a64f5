// SPDX-License-Identifier: GPL-3.0-or-later
//
// ptin locate: triangle and height at points.
#include <cmath>
#include <memory>

#include "engine/crs/crs_facts.h"
#include "engine/error.h"
#include "engine/query/terrain.h"
#include "tools/error_status.h"
#include "tools/facts/answers.h"
#include "tools/formats/number_text.h"
#include "tools/output/standard_output.h"
#include "tools/ptin/number_rows.h"
#include "tools/ptin/query_options.h"

namespace ptin::tools {

namespace {

struct LocateOptions {
  TerrainOptions terrain;
  std::vector<double> point;
  std::string points;
  DetailOptions detail;
  std::string memory;
};

nlohmann::json point_json(const MapPoint& at, const LocatedPoint& p, const StoreFacts& facts) {
  nlohmann::json json = {{"x", at.x},
                         {"y", at.y},
                         {"state", name_of(p.state)},
                         {"height", p.height},
                         {"height_min", p.height_min},
                         {"height_max", p.height_max}};
  json["triangle"] = nullptr;
  if (p.state != PointState::kOutside) {
    json["triangle"] = nlohmann::json::array();
    for (const LocatedPoint::Corner& c : p.triangle) {
      const MapPoint corner = facts.map.to_map(c.position.x, c.position.y);
      json["triangle"].push_back({corner.x, corner.y, c.height});
    }
  }
  return json;
}

/// Prints one row for each point, in the order of the request; what is unknown is left empty.
void print_rows(const std::vector<MapPoint>& points, const LocateResult& result) {
  std::string text = "x,y,state,height,height_min,height_max\n";
  for (std::size_t i = 0; i < points.size(); ++i) {
    const LocatedPoint& p = result.points[i];
    append_number(text, points[i].x);
    text += ',';
    append_number(text, points[i].y);
    text.append(",").append(name_of(p.state));
    for (const double value : {p.height, p.height_min, p.height_max}) {
      text += ',';
      if (std::isfinite(value)) append_number(text, value);
    }
    text += '\n';
    if (text.size() > 65536) {
      write_to_stdout(text);
      text.clear();
    }
  }
  write_to_stdout(text);
}

int run_locate(const LocateOptions& options, const Context& context) {
  if (options.point.empty() == options.points.empty()) {
    throw Error(ErrorCode::invalid_argument, "give either X Y or --points FILE");
  }
  check_detail(options.detail);
  const Terrain terrain = open_terrain(options.terrain);
  warn_of_base_error(terrain.store(), options.detail.error, context);
  const CrsFacts crs = crs_facts(terrain.store());
  const std::vector<MapPoint> points =
      options.points.empty() ? std::vector<MapPoint>{{options.point[0], options.point[1]}}
                             : read_points(options.points, crs.wkt);
  LocateRequest request;
  request.detail = detail_of(options.detail);
  request.limits = limits_of(options.memory, context);
  const LocateResult result = terrain.locate(points, request);
  if (!context.json) {
    print_rows(points, result);
    return kExitDone;
  }
  nlohmann::json answer = {{"certified_error", result.certified_error},
                           {"certified_deviation", result.certified_deviation},
                           {"exact", result.exact},
                           {"units", units_json(crs)},
                           {"cost", cost_json(result.cost)},
                           {"points", nlohmann::json::array()}};
  for (std::size_t i = 0; i < points.size(); ++i) {
    answer["points"].push_back(point_json(points[i], result.points[i], terrain.store().facts()));
  }
  print_json(answer);
  return kExitDone;
}

}  // namespace

Action declare_locate(CLI::App& app, Context& context) {
  const auto options = std::make_shared<LocateOptions>();
  add_terrain_options(app, options->terrain, true);
  app.add_option("X_Y", options->point, "A point in map units")->expected(2)->type_name("X Y");
  app.add_option("--points", options->points,
                 "Points: text with x and y in the first columns, or in those that a header names "
                 "so (- reads standard input), or a vector file (transformed to the terrain's CRS)")
      ->type_name("FILE");
  add_detail_options(app, options->detail, "; heights come with intervals",
                     "Ask the TIN of the terrain's N most important vertices; heights come with "
                     "intervals");
  add_memory_option(app, options->memory);
  return [options, &context] { return run_locate(*options, context); };
}

}  // namespace ptin::tools
