// SPDX-License-Identifier: GPL-3.0-or-later
//
// ptin locate: triangle and height at points.
#include "tools/ask/locate.h"

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>
#include <ogr_geometry.h>

#include "engine/crs/crs_facts.h"
#include "engine/error.h"
#include "engine/query/terrain.h"
#include "tools/error_status.h"
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
  LocateRequest request;
  AnswerBy by = AnswerBy::kStars;
  std::optional<std::uint64_t> memory;
  OutputOptions answer;
};

/// The answer, point by point.
struct Located {
  const Asked<MapPoint>& asked;
  const LocateResult& result;
  const StoreFile& store;

  [[nodiscard]] ask::LocatedRow row(std::size_t i) const {
    ask::LocatedRow row(asked.all[i], result.points[i], store.facts().map);
    if (!asked.ids.empty()) row.id = &asked.ids[i];
    return row;
  }
  [[nodiscard]] ask::Columns<ask::LocatedRow> columns(ask::As as) const {
    auto columns = ask::columns_of(ask::located_fields(), ask::Door::kProgram, as);
    return asked.ids.empty() ? without(std::move(columns), "id") : columns;
  }
};

/// One row for each point, in the order of the request; what is unknown is left empty.
std::string csv_of(const Located& located) {
  const auto columns = located.columns(ask::As::kTableRow);
  ask::LongText text;
  ask::add_csv_heading(text, columns);
  for (std::size_t i = 0; i < located.asked.all.size(); ++i) {
    ask::add_csv_row(text, columns, located.row(i));
  }
  return text.take();
}

/// The same as a layer of points.
void write_layer(const OutputOptions& options, const Located& located, const CrsFacts& crs) {
  const auto columns = located.columns(ask::As::kFeature);
  VectorFile file(options.output, options.overwrite,
                  {"points", wkbPoint, ask::layer_fields_of(columns), crs.wkt});
  for (std::size_t i = 0; i < located.asked.all.size(); ++i) {
    const ask::LocatedRow row = located.row(i);
    file.add(std::make_unique<OGRPoint>(row.at.x, row.at.y), ask::layer_values_of(columns, row));
  }
  file.publish();
}

ask::Json answer_of(const LocateOptions& options, const Located& located) {
  ask::Json answer = {{"output", output_json(options.answer)}, {"points", ask::Json::array()}};
  for (std::size_t i = 0; i < located.asked.all.size(); ++i) {
    answer["points"].push_back(
        ask::object_of(ask::located_fields(), located.row(i), ask::Door::kProgram));
  }
  return answer;
}

int run_locate(const LocateOptions& options, const Context& context) {
  if (options.point.empty() == options.points.empty()) {
    throw Error(ErrorCode::invalid_argument, "give either X Y or --points FILE");
  }
  const AnswerForm form = form_of(options.answer, context.json);
  const Terrain terrain = open_terrain(options.terrain, context);
  warn_of_terrain(terrain.store(), options.request.detail.tolerance, context);
  const CrsFacts crs = crs_facts(terrain.store());
  const Asked<MapPoint> asked =
      options.points.empty()
          ? Asked<MapPoint>{{{options.point[0], options.point[1]}}, {}, {}}
          : read_points(options.points, options.choice, plane_of(terrain.store().facts(), crs));
  warn_of_empty_input(asked.all.empty(), options.points, "point", context);
  LocateRequest request = options.request;
  request.limits = limits_of(options.memory, context);
  const LocateResult result = terrain.locate(asked.all, request, options.by);
  warn_of_outside(asked.all, "point", terrain.store().facts(), crs, context);
  const Located located{asked, result, terrain.store()};
  if (form == AnswerForm::kLayer) write_layer(options.answer, located, crs);
  if (form == AnswerForm::kCsv || !context.json) {
    write_csv(options.answer, form, context.json, csv_of(located));
  }
  if (context.json) {
    print_answer(answer_of(options, located), ask::facts_of(result, terrain.store(), crs));
  }
  return kExitDone;
}

}  // namespace

Declared declare_locate(Context& context) {
  const auto options = std::make_shared<LocateOptions>();
  Declared declared;
  ask::Parameters& rows = declared.parameters;
  add_terrain(rows, options->terrain, true);
  rows.add("x_y", &options->point, "X Y", "A point")
      .spelled("X_Y")
      .in(ask::Unit::kMap)
      .values(2, 2);
  rows.add("points", &options->points, "FILE",
           "Points: text with x and y in the first columns, or in those that a header "
           "names so (- reads standard input), or a vector file (transformed to the "
           "terrain's CRS)");
  add_input_choice(rows, options->choice, "points", "x, y");
  ask::add_locate(rows, options->request);
  rows.push_back(ask::by_row(options->by));
  rows.push_back(ask::memory_row(options->memory));
  add_answer_output(rows, options->answer);
  declared.run = [options, &context] { return run_locate(*options, context); };
  return declared;
}

}  // namespace ptin::tools
