// SPDX-License-Identifier: GPL-3.0-or-later
//
// ptin volume: cut and fill against a level or another terrain.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>
#include <optional>
#include <string>

#include "engine/crs/crs_facts.h"
#include "engine/crs/ground.h"
#include "engine/error.h"
#include "engine/query/terrain.h"
#include "tools/error_status.h"
#include "tools/facts/answers.h"
#include "tools/facts/human.h"
#include "tools/facts/numbers.h"
#include "tools/ptin/query_options.h"
#include "tools/ptin/source_counts.h"
#include "tools/thread_count.h"

namespace ptin::tools {

namespace {

struct VolumeOptions {
  TerrainOptions terrain;
  std::optional<double> level;
  std::string against;
  RegionOptions region;
  DetailOptions detail;
  int threads = 0;
  std::string memory;
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
  request.level = options.level.value_or(0.0);
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

void print_answer(const VolumeResult& result, const VolumeOptions& options, const Terrain& terrain,
                  const Terrain* other, const CrsFacts& crs,
                  const std::optional<Transformed>& transformed) {
  nlohmann::json units = units_json(crs);
  units["ground"] = unit_of_ground(crs);
  nlohmann::json answer = {
      {"level", options.level ? nlohmann::json(*options.level) : nlohmann::json()},
      {"cut", interval_json(result.cut)},
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
        {"only_against", result.only_other_area}}},
      {"against", nullptr},
      {"certified_error", result.certificate.error},
      {"certified_deviation", result.certificate.deviation},
      {"border_moved_at_most", border_move_json(terrain.store(), result.certificate.error)},
      {"exact", result.exact},
      {"transformed", transformed_json(transformed)},
      {"units", units},
      {"cost", cost_json(result.cost)}};
  if (other != nullptr) {
    const Certificate& c = result.other_certificate;
    answer["against"] = {{"file", options.against},
                         {"certified_error", c.error},
                         {"certified_deviation", c.deviation},
                         {"border_moved_at_most", border_move_json(other->store(), c.error)}};
  }
  print_json(answer);
}

void print_text(const VolumeResult& result, const VolumeOptions& options, const CrsFacts& crs) {
  const std::string unit = unit_of_ground(crs);
  const std::string known = plural_of(unit == "unknown" ? "unit" : unit);
  const std::string than = options.against.empty() ? "the level" : options.against;
  const std::string& here = options.terrain.file;
  const auto volume = [&](const char* name, const CertifiedVolume& v, const std::string& where) {
    std::printf("%-5s %s cubic %s", name, grouped_number(v.value).c_str(), known.c_str());
    if (!result.exact) {
      std::printf(", the source's between %s and %s", grouped_number(v.low).c_str(),
                  grouped_number(v.high).c_str());
    }
    std::printf("%s\n", where.c_str());
  };
  volume("cut", result.cut, ": " + here + " is above " + than + ", material to take away");
  volume("fill", result.fill, ": " + here + " is below " + than + ", material to bring");
  volume("net", result.net, ": cut less fill");
  std::printf("area  %s square %s: cut %s, fill %s; void %s\n",
              grouped_number(result.surface_area).c_str(), known.c_str(),
              grouped_number(result.cut_area).c_str(), grouped_number(result.fill_area).c_str(),
              grouped_number(result.void_area).c_str());
  if (!options.against.empty()) {
    std::printf("      surface in %s alone %s, in %s alone %s\n", options.terrain.file.c_str(),
                grouped_number(result.only_here_area).c_str(), options.against.c_str(),
                grouped_number(result.only_other_area).c_str());
  }
  if (std::isfinite(result.mean_difference)) {
    std::printf("mean  %s %s\n", grouped_number(result.mean_difference).c_str(), known.c_str());
  }
}

int run_volume(const VolumeOptions& options, const Context& context) {
  if (options.level.has_value() != options.against.empty()) {
    throw Error(ErrorCode::invalid_argument,
                "a volume is measured against --level H or --against OTHER; give one of them");
  }
  check_detail(options.detail);
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
  const VolumeResult result = terrain.volume(request);
  if (result.surface_area == 0 && has_surface(terrain.store())) {
    warn("no surface lies in the region" +
             (other ? ", or none of both terrains at one place" : std::string()) +
             ": all volumes are 0; ask for another --window or --polygon",
         context);
  }
  if (context.json) {
    print_answer(result, options, terrain, other ? &*other : nullptr, crs, asked.transformed);
  } else {
    print_text(result, options, crs);
  }
  return kExitDone;
}

}  // namespace

Action declare_volume(CLI::App& app, Context& context) {
  const auto options = std::make_shared<VolumeOptions>();
  add_terrain_options(app, options->terrain, false);
  auto* level = app.add_option("--level", options->level, "A height, in the height's unit");
  level->check(numbers(NumberRange::kFinite, "in the height's unit"))->type_name("H");
  app.add_option("--against", options->against,
                 "A second .ptin file, on any grid, in the same CRS; cut is where FILE is above it")
      ->type_name("OTHER")
      ->excludes(level);
  add_region_options(app, options->region, RegionKinds::kWithInside);
  add_detail_options(app, options->detail, ", of either file; volumes come with intervals",
                     "Measure the TINs of the N most important vertices; volumes come with "
                     "intervals");
  add_memory_option(app, options->memory);
  app.add_option(
         "--threads", options->threads,
         "Threads (default: one a processor that affinity and cgroups leave this process);\n"
         "the answer is the same for any number")
      ->type_name("N")
      ->check(CLI::Range(1, 1024));
  return [options, &context] { return run_volume(*options, context); };
}

}  // namespace ptin::tools
