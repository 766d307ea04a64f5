// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/ptin/query_options.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <utility>

#include <nlohmann/json.hpp>

#include "engine/construct/process_limits.h"
#include "engine/error.h"
#include "engine/query/questions.h"
#include "engine/remote/remote_file.h"
#include "storage/file/sigbus_guard.h"
#include "storage/spatialindex_rtree.h"
#include "tools/facts/human.h"
#include "tools/facts/numbers.h"
#include "tools/facts/quantity.h"
#include "tools/output/standard_output.h"
#include "tools/ptin/source_counts.h"
#include "tools/region/on_terrain.h"
#include "tools/region/region_input.h"

namespace ptin::tools {

void add_terrain_options(CLI::App& app, TerrainOptions& options, bool has_index) {
  app.add_option("FILE", options.file,
                 "The .ptin file, or its URL: https, http, s3, gs, az (tools/API.md, \"Files "
                 "elsewhere\")")
      ->required();
  app.add_flag("--no-mmap", options.no_mmap,
               "Read with pread instead of mapping the file (network file systems)");
  app.add_option("--remote-cache", options.remote_cache,
                 "Of a URL: memory for the parts of the file that were read, as 64M (the default)")
      ->type_name("SIZE");
  app.add_option("--cache-folder", options.cache_folder,
                 "Of a URL: a folder in which what was read is kept for the next time too")
      ->type_name("DIR");
  if (!has_index) return;
  app.add_option("--index", options.index, "Which index finds the pages; the answer is the same")
      ->check(CLI::IsMember({"packed", "spatialindex"}))
      ->capture_default_str();
  app.add_option("--tmp", options.temporary_folder,
                 "Folder for temporary files of --index spatialindex (default: beside FILE)")
      ->type_name("DIR");
}

namespace {

std::shared_ptr<const StoreFile> settled(std::shared_ptr<const StoreFile> store,
                                         const Measures& measures) {
  if (measures.wait()) measures.settle(crs_facts(*store));
  return store;
}

}  // namespace

std::shared_ptr<const StoreFile> open_store(const TerrainOptions& options, const Context& context) {
  if (is_remote(options.file)) {
    RemoteOptions remote;
    remote.caches.folder = options.cache_folder;
    if (!options.remote_cache.empty()) {
      remote.caches.memory_bytes = parse_memory(options.remote_cache, "--remote-cache");
    }
    remote.stop = context.stop;
    return settled(open_remote_store(options.file, remote), options.measures);
  }
  if (!options.no_mmap) install_sigbus_guard();
  return settled(
      StoreFile::open(options.file, options.no_mmap ? PageAccess::kPread : PageAccess::kMapped),
      options.measures);
}

Terrain open_terrain(const TerrainOptions& options, const Context& context) {
  const auto store = open_store(options, context);
  Terrain terrain(store);
  if (options.index == "spatialindex") {
    if (is_remote(options.file) && options.temporary_folder.empty()) {
      refuse("--index spatialindex of a file that lies elsewhere needs --tmp", options.file);
    }
    SpatialIndexOptions index;
    index.temporary_folder = options.temporary_folder;
    terrain.use_index(SpatialIndexRTree::open(store, index));
  }
  return terrain;
}

namespace {

void check_finite(const std::vector<double>& numbers, const std::string& option) {
  for (const double n : numbers) {
    if (std::isfinite(n)) continue;
    throw Error(ErrorCode::invalid_argument, "a region's coordinates must be finite numbers",
                option);
  }
}

}  // namespace

void add_region_options(CLI::App& app, RegionOptions& options, RegionKinds kinds) {
  auto* window =
      app.add_option("--window", options.window, "A window in map units: xmin ymin xmax ymax")
          ->expected(4)
          ->type_name("XMIN YMIN XMAX YMAX");
  if (kinds == RegionKinds::kWindow) return;
  auto* polygon =
      app.add_option("--polygon", options.polygon, "A polygon: WKT, or a file that holds it")
          ->type_name("WKT_OR_FILE")
          ->excludes(window);
  if (kinds == RegionKinds::kWithInside) return;
  app.add_option("--point", options.point, "A point in map units")
      ->expected(2)
      ->type_name("X Y")
      ->excludes(window)
      ->excludes(polygon);
}

AskedRegion region_of(const RegionOptions& options, const StoreFacts& facts, const CrsFacts& crs) {
  AskedRegion asked;
  std::optional<Region>& region = asked.region;
  const char* option = "--window";
  if (!options.window.empty()) {
    region = window_of(options.window, option);
  } else if (!options.polygon.empty()) {
    option = "--polygon";
    AskedPolygon polygon = read_polygon(options.polygon, plane_of(facts, crs));
    region = std::move(polygon.polygon);
    asked.transformed = std::move(polygon.transformed);
  } else if (!options.point.empty()) {
    option = "--point";
    check_finite(options.point, option);
    region = MapPoint{options.point[0], options.point[1]};
  }
  if (region) check_on_terrain(*region, facts, option);
  return asked;
}

nlohmann::json transformed_json(const std::optional<Transformed>& transformed) {
  if (!transformed) return nullptr;
  return {{"from", transformed->from}, {"bent_at_most", transformed->bent_at_most}};
}

void tell_transformed(const std::optional<Transformed>& transformed, const std::string& what,
                      const CrsFacts& crs, const Context& context) {
  if (!transformed || context.quiet || context.json) return;
  const std::string unit = crs.horizontal_unit == "unknown" ? "map unit" : crs.horizontal_unit;
  std::fprintf(
      stderr,
      "%s, straight in %s, went into the terrain's CRS with sides that are off by %s %s at "
      "most\n",
      what.c_str(), printable(transformed->from).c_str(),
      short_number(transformed->bent_at_most).c_str(), unit.c_str());
}

void warn_of_outside(std::span<const MapPoint> places, const std::string& what,
                     const StoreFacts& facts, const CrsFacts& crs, const Context& context) {
  if (context.quiet || context.json) return;
  const std::optional<std::string> why = why_all_miss(places, facts, crs);
  if (!why) return;
  std::fprintf(stderr, "ptin: warning: no %s lies on the terrain, which has %s\n", what.c_str(),
               why->c_str());
}

namespace {

/// The coefficient of curvature for a radius of the Earth that is so many times as long: "4/3",
/// "1.333".
/// @throws Error invalid_argument  no number above 0, nor two with a stroke between them
double coefficient_of_factor(const std::string& text) {
  const std::size_t stroke = text.find('/');
  const auto number_of = [](const std::string& part) {
    const std::optional<Quantity> q = quantity_of(part);
    return q && q->unit.empty() ? q->number : -1.0;
  };
  const double over = number_of(text.substr(0, stroke));
  const double under = stroke == std::string::npos ? 1.0 : number_of(text.substr(stroke + 1));
  const double coefficient = under / over;
  if (over > 0 && under > 0 && std::isfinite(coefficient)) return coefficient;
  refuse("\"" + text + "\" is no factor of the Earth's radius; expected a number above 0, as 4/3",
         "--refraction");
}

}  // namespace

void add_curvature_option(CLI::App& app, double& coefficient) {
  const auto is_at_most_one = [](const std::string& text) {
    const std::optional<double> number = given_number(text);
    if (!number || !(*number > 1)) return std::string();
    return "must be from 0 (a flat Earth) to 1 (no refraction); " + text +
           " is none. An Earth of so many times its radius is --refraction " + text;
  };
  auto* curvature =
      app.add_option("--curvature", coefficient,
                     "The Earth's curvature less refraction: GDAL's coefficient; 0 is a flat "
                     "Earth, 1 one without refraction, 0.75 the 4/3 Earth of radio")
          ->check(numbers(NumberRange::kNotNegative, "from 0 (a flat Earth) to 1 (no refraction)"))
          ->check(CLI::Validator(is_at_most_one, ""))
          ->type_name("C")
          ->capture_default_str();
  app.add_option_function<std::string>(
         "--refraction",
         [&coefficient](const std::string& text) { coefficient = coefficient_of_factor(text); },
         "Instead: how many times as long the Earth's radius is taken for refraction, as 4/3, "
         "which is usual for radio links (--curvature 0.75)")
      ->type_name("K")
      ->excludes(curvature);
}

CLI::Option* add_error_option(CLI::App& app, Measures& measures, std::optional<double>& error,
                              const std::string& help) {
  return measures.add(app, "--error", error, MeasureKind::kHeight, NumberRange::kTolerance, help)
      ->type_name("E");
}

void add_detail_options(CLI::App& app, Measures& measures, DetailOptions& options,
                        const std::string& error_help, const std::string& vertices_help) {
  auto* error =
      add_error_option(app, measures, options.error,
                       "Certified error allowed, in the height's unit, or as 50cm" + error_help);
  app.add_option("--vertices", options.vertices, vertices_help)
      ->type_name("N")
      ->check(counts())
      ->excludes(error);
}

void warn_of_terrain(const StoreFile& store, const std::optional<double>& error,
                     const Context& context) {
  if (context.quiet || context.json) return;
  if (!has_surface(store)) {
    std::fprintf(stderr,
                 "ptin: warning: %s has no surface, all of it is void: no triangle of its source "
                 "has heights at its corners; look at the source, and at --nodata, --max-edge and "
                 "--boundary of ptin build\n",
                 store.path().c_str());
  }
  const double base = store.facts().base_error;
  if (!error || *error >= base) return;
  std::fprintf(stderr,
               "ptin: warning: %s certifies no error below %s (built with --max-error, or heights "
               "were rounded); the answer is within that, not within %s\n",
               store.path().c_str(), short_number(base).c_str(), short_number(*error).c_str());
}

void add_level_options(CLI::App& app, Measures& measures, LevelOptions& options,
                       const std::string& level_help, const std::string& interval_help) {
  constexpr MeasureKind kHeight = MeasureKind::kHeight;
  auto* level =
      measures.add(app, "--level,--fl", options.levels, kHeight, NumberRange::kFinite, level_help)
          ->type_name("H...");
  auto* interval = measures
                       .add(app, "-i,--interval", options.interval, kHeight, NumberRange::kPositive,
                            interval_help)
                       ->type_name("D")
                       ->excludes(level);
  measures
      .add(app, "--base,--off", options.base, kHeight, NumberRange::kFinite,
           "Where the intervals are counted from (default 0)")
      ->type_name("B")
      ->needs(interval);
}

std::vector<double> levels_of(const LevelOptions& options, const StoreFacts& facts) {
  if (!options.interval) return options.levels;
  if (facts.min_height > facts.max_height) return {options.base};
  std::vector<double> levels =
      levels_at(*options.interval, options.base, facts.min_height, facts.max_height);
  // The answer is empty then, as it is with a --level that nothing crosses.
  if (levels.empty()) {
    const double steps = std::ceil((facts.max_height - options.base) / *options.interval);
    levels.push_back(options.base + steps * *options.interval);
  }
  return levels;
}

void add_memory_option(CLI::App& app, std::string& memory) {
  app.add_option("--memory", memory, "Memory that the answer may take, as 512M or 2G (default 4G)")
      ->type_name("SIZE");
}

void add_by_option(CLI::App& app, AnswerBy& by) {
  app.add_option_function<std::string>(
         "--by",
         [&by](const std::string& name) {
           by = name == "splits" ? AnswerBy::kSplits : AnswerBy::kStars;
         },
         "stars: look up the triangles that live at the level; splits: refine T0, as the paper has "
         "it. An exact answer is the same, at a level both are true (default stars)")
      ->transform(CLI::IsMember({"stars", "splits"}, CLI::ignore_case))
      ->type_name("TEXT");
}

DetailRequest detail_of(const DetailOptions& options) { return {options.error, options.vertices}; }

QueryLimits limits_of(const std::string& memory, const Context& context) {
  return {memory_limit_of(memory), context.stop};
}

std::uint64_t memory_limit_of(const std::string& memory, std::uint64_t otherwise) {
  if (!memory.empty()) return parse_memory(memory, "--memory");
  return std::min(otherwise, allowed_memory() / 4 * 3);  // as builds do by themselves
}

nlohmann::json cost_json(const QueryCost& cost) {
  return {{"records_retrieved", cost.records_retrieved},
          {"records_examined", cost.records_examined},
          {"records_applied", cost.records_applied},
          {"stars_read", cost.stars_read},
          {"index_nodes", cost.io.index_nodes},
          {"pages", cost.io.pages},
          {"bytes_read", cost.io.bytes_read},
          {"remote_rounds", cost.io.remote_rounds},
          {"remote_requests", cost.io.remote_requests},
          {"remote_bytes", cost.io.remote_bytes},
          {"seconds", cost.seconds}};
}

void print_json(const nlohmann::json& json) {
  write_to_stdout(json.dump(2, ' ', false, nlohmann::json::error_handler_t::replace) + "\n");
}

}  // namespace ptin::tools
