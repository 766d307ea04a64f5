// SPDX-License-Identifier: GPL-3.0-or-later
//
// ptin sight: is one point seen from another.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
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
#include "engine/query/questions.h"
#include "tools/error_status.h"
#include "tools/facts/answers.h"
#include "tools/facts/human.h"
#include "tools/facts/numbers.h"
#include "tools/facts/quantity.h"
#include "tools/formats/csv_text.h"
#include "tools/formats/number_text.h"
#include "tools/formats/vector_file.h"
#include "tools/output/file_name.h"
#include "tools/plot/sight_plot.h"
#include "tools/ptin/answer_output.h"
#include "tools/ptin/point_input.h"
#include "tools/ptin/query_options.h"

namespace ptin::tools {

namespace {

constexpr double kSpeedOfLight = 299792458.0;  // m/s
constexpr std::size_t kFewPairs = 16;          // Fewer pairs are not worth a coarse level.

struct SightOptions {
  TerrainOptions terrain;
  std::vector<double> pair;
  std::string pairs;
  InputChoice choice;
  bool absolute = false;
  bool verdict_only = false;
  double curvature = Curvature{}.coefficient;
  std::optional<std::string> frequency;
  DetailOptions detail;
  std::optional<std::uint64_t> budget;
  AnswerBy by = AnswerBy::kStars;
  std::string memory;
  AnswerOptions answer;
};

Asked<SightPair> pairs_of(const SightOptions& options, const TerrainPlane& plane) {
  if (!options.pairs.empty()) return read_pairs(options.pairs, options.choice, plane);
  const std::vector<double>& n = options.pair;
  return {{{{n[0], n[1]}, n[2], {n[3], n[4]}, n[5]}}, {}, {}};
}

/// The frequency in hertz that a text names, as 5.8GHz, 5800MHz or 5.8e9; large and small letters
/// are the same.
/// @throws Error invalid_argument  no number, another unit; below 1 MHz, where a number without its
///                                 unit is what was meant
double hertz_of(const std::string& text) {
  constexpr const char* kOption = "--frequency";
  constexpr std::array<std::pair<const char*, double>, 5> kUnits = {
      {{"", 1.0}, {"hz", 1.0}, {"khz", 1e3}, {"mhz", 1e6}, {"ghz", 1e9}}};
  const std::optional<Quantity> quantity = quantity_of(text);
  const std::string unit = quantity ? lower_case(quantity->unit) : std::string();
  const auto* const known =
      std::find_if(kUnits.begin(), kUnits.end(), [&](const auto& u) { return unit == u.first; });
  if (!quantity || known == kUnits.end()) {
    throw Error(
        ErrorCode::invalid_argument,
        "\"" + text + "\" is no frequency; expected one as 5.8GHz, 5800MHz or 5.8e9 (hertz)",
        kOption);
  }
  const double hertz = quantity->number * known->second;
  constexpr double kLeast = 1e6;
  if (hertz < kLeast || !std::isfinite(hertz)) {
    throw Error(ErrorCode::invalid_argument,
                exact_number(hertz) +
                    " hertz is no radio link's frequency, which is 1 MHz at least; give the unit, "
                    "as 5.8GHz or 5800MHz",
                kOption);
  }
  return hertz;
}

SightRequest request_of(const SightOptions& options, const Ground& ground, const Context& context) {
  SightRequest request;
  request.absolute = options.absolute;
  request.curvature = {options.curvature, ground.earth_diameter};
  request.ground_distance = ground.distance;
  if (options.frequency) {
    request.wavelength = kSpeedOfLight / hertz_of(*options.frequency) / ground.metres_per_height;
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

/// The numbers of an answer, as columns of CSV and attributes of a layer, in the order of kNumbers.
constexpr std::array kNumbers = {
    "length",        "obstruction_x",      "obstruction_y", "obstruction_distance", "clearance_min",
    "clearance_max", "clearance_distance", "void_length",   "fresnel_ratio",        "fresnel_x",
    "fresnel_y",     "fresnel_distance",   "fresnel_height"};
std::array<double, kNumbers.size()> numbers_of(const SightResult& r) {
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  const SightPoint none{{kNone, kNone}, kNone, kNone, kNone};
  const SightPoint& at = r.obstruction ? *r.obstruction : none;
  const SightPoint& zone = r.fresnel_at ? *r.fresnel_at : none;
  return {r.length,
          at.position.x,
          at.position.y,
          at.distance,
          r.clearance_min,
          r.clearance_max,
          r.clearance_at ? r.clearance_at->distance : kNone,
          r.void_length,
          r.fresnel_ratio.value_or(kNone),
          zone.position.x,
          zone.position.y,
          zone.distance,
          zone.height};
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
        form_(form_of(options.answer, context.json, {.plot = true})) {
    csv_ = "verdict";
    for (const char* name : kNumbers) csv_.append(",").append(name);
    csv_ += asked.ids.empty() ? "\n" : ",id\n";
    if (form_ != AnswerForm::kLayer) return;
    using Type = VectorFile::FieldType;
    VectorFile::Layer layer{"lines_of_sight", wkbLineString, {{"verdict", Type::kText}}, crs.wkt};
    for (const char* name : kNumbers) layer.fields.push_back({name, Type::kReal});
    if (!asked.ids.empty()) layer.fields.push_back({"id", Type::kText});
    layer_.emplace(options.answer.output, options.answer.overwrite, layer);
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
    const std::size_t i = count_++;
    if (is_json_) {
      json_.push_back(json_of(result));
      if (!asked_.ids.empty()) json_.back()["id"] = asked_.ids[i];
    }
    if (layer_) add_feature(i, result);
    if (form_ == AnswerForm::kCsv || (form_ == AnswerForm::kStdout && !is_json_)) {
      csv_ += name_of(result.verdict);
      for (const double number : numbers_of(result)) append_csv_number(csv_, number);
      if (!asked_.ids.empty()) append_csv_field(csv_ += ',', asked_.ids[i]);
      csv_ += '\n';
    }
  }

  /// Completes what is written. Returns the answers as JSON, where that is asked for.
  nlohmann::json finish(const SightRequest& request, const PlotUnits& units) {
    if (layer_) layer_->publish();
    if (are_plotted()) {
      plot_sights(options_.answer.output, options_.answer.overwrite, plotted_,
                  {request.curvature, request.wavelength}, units);
    }
    write_csv(options_.answer, form_, is_json_, csv_);
    return std::move(json_);
  }

 private:
  void add_feature(std::size_t i, const SightResult& result) {
    const std::array<MapPoint, 2> ends = {asked_.all[i].a, asked_.all[i].b};
    std::vector<VectorFile::Value> values = {std::string(name_of(result.verdict))};
    for (const double number : numbers_of(result)) values.emplace_back(number);
    if (!asked_.ids.empty()) values.emplace_back(asked_.ids[i]);
    layer_->add(line_geometry(ends, nullptr), values);
  }

  const SightOptions& options_;
  const Asked<SightPair>& asked_;
  bool is_json_;
  AnswerForm form_;
  std::string csv_;
  std::optional<VectorFile> layer_;
  std::vector<PlottedSight> plotted_;
  nlohmann::json json_ = nlohmann::json::array();
  std::size_t count_ = 0;
};

int run_sight(const SightOptions& options, const Context& context) {
  if (options.pair.empty() == options.pairs.empty()) {
    throw Error(ErrorCode::invalid_argument, "give either X1 Y1 H1 X2 Y2 H2 or --pairs FILE");
  }
  std::ignore = form_of(options.answer, context.json, {.plot = true});  // before the work
  if (options.frequency) std::ignore = hertz_of(*options.frequency);
  const Terrain terrain = open_terrain(options.terrain, context);
  warn_of_terrain(terrain.store(), options.detail.error, context);
  const CrsFacts crs = crs_facts(terrain.store());
  const Asked<SightPair> asked = pairs_of(options, plane_of(terrain.store().facts(), crs));
  warn_of_empty_input(asked.all.empty(), options.pairs, "pair", context);
  const SightRequest request = request_of(options, ground_of(crs), context);
  SightAnswers answers(options, asked, context, crs);
  if (answers.are_plotted()) require_panels(asked.all.size(), "pairs", options.answer.output);
  const std::string unit = unit_of_ground(crs);
  SightSolver solver = terrain.sight_lines(
      request, asked.all.size() < kFewPairs ? 0 : SightSolver::kCoarseRecords, options.by);
  for (const SightPair& pair : asked.all) {
    SightResult result = solver.solve(pair);
    if (options.pairs.empty()) result.cost.add_counts(solver.base_cost());
    answers.are_plotted() ? answers.add_plotted(result, plotted(terrain, request, pair, unit))
                          : answers.add(result);
  }
  std::vector<MapPoint> ends;
  for (const SightPair& pair : asked.all) ends.insert(ends.end(), {pair.a, pair.b});
  warn_of_outside(ends, "end", terrain.store().facts(), crs, context);
  const nlohmann::json all = answers.finish(request, {unit, unit});
  if (!context.json) return kExitDone;
  nlohmann::json units = units_json(crs);
  units["length"] = unit;
  nlohmann::json answer = {{"base_cost", cost_json(solver.base_cost())}, {"pairs", all}};
  if (options.pairs.empty()) answer = all.at(0);
  answer["output"] = output_json(options.answer);
  answer["units"] = units;
  print_json(answer);
  return kExitDone;
}

}  // namespace

Action declare_sight(CLI::App& app, Context& context) {
  const auto options = std::make_shared<SightOptions>();
  add_terrain_options(app, options->terrain, true);
  app.add_option("PAIR", options->pair,
                 "The two ends in map units, each with its height above ground")
      ->expected(6)
      ->check(numbers(NumberRange::kFinite, "in map units, or a height in the height's unit"))
      ->type_name("X1 Y1 H1 X2 Y2 H2");
  auto* pairs = app.add_option(
      "--pairs", options->pairs,
      "Text with such six numbers in each row, or with a header that names x1 y1 h1 x2 y2 h2 (- "
      "reads\nstandard input), or a vector file of lines with heights at their ends");
  pairs->type_name("FILE");
  add_input_options(app, options->choice, pairs, "x1, y1, h1, x2, y2, h2");
  app.add_flag("--absolute", options->absolute, "Heights of the ends are absolute");
  auto* verdict =
      app.add_flag("--verdict", options->verdict_only,
                   "Only the verdict: faster; obstruction is then any point below ground");
  add_curvature_option(app, options->curvature);
  app.add_option("--frequency", options->frequency,
                 "Measure the first Fresnel zone at this frequency, as 5.8GHz, 5800MHz or 5.8e9 "
                 "(hertz); 1 MHz at least")
      ->excludes(verdict)
      ->type_name("F");
  add_detail_options(app, options->terrain.measures, options->detail,
                     ": finer records are left out; may answer undecided",
                     "Leave out what is not among the terrain's N most important vertices; may "
                     "answer undecided");
  app.add_option(
         "--budget", options->budget,
         "Stop after this many stars (--by splits: records) for a pair; may answer undecided")
      ->type_name("N")
      ->check(counts());
  add_by_option(app, options->by);
  add_memory_option(app, options->memory);
  add_answer_options(app, options->answer, {.plot = true});
  return [options, &context] { return run_sight(*options, context); };
}

}  // namespace ptin::tools
