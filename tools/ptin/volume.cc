// SPDX-License-Identifier: GPL-3.0-or-later
//
// ptin volume: cut and fill against a level or another terrain.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "engine/crs/crs_facts.h"
#include "engine/crs/ground.h"
#include "engine/error.h"
#include "engine/query/questions.h"
#include "tools/error_status.h"
#include "tools/facts/answers.h"
#include "tools/facts/human.h"
#include "tools/formats/csv_text.h"
#include "tools/formats/number_text.h"
#include "tools/plot/volume_plot.h"
#include "tools/ptin/answer_output.h"
#include "tools/ptin/query_options.h"
#include "tools/ptin/source_counts.h"
#include "tools/thread_count.h"

namespace ptin::tools {

namespace {

constexpr AnswerKinds kAnswerKinds{.layer = false, .plot = true};

struct VolumeOptions {
  TerrainOptions terrain;
  LevelOptions levels;
  std::string against;
  RegionOptions region;
  DetailOptions detail;
  int threads = 0;
  std::string memory;
  AnswerOptions answer;
};

void warn(const std::string& what, const Context& context) {
  if (context.quiet || context.json) return;
  std::fprintf(stderr, "ptin: warning: %s\n", what.c_str());
}

bool knows_height_unit(const CrsFacts& crs) { return crs.vertical_unit != "unknown"; }

/// Heights' units of FILE in one of OTHER's. Where one of the two does not know its unit, it takes
/// that of the other one.
double height_scale(CrsFacts& file, const CrsFacts& other, const VolumeOptions& options,
                    const Context& context) {
  if (knows_height_unit(file) && knows_height_unit(other)) {
    return ground_of(other).metres_per_height / ground_of(file).metres_per_height;
  }
  if (knows_height_unit(file) != knows_height_unit(other)) {
    warn("nothing tells the unit of the heights of " +
             (knows_height_unit(file) ? options.against : options.terrain.file) +
             "; taken to be that of the other terrain",
         context);
    if (!knows_height_unit(file)) file.vertical_unit = other.vertical_unit;
  }
  return 1.0;
}

/// @throws Error invalid_argument  positions or heights of the two cannot be compared
void check_comparable(const CrsFacts& file, const CrsFacts& other, const VolumeOptions& options,
                      const Context& context) {
  if (!is_same_plane(file, other)) {
    throw Error(ErrorCode::invalid_argument,
                "its CRS (" + (other.name.empty() ? other.horizontal_unit : other.name) +
                    ") is not that of " + options.terrain.file + " (" +
                    (file.name.empty() ? file.horizontal_unit : file.name) +
                    "); transform the source of one and build it again",
                options.against);
  }
  if (!file.vertical_name.empty() && !other.vertical_name.empty() &&
      file.vertical_text() != other.vertical_text()) {
    throw Error(ErrorCode::invalid_argument,
                "its heights (" + other.vertical_name + ") do not count from where those of " +
                    options.terrain.file + " (" + file.vertical_name +
                    ") do; transform the source of one and build it again",
                options.against);
  }
  if (file.wkt.empty() != other.wkt.empty()) {
    warn("the CRS of " + (file.wkt.empty() ? options.terrain.file : options.against) +
             " is unknown; taken to be that of the other terrain",
         context);
  }
}

VolumeRequest request_of(const VolumeOptions& options, const CrsFacts& crs,
                         const std::optional<Region>& region, const Context& context) {
  VolumeRequest request;
  request.region = region;
  request.detail = detail_of(options.detail);
  const Ground ground = ground_of(crs);
  request.ground = {ground.per_map_unit, !ground.geographic};
  // Borders move by metres where map units are degrees, and by map units elsewhere.
  const double ground_per_move =
      ground.geographic ? 1 / ground.metres_per_height : ground.per_map_unit({0, 0}).x;
  request.border_move = [ground_per_move](const StoreFile& store, double certified_error) {
    return ground_per_move * border_moved_at_most(store, certified_error);
  };
  request.limits = limits_of(options.memory, context);
  request.threads = thread_count(options.threads);
  return request;
}

nlohmann::json interval_json(const CertifiedVolume& v) {
  return {{"volume", v.value}, {"low", v.low}, {"high", v.high}};
}

/// The result of a level, or of the other terrain.
nlohmann::json volumes_json(const VolumeResult& result) {
  return {{"cut", interval_json(result.cut)},
          {"fill", interval_json(result.fill)},
          {"net", interval_json(result.net)},
          {"rounding", result.rounding},
          {"mean_difference", number_or_null(result.mean_difference)},
          {"area",
           {{"surface", result.surface_area},
            {"cut", result.cut_area},
            {"fill", result.fill_area},
            {"void", result.void_area},
            {"only_file", result.only_here_area},
            {"only_against", result.only_other_area}}}};
}

void print_answer(std::span<const VolumeResult> results, std::span<const double> levels,
                  const VolumeOptions& options, const Terrain& terrain, const Terrain* other,
                  const CrsFacts& crs, const std::optional<Transformed>& transformed) {
  const VolumeResult& result = results.front();
  nlohmann::json units = units_json(crs);
  units["ground"] = unit_of_ground(crs);
  nlohmann::json answer = {
      {"output", output_json(options.answer)},
      {"against", nullptr},
      {"certified_error", result.certificate.error},
      {"certified_deviation", result.certificate.deviation},
      {"border_moved_at_most", border_move_json(terrain.store(), result.certificate.error)},
      {"exact", result.exact},
      {"transformed", transformed_json(transformed)},
      {"units", units},
      {"cost", cost_json(result.cost)}};
  if (levels.size() > 1) {
    for (std::size_t i = 0; i < levels.size(); ++i) {
      answer["levels"].push_back(volumes_json(results[i]));
      answer["levels"].back()["level"] = levels[i];
    }
  } else {
    answer.update(volumes_json(result));
    answer["level"] = other == nullptr ? nlohmann::json(levels[0]) : nlohmann::json();
  }
  if (other != nullptr) {
    const Certificate& c = result.other_certificate;
    answer["against"] = {{"file", options.against},
                         {"certified_error", c.error},
                         {"certified_deviation", c.deviation},
                         {"border_moved_at_most", border_move_json(other->store(), c.error)}};
  }
  print_json(answer);
}

/// A row for each level: a stage-storage curve.
std::string csv_of(std::span<const VolumeResult> results, std::span<const double> levels) {
  std::string text =
      "level,cut,cut_low,cut_high,fill,fill_low,fill_high,net,net_low,net_high,"
      "surface_area,cut_area,fill_area,void_area\n";
  for (std::size_t i = 0; i < results.size(); ++i) {
    const VolumeResult& r = results[i];
    append_number(text, levels[i]);
    for (const CertifiedVolume* v : {&r.cut, &r.fill, &r.net}) {
      for (const double number : {v->value, v->low, v->high}) append_csv_number(text, number);
    }
    for (const double area : {r.surface_area, r.cut_area, r.fill_area, r.void_area}) {
      append_csv_number(text, area);
    }
    text += '\n';
  }
  return text;
}

/// The levels that are asked for: none where another terrain stands in their place.
std::vector<double> levels_asked(const VolumeOptions& options, const StoreFacts& facts) {
  constexpr std::size_t kMost = 10'000;
  std::vector<double> levels =
      options.levels.given() ? levels_of(options.levels, facts) : std::vector<double>{0.0};
  if (levels.size() > kMost) {
    refuse("there are " + grouped(levels.size()) + " levels, more than " + grouped(kMost) +
               "; give a larger --interval",
           "--interval");
  }
  return levels;
}

void print_text(const VolumeResult& result, const VolumeOptions& options, const CrsFacts& crs) {
  const std::string unit = unit_of_ground(crs);
  const std::string known = plural_of(unit == "unknown" ? "unit" : unit);
  const std::string than = options.against.empty() ? "the level" : options.against;
  const std::string& here = options.terrain.file;
  const auto volume = [&](const char* name, const CertifiedVolume& v, const std::string& where) {
    const double off = std::max({result.rounding, v.high - v.value, v.value - v.low});
    std::printf("%-5s %s cubic %s", name, grouped_number(v.value, off).c_str(), known.c_str());
    if (!result.exact) {
      std::printf(", the source's between %s and %s", grouped_number(v.low, off).c_str(),
                  grouped_number(v.high, off).c_str());
    }
    std::printf("%s\n", where.c_str());
  };
  volume("cut", result.cut, ": " + here + " is above " + than + ", material to take away");
  volume("fill", result.fill, ": " + here + " is below " + than + ", material to bring");
  volume("net", result.net, ": cut less fill");
  const double off = 1e-9 * (result.surface_area + result.void_area);  // beyond what rounding does
  const auto area = [off](double value) { return grouped_number(value, off); };
  std::printf("area  %s square %s: cut %s, fill %s; void %s\n", area(result.surface_area).c_str(),
              known.c_str(), area(result.cut_area).c_str(), area(result.fill_area).c_str(),
              area(result.void_area).c_str());
  if (!options.against.empty()) {
    std::printf("      surface in %s alone %s, in %s alone %s\n", options.terrain.file.c_str(),
                area(result.only_here_area).c_str(), options.against.c_str(),
                area(result.only_other_area).c_str());
  }
  if (std::isfinite(result.mean_difference)) {
    const double of_net = std::max({2 * result.rounding, result.net.high - result.net.value,
                                    result.net.value - result.net.low});
    std::printf("mean  %s %s\n",
                grouped_number(result.mean_difference, of_net / result.surface_area).c_str(),
                known.c_str());
  }
}

int run_volume(const VolumeOptions& options, const Context& context) {
  if (options.levels.given() != options.against.empty()) {
    throw Error(ErrorCode::invalid_argument,
                "a volume is measured against --level H..., --interval D or --against OTHER; give "
                "one of them");
  }
  const AnswerForm form = form_of(options.answer, context.json, kAnswerKinds);
  if (!options.answer.output.empty() && !options.against.empty()) {
    refuse("a table or a plot is of levels, and another terrain has none; leave -o out",
           options.answer.output);
  }
  const Terrain terrain = open_terrain(options.terrain, context);
  warn_of_terrain(terrain.store(), options.detail.error, context);
  CrsFacts crs = crs_facts(terrain.store());
  std::optional<Terrain> other;
  double other_height_scale = 1.0;
  if (!options.against.empty()) {
    TerrainOptions of_other = options.terrain;
    of_other.file = options.against;
    other = open_terrain(of_other, context);
    warn_of_terrain(other->store(), options.detail.error, context);
    const CrsFacts crs_of_other = crs_facts(other->store());
    check_comparable(crs, crs_of_other, options, context);
    other_height_scale = height_scale(crs, crs_of_other, options, context);
  }
  const AskedRegion asked = region_of(options.region, terrain.store().facts(), crs);
  tell_transformed(asked.transformed, "the polygon", crs, context);
  VolumeRequest request = request_of(options, crs, asked.region, context);
  request.other = other ? &*other : nullptr;
  request.other_height_scale = other_height_scale;
  const std::vector<double> levels = levels_asked(options, terrain.store().facts());
  if (!other) request.level = levels.front();
  const std::vector<VolumeResult> results = terrain.volumes(
      request, other ? std::span<const double>{&request.level, 1} : std::span(levels));
  const VolumeResult& result = results.front();
  if (result.surface_area == 0 && has_surface(terrain.store())) {
    warn("no surface lies in the region" +
             (other ? ", or none of both terrains at one place" : std::string()) +
             ": all volumes are 0; ask for another --window or --polygon",
         context);
  }
  const bool is_table = results.size() > 1 || !options.answer.output.empty();
  if (form == AnswerForm::kPlot) {
    plot_volumes(options.answer.output, options.answer.overwrite, results, levels,
                 {unit_of_ground(crs), crs.vertical_unit});
  } else if (is_table) {
    write_csv(options.answer, form, context.json, csv_of(results, levels));
  }
  if (context.json) {
    print_answer(results, levels, options, terrain, other ? &*other : nullptr, crs,
                 asked.transformed);
  } else if (!is_table) {
    print_text(result, options, crs);
  }
  return kExitDone;
}

}  // namespace

Action declare_volume(CLI::App& app, Context& context) {
  const auto options = std::make_shared<VolumeOptions>();
  add_terrain_options(app, options->terrain, false);
  add_level_options(app, options->terrain.measures, options->levels,
                    "Heights, in the height's unit; of several the answer is a table",
                    "Every multiple of D, from the base");
  app.add_option("--against", options->against,
                 "A second .ptin file, on any grid, in the same CRS; cut is where FILE is above it")
      ->type_name("OTHER")
      ->excludes(app.get_option("--level"))
      ->excludes(app.get_option("--interval"));
  add_region_options(app, options->region, RegionKinds::kWithInside);
  add_detail_options(app, options->terrain.measures, options->detail,
                     ", of either file; volumes come with intervals",
                     "Measure the TINs of the N most important vertices; volumes come with "
                     "intervals");
  add_memory_option(app, options->memory);
  add_answer_options(app, options->answer, kAnswerKinds);
  app.add_option(
         "--threads", options->threads,
         "Threads (default: one a processor that affinity and cgroups leave this process);\n"
         "the answer is the same for any number")
      ->type_name("N")
      ->check(CLI::Range(1, 1024));
  return [options, &context] { return run_volume(*options, context); };
}

}  // namespace ptin::tools
