// SPDX-License-Identifier: GPL-3.0-or-later
//
// ptin locate: triangle and height at points.
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>
#include <ogr_geometry.h>

#include "engine/crs/crs_facts.h"
#include "engine/error.h"
#include "engine/query/questions.h"
#include "tools/error_status.h"
#include "tools/facts/answers.h"
#include "tools/facts/numbers.h"
#include "tools/formats/csv_text.h"
#include "tools/formats/number_text.h"
#include "tools/formats/vector_file.h"
#include "tools/ptin/answer_output.h"
#include "tools/ptin/point_input.h"
#include "tools/ptin/query_options.h"

namespace ptin::tools {

namespace {

struct LocateOptions {
  TerrainOptions terrain;
  std::vector<double> point;
  std::string points;
  InputChoice choice;
  DetailOptions detail;
  AnswerBy by = AnswerBy::kStars;
  std::string memory;
  AnswerOptions answer;
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

/// One row for each point, in the order of the request; what is unknown is left empty.
std::string csv_of(const Asked<MapPoint>& asked, const LocateResult& result) {
  std::string text = "x,y,state,height,height_min,height_max";
  text += asked.ids.empty() ? "\n" : ",id\n";
  for (std::size_t i = 0; i < asked.all.size(); ++i) {
    const LocatedPoint& p = result.points[i];
    append_number(text, asked.all[i].x);
    text += ',';
    append_number(text, asked.all[i].y);
    text.append(",").append(name_of(p.state));
    for (const double value : {p.height, p.height_min, p.height_max})
      append_csv_number(text, value);
    if (!asked.ids.empty()) append_csv_field(text += ',', asked.ids[i]);
    text += '\n';
  }
  return text;
}

/// The same as a layer of points.
void write_layer(const AnswerOptions& options, const Asked<MapPoint>& asked,
                 const LocateResult& result, const CrsFacts& crs) {
  using Type = VectorFile::FieldType;
  VectorFile::Layer layer{"points",
                          wkbPoint,
                          {{"state", Type::kText},
                           {"height", Type::kReal},
                           {"height_min", Type::kReal},
                           {"height_max", Type::kReal}},
                          crs.wkt};
  if (!asked.ids.empty()) layer.fields.push_back({"id", Type::kText});
  VectorFile file(options.output, options.overwrite, layer);
  for (std::size_t i = 0; i < asked.all.size(); ++i) {
    const LocatedPoint& p = result.points[i];
    std::vector<VectorFile::Value> values = {std::string(name_of(p.state)), p.height, p.height_min,
                                             p.height_max};
    if (!asked.ids.empty()) values.emplace_back(asked.ids[i]);
    file.add(std::make_unique<OGRPoint>(asked.all[i].x, asked.all[i].y), values);
  }
  file.publish();
}

nlohmann::json answer_of(const LocateOptions& options, const Asked<MapPoint>& asked,
                         const LocateResult& result, const StoreFile& store) {
  nlohmann::json answer = {
      {"output", output_json(options.answer)},
      {"certified_error", result.certified_error},
      {"certified_deviation", result.certified_deviation},
      {"border_moved_at_most", border_move_json(store, result.certified_error)},
      {"exact", result.exact},
      {"units", units_json(crs_facts(store))},
      {"cost", cost_json(result.cost)},
      {"points", nlohmann::json::array()}};
  for (std::size_t i = 0; i < asked.all.size(); ++i) {
    nlohmann::json point = point_json(asked.all[i], result.points[i], store.facts());
    if (!asked.ids.empty()) point["id"] = asked.ids[i];
    answer["points"].push_back(std::move(point));
  }
  return answer;
}

int run_locate(const LocateOptions& options, const Context& context) {
  if (options.point.empty() == options.points.empty()) {
    throw Error(ErrorCode::invalid_argument, "give either X Y or --points FILE");
  }
  const AnswerForm form = form_of(options.answer, context.json);
  const Terrain terrain = open_terrain(options.terrain, context);
  warn_of_terrain(terrain.store(), options.detail.error, context);
  const CrsFacts crs = crs_facts(terrain.store());
  const Asked<MapPoint> asked =
      options.points.empty()
          ? Asked<MapPoint>{{{options.point[0], options.point[1]}}, {}, {}}
          : read_points(options.points, options.choice, plane_of(terrain.store().facts(), crs));
  warn_of_empty_input(asked.all.empty(), options.points, "point", context);
  LocateRequest request;
  request.detail = detail_of(options.detail);
  request.limits = limits_of(options.memory, context);
  const LocateResult result = terrain.locate(asked.all, request, options.by);
  warn_of_outside(asked.all, "point", terrain.store().facts(), crs, context);
  if (form == AnswerForm::kLayer) write_layer(options.answer, asked, result, crs);
  if (form == AnswerForm::kCsv || !context.json) {
    write_csv(options.answer, form, context.json, csv_of(asked, result));
  }
  if (context.json) print_json(answer_of(options, asked, result, terrain.store()));
  return kExitDone;
}

}  // namespace

Action declare_locate(CLI::App& app, Context& context) {
  const auto options = std::make_shared<LocateOptions>();
  add_terrain_options(app, options->terrain, true);
  app.add_option("X_Y", options->point, "A point in map units")
      ->expected(2)
      ->check(numbers(NumberRange::kFinite, "in map units"))
      ->type_name("X Y");
  auto* points = app.add_option(
      "--points", options->points,
      "Points: text with x and y in the first columns, or in those that a header names so (- "
      "reads standard input), or a vector file (transformed to the terrain's CRS)");
  points->type_name("FILE");
  add_input_options(app, options->choice, points, "x, y");
  add_detail_options(app, options->terrain.measures, options->detail,
                     "; heights come with intervals",
                     "Ask the TIN of the terrain's N most important vertices; heights come with "
                     "intervals");
  add_by_option(app, options->by);
  add_memory_option(app, options->memory);
  add_answer_options(app, options->answer);
  return [options, &context] { return run_locate(*options, context); };
}

}  // namespace ptin::tools
