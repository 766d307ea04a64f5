// SPDX-License-Identifier: GPL-3.0-or-later
//
// ptin sight: is one point seen from another.
#include "tools/ask/sight.h"

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>
#include <ogr_geometry.h>

#include "engine/crs/crs_facts.h"
#include "engine/crs/ground.h"
#include "engine/error.h"
#include "engine/query/terrain.h"
#include "tools/ask/answer_facts.h"
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
  AnswerBy by = AnswerBy::kStars;
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

/// Takes the answers one by one, and puts them where they are asked for.
class SightAnswers {
 public:
  SightAnswers(const SightOptions& options, const Asked<SightPair>& asked, const Context& context,
               const CrsFacts& crs)
      : options_(options),
        asked_(asked),
        is_json_(context.json),
        form_(form_of(options.answer, context.json, {.plot = true})),
        columns_(ask::columns_of(ask::sight_fields(), ask::Door::kProgram, ask::As::kTableRow)) {
    if (asked.ids.empty()) columns_ = without(std::move(columns_), "id");
    ask::add_csv_heading(csv_, columns_);
    if (form_ != AnswerForm::kLayer) return;
    layer_.emplace(options.answer.output, options.answer.overwrite,
                   VectorFile::Layer{"lines_of_sight", wkbLineString,
                                     ask::layer_fields_of(columns_), crs.wkt});
  }

  [[nodiscard]] bool are_plotted() const { return form_ == AnswerForm::kPlot; }

  /// Takes the answer of the next pair with what the plot shows of it.
  void add_plotted(const SightResult& result, PlottedSight sight) {
    sight.title = "line of sight";
    if (!options_.pairs.empty()) sight.title = "pair " + std::to_string(count_ + 1);
    if (!asked_.ids.empty()) sight.title = asked_.ids[count_];
    sight.result = result;
    plotted_.push_back(std::move(sight));
    add(result);
  }

  void add(const SightResult& result) {
    ask::SightRow row(result);
    const SightPair& pair = asked_.all[count_];
    if (!asked_.ids.empty()) row.id = &asked_.ids[count_];
    ++count_;
    if (is_json_) {
      json_.push_back(ask::object_of(ask::sight_fields(), row, ask::Door::kProgram));
    }
    if (layer_) {
      const std::array<MapPoint, 2> ends = {pair.a, pair.b};
      layer_->add(line_geometry(ends, nullptr), ask::layer_values_of(columns_, row));
    }
    if (form_ == AnswerForm::kCsv || (form_ == AnswerForm::kStdout && !is_json_)) {
      ask::add_csv_row(csv_, columns_, row);
    }
  }

  /// Completes what is written. Returns the answers as JSON, where that is asked for.
  ask::Json finish(const SightRequest& request, const PlotUnits& units) {
    if (layer_) layer_->publish();
    if (are_plotted()) {
      plot_sights(options_.answer.output, options_.answer.overwrite, plotted_,
                  {request.curvature, request.wavelength}, units);
    }
    write_csv(options_.answer, form_, is_json_, csv_.take());
    return std::move(json_);
  }

 private:
  const SightOptions& options_;
  const Asked<SightPair>& asked_;
  bool is_json_;
  AnswerForm form_;
  ask::Columns<ask::SightRow> columns_;
  ask::LongText csv_;
  std::optional<VectorFile> layer_;
  std::vector<PlottedSight> plotted_;
  ask::Json json_ = ask::Json::array();
  std::size_t count_ = 0;
};

int run_sight(const SightOptions& options, const Context& context) {
  if (options.pair.empty() == options.pairs.empty()) {
    throw Error(ErrorCode::invalid_argument, "give either X1 Y1 H1 X2 Y2 H2 or --pairs FILE");
  }
  std::ignore = form_of(options.answer, context.json, {.plot = true});  // before the work
  const Terrain terrain = open_terrain(options.terrain, context);
  warn_of_terrain(terrain.store(), options.question.request.detail.tolerance, context);
  const CrsFacts crs = crs_facts(terrain.store());
  const Asked<SightPair> asked = pairs_of(options, plane_of(terrain.store().facts(), crs));
  warn_of_empty_input(asked.all.empty(), options.pairs, "pair", context);
  ask::SightQuestion question = options.question;
  ask::set_ground(question, ground_of(crs));
  SightRequest& request = question.request;
  request.limits = limits_of(options.memory, context);
  SightAnswers answers(options, asked, context, crs);
  if (answers.are_plotted()) require_panels(asked.all.size(), "pairs", options.answer.output);
  const std::string unit = unit_of_ground(crs);
  SightSolver solver =
      terrain.sight_lines(request, ask::coarse_records_for(asked.all.size()), options.by);
  for (const SightPair& pair : asked.all) {
    SightResult result = solver.solve(pair);
    if (options.pairs.empty()) result.cost.add_counts(solver.base_cost());
    answers.are_plotted() ? answers.add_plotted(result, plotted(terrain, request, pair, unit))
                          : answers.add(result);
  }
  std::vector<MapPoint> ends;
  for (const SightPair& pair : asked.all) ends.insert(ends.end(), {pair.a, pair.b});
  warn_of_outside(ends, "end", terrain.store().facts(), crs, context);
  const ask::Json all = answers.finish(request, {unit, unit});
  if (!context.json) return kExitDone;
  ask::Json units = ask::units_json(crs);
  units["length"] = unit;
  ask::Json answer = {{"base_cost", ask::cost_json(solver.base_cost())}, {"pairs", all}};
  if (options.pairs.empty()) answer = all.at(0);
  answer["output"] = output_json(options.answer);
  answer["units"] = units;
  print_json(answer);
  return kExitDone;
}

}  // namespace

Declared declare_sight(Context& context) {
  const auto options = std::make_shared<SightOptions>();
  Declared declared;
  ask::Parameters& rows = declared.parameters;
  add_terrain(rows, options->terrain, true);
  rows.add("pair", &options->pair, "X1 Y1 H1 X2 Y2 H2",
           "The two ends in map units, each with its height above ground, in the "
           "height's unit")
      .spelled("PAIR")
      .values(6, 6);
  rows.add("pairs", &options->pairs, "FILE",
           "Text with such six numbers in each row, or with a header that names x1 y1 "
           "h1 x2 y2 h2 (- reads standard input), or a vector file of lines with "
           "heights at their ends");
  add_input_choice(rows, options->choice, "pairs", "x1, y1, h1, x2, y2, h2");
  ask::add_sight(rows, options->question);
  rows.push_back(ask::by_row(options->by));
  rows.push_back(ask::memory_row(options->memory));
  add_answer_output(rows, options->answer, {.plot = true});
  declared.run = [options, &context] { return run_sight(*options, context); };
  return declared;
}

}  // namespace ptin::tools
