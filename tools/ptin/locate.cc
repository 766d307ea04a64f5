// SPDX-License-Identifier: GPL-3.0-or-later
//
// ptin locate: triangle and height at points.
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

#include "engine/crs/crs_facts.h"
#include "engine/error.h"
#include "engine/query/questions.h"
#include "tools/ask/questions.h"
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
  AnswerBy by = AnswerBy::kBest;
  std::optional<std::uint64_t> memory;
  OutputOptions answer;
};

int run_locate(const LocateOptions& options, const Context& context) {
  if (options.point.empty() == options.points.empty()) {
    throw Error(ErrorCode::invalid_argument, "give either X Y or --points FILE");
  }
  const AnswerForm form = form_of(options.answer, context.json);
  const Terrain terrain = open_terrain(options.terrain, options.request.detail.tolerance, context);
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
  auto fields = ask::located_fields();
  if (asked.ids.empty()) fields = fields.without("id");
  const auto row_at = [&](std::size_t i) {
    ask::LocatedRow row(asked.all[i], result.points[i], terrain.store().facts().map);
    if (!asked.ids.empty()) row.id = &asked.ids[i];
    return row;
  };
  write_rows(options.answer, form, context, {"points", GeometryKind::kPoint, {}, crs}, fields,
             asked.all.size(), row_at, [&](std::size_t i) { return point_geometry(asked.all[i]); });
  if (context.json) {
    print_answer({{"output", output_json(options.answer)},
                  {"points", objects_of(fields, asked.all.size(), row_at)}},
                 ask::facts_of(result, terrain.store(), crs));
  }
  return kExitDone;
}

void add_question(ask::Parameters& rows, LocateOptions& options) {
  add_terrain(rows, options.terrain, true);
  rows.add("x_y", &options.point, "X Y", "A point").spelled("X_Y").in(ask::Unit::kMap).values(2, 2);
  rows.add("points", &options.points, "FILE",
           "Points: text with x and y in the first columns, or in those that a header names so (- "
           "reads standard input), or a vector file (transformed to the terrain's CRS)")
      .read_by_gdal();
  add_input_choice(rows, options.choice, "points", "x, y");
  ask::add_question(rows, options.request);
  ask::add_by(rows, options.by);
  ask::add_memory(rows, options.memory);
  add_answer_output(rows, options.answer);
}

}  // namespace

Declared declare_locate(Context& context) { return declared<LocateOptions>(context, run_locate); }

}  // namespace ptin::tools
