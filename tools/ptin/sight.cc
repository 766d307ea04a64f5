// SPDX-License-Identifier: GPL-3.0-or-later
//
// ptin sight: is one point seen from another.
#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

#include "engine/crs/crs_facts.h"
#include "engine/crs/ground.h"
#include "engine/error.h"
#include "engine/query/questions.h"
#include "tools/ask/questions.h"
#include "tools/error_status.h"
#include "tools/facts/human.h"
#include "tools/formats/vector_file.h"
#include "tools/plot/sight_plot.h"
#include "tools/ptin/answer_output.h"
#include "tools/ptin/point_input.h"
#include "tools/ptin/query_options.h"

namespace ptin::tools {

namespace {

struct SightOptions {
  TerrainOptions terrain;
  std::vector<double> pair;
  std::string pairs;
  InputChoice choice;
  ask::SightQuestion question;
  AnswerBy by = AnswerBy::kBest;
  std::optional<std::uint64_t> memory;
  OutputOptions answer;
};

Asked<SightPair> pairs_of(const SightOptions& options, const TerrainPlane& plane) {
  if (!options.pairs.empty()) return read_pairs(options.pairs, options.choice, plane);
  const std::vector<double>& n = options.pair;
  return {{{{n[0], n[1]}, n[2], {n[3], n[4]}, n[5]}}, {}, {}};
}

/// What a plot shows of a pair, beside its answer: the ground below it, and how high its ends are.
PlottedSight plotted(const Terrain& terrain, const SightRequest& request, const SightPair& pair,
                     const std::string& unit) {
  PlottedSight plotted;
  const std::array<MapPoint, 2> line = {pair.a, pair.b};
  if (pair.a != pair.b) {
    ProfileRequest below;
    below.ground_distance = request.ground_distance;
    below.detail = request.detail;
    below.limits = request.limits;
    plotted.profile = terrain.profile(line, below);
  }
  const ShownUnit heights{1.0, short_unit(unit)};
  const auto label_of = [&](double height) {
    return heights.text(height) + (request.absolute ? "" : " above ground");
  };
  plotted.a = {pair.height_a, label_of(pair.height_a)};
  plotted.b = {pair.height_b, label_of(pair.height_b)};
  if (request.absolute) return plotted;
  LocateRequest ground;  // exact below the ends, at a level of detail too
  ground.limits = request.limits;
  const LocateResult ends = terrain.locate(line, ground);
  plotted.a.height += ends.points[0].height;
  plotted.b.height += ends.points[1].height;
  return plotted;
}

int run_sight(const SightOptions& options, const Context& context) {
  if (options.pair.empty() == options.pairs.empty()) {
    throw Error(ErrorCode::invalid_argument, "give either X1 Y1 H1 X2 Y2 H2 or --pairs FILE");
  }
  const AnswerForm form = form_of(options.answer, context.json, {.plot = true});
  const Terrain terrain =
      open_terrain(options.terrain, options.question.request.detail.tolerance, context);
  const CrsFacts crs = crs_facts(terrain.store());
  const Asked<SightPair> asked = pairs_of(options, plane_of(terrain.store().facts(), crs));
  warn_of_empty_input(asked.all.empty(), options.pairs, "pair", context);
  ask::SightQuestion question = options.question;
  ask::set_ground(question, ground_of(crs));
  SightRequest& request = question.request;
  request.limits = limits_of(options.memory, context);
  const bool are_plotted = form == AnswerForm::kPlot;
  if (are_plotted) require_panels(asked.all.size(), "pairs", options.answer.output);
  const std::string unit = unit_of_ground(crs);
  SightSolver solver =
      terrain.sight_lines(request, ask::coarse_records_for(asked.all.size()), options.by);
  std::vector<SightResult> results;
  std::vector<PlottedSight> sights;
  for (const SightPair& pair : asked.all) {
    SightResult result = solver.solve(pair);
    if (options.pairs.empty()) result.cost.add_counts(solver.base_cost());
    if (are_plotted) {
      PlottedSight& sight = sights.emplace_back(plotted(terrain, request, pair, unit));
      sight.title =
          options.pairs.empty() ? "line of sight" : "pair " + std::to_string(sights.size());
      if (!asked.ids.empty()) sight.title = asked.ids[results.size()];
      sight.result = result;
    }
    results.push_back(std::move(result));
  }
  std::vector<MapPoint> ends;
  for (const SightPair& pair : asked.all) ends.insert(ends.end(), {pair.a, pair.b});
  warn_of_outside(ends, "end", terrain.store().facts(), crs, context);
  auto fields = ask::sight_fields();
  if (asked.ids.empty()) fields = fields.without("id");
  const auto row_at = [&](std::size_t i) {
    ask::SightRow row(results[i]);
    if (!asked.ids.empty()) row.id = &asked.ids[i];
    return row;
  };
  if (are_plotted) {
    plot_sights(options.answer.output, options.answer.overwrite, sights,
                {request.curvature, request.wavelength}, {unit, unit});
  } else {
    write_rows(options.answer, form, context, {"lines_of_sight", GeometryKind::kLine, {}, crs},
               fields, results.size(), row_at, [&](std::size_t i) {
                 const std::array<MapPoint, 2> ends_of_line = {asked.all[i].a, asked.all[i].b};
                 return line_geometry(ends_of_line, nullptr);
               });
  }
  if (!context.json) return kExitDone;
  const ask::Json all = objects_of(fields, results.size(), row_at);
  ask::Json units = ask::units_json(crs);
  units["length"] = unit;
  ask::Json answer = {{"base_cost", ask::cost_json(solver.base_cost())}, {"pairs", all}};
  if (options.pairs.empty()) answer = all.at(0);
  answer["output"] = output_json(options.answer);
  answer["units"] = units;
  print_json(answer);
  return kExitDone;
}

void add_question(ask::Parameters& rows, SightOptions& options) {
  add_terrain(rows, options.terrain, true);
  rows.add("pair", &options.pair, "X1 Y1 H1 X2 Y2 H2",
           "The two ends in map units, each with its height above ground, in the height's unit")
      .spelled("PAIR")
      .values(6, 6);
  rows.add("pairs", &options.pairs, "FILE",
           "Text with such six numbers in each row, or with a header that names x1 y1 h1 x2 y2 h2 "
           "(- reads standard input), or a vector file of lines with heights at their ends")
      .read_by_gdal();
  add_input_choice(rows, options.choice, "pairs", "x1, y1, h1, x2, y2, h2");
  ask::add_question(rows, options.question);
  ask::add_by(rows, options.by);
  ask::add_memory(rows, options.memory);
  add_answer_output(rows, options.answer, {.plot = true});
}

}  // namespace

Declared declare_sight(Context& context) { return declared<SightOptions>(context, run_sight); }

}  // namespace ptin::tools
