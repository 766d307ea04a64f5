// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/ptin/query_options.h"

#include <algorithm>
#include <cstdio>
#include <utility>

#include <nlohmann/json.hpp>

#include "engine/construct/process_limits.h"
#include "engine/error.h"
#include "engine/query/questions.h"
#include "engine/remote/remote_file.h"
#include "storage/file/sigbus_guard.h"
#include "tools/facts/human.h"
#include "tools/formats/vector_file.h"
#include "tools/output/output_file.h"
#include "tools/output/standard_output.h"
#include "tools/ptin/source_counts.h"
#include "tools/region/on_terrain.h"
#include "tools/region/region_input.h"
#include "tools/second_index.h"

namespace ptin::tools {

void add_terrain(ask::Parameters& rows, TerrainOptions& options, bool has_index,
                 const std::string& tmp_help) {
  rows.add(
          "file", &options.file, "",
          "The .ptin file, or its URL: https, http, s3, gs, az (tools/API.md, \"Files elsewhere\")")
      .spelled("FILE")
      .required_at(ask::Door::kBoth);
  rows.add("no-mmap", &options.no_mmap, "",
           "Read with pread instead of mapping the file (network file systems)");
  ask::add_memory(rows, options.remote_cache,
                  "Of a URL: memory for the parts of the file that were read, as 64M (the default)")
      .name = "remote-cache";
  rows.add("cache-folder", &options.cache_folder, "DIR",
           "Of a URL: a folder in which what was read is kept for the next time too");
  if (!has_index) return;
  rows.add("index", &options.index, "TEXT", "Which index finds the pages; the answer is the same")
      .of({"packed", "spatialindex"})
      .with_default();
  const std::string of_index =
      "Folder for temporary files of --index spatialindex (default: beside FILE)";
  rows.add("tmp", &options.temporary_folder, "DIR", tmp_help.empty() ? of_index : tmp_help);
}

void add_output(ask::Parameters& rows, OutputOptions& options, std::string help, bool is_required,
                std::string_view metavar) {
  rows.add("output", &options.output, metavar, std::move(help))
      .spelled("-o,--output")
      .required_at(is_required ? ask::Door::kBoth : ask::Door::kNone);
  rows.add("overwrite", &options.overwrite, "", "Replace an existing output");
}

void check_file_or_stdout(const OutputOptions& out, const std::string& what, bool json) {
  if (out.output != "-") return check_output(out.output, out.overwrite);
  if (json) refuse("--json and -o - both write to stdout; give " + what + " a file name");
}

namespace {

std::shared_ptr<const StoreFile> settled(std::shared_ptr<const StoreFile> store,
                                         const Context& context) {
  if (context.reading->waits()) context.reading->settle(crs_facts(*store));
  return store;
}

/// Warns as open_terrain().
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

}  // namespace

std::shared_ptr<const StoreFile> open_store(const TerrainOptions& options, const Context& context) {
  if (is_remote(options.file)) {
    RemoteOptions remote;
    remote.caches.folder = options.cache_folder;
    if (options.remote_cache) remote.caches.memory_bytes = *options.remote_cache;
    remote.stop = context.stop;
    return settled(open_remote_store(options.file, remote), context);
  }
  if (!options.no_mmap) install_sigbus_guard();
  return settled(
      StoreFile::open(options.file, options.no_mmap ? PageAccess::kPread : PageAccess::kMapped),
      context);
}

Terrain open_terrain(const TerrainOptions& options, const std::optional<double>& error,
                     const Context& context) {
  const auto store = open_store(options, context);
  Terrain terrain(store);
  if (options.index == "spatialindex") {
    if (is_remote(options.file) && options.temporary_folder.empty()) {
      refuse("--index spatialindex of a file that lies elsewhere needs --tmp", options.file);
    }
    SpatialIndexOptions index;
    index.temporary_folder = options.temporary_folder;
    terrain.use_index(open_second_index(store, index));
  }
  warn_of_terrain(*store, error, context);
  return terrain;
}

AskedRegion region_of(const ask::RegionText& text, const StoreFacts& facts, const CrsFacts& crs,
                      const Context& context) {
  AskedRegion asked;
  std::optional<Region>& region = asked.region;
  const char* option = "--window";
  if (text.window) {
    region = *text.window;
  } else if (!text.polygon.empty()) {
    option = "--polygon";
    AskedPolygon polygon = read_polygon(text.polygon, plane_of(facts, crs));
    region = std::move(polygon.polygon);
    asked.transformed = std::move(polygon.transformed);
  } else if (!text.point.empty()) {
    option = "--point";
    region = MapPoint{text.point[0], text.point[1]};
  }
  if (region) check_on_terrain(*region, facts, option);
  tell_transformed(asked.transformed, "the polygon", crs, context);
  return asked;
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

void warn_of_unnamed_crs(const OutputOptions& out, const CrsFacts& crs, const Context& context) {
  if (context.quiet || context.json || crs.wkt.empty() || !crs.code.empty()) return;
  if (!is_geojson(out.output)) return;
  std::fprintf(stderr,
               "ptin: warning: %s does not say its CRS, which is %s: GeoJSON names a CRS by its "
               "code, and this one has none; .gpkg and .fgb keep it\n",
               out.output == "-" ? "the GeoJSON" : out.output.c_str(), crs.name.c_str());
}

QueryLimits limits_of(std::optional<std::uint64_t> memory, const Context& context) {
  return {memory_limit_of(memory), context.stop};
}

std::uint64_t memory_limit_of(std::optional<std::uint64_t> memory, std::uint64_t otherwise) {
  return memory.value_or(std::min(otherwise, allowed_memory() / 4 * 3));  // as builds by themselves
}

void print_answer(ask::Json answer, const ask::AnswerFacts& facts) {
  add_told(answer, ask::answer_fields(), facts);
  print_json(answer);
}

void print_json(const nlohmann::json& json) {
  write_to_stdout(json.dump(2, ' ', false, nlohmann::json::error_handler_t::replace) + "\n");
}

}  // namespace ptin::tools
