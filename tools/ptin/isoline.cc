// SPDX-License-Identifier: GPL-3.0-or-later
//
// ptin isoline: isolines as a vector layer, by gdal_contour's conventions.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>
#include <optional>

#include <nlohmann/json.hpp>
#include <ogr_geometry.h>

#include "engine/crs/crs_facts.h"
#include "engine/mesh/link.h"
#include "engine/query/questions.h"
#include "storage/file/file_questions.h"
#include "tools/error_status.h"
#include "tools/facts/answers.h"
#include "tools/facts/human.h"
#include "tools/facts/numbers.h"
#include "tools/formats/vector_file.h"
#include "tools/output/output_file.h"
#include "tools/ptin/isoline_layer.h"
#include "tools/ptin/query_options.h"
#include "tools/region/cut.h"
#include "tools/region/tin_mesh.h"
#include "tools/thread_count.h"

namespace ptin::tools {

namespace {

struct IsolineOptions {
  TerrainOptions terrain;
  RegionOptions region;
  LevelOptions levels;
  DetailOptions detail;
  bool z = false;
  bool polygons = false;
  std::uint64_t max_lines = IsolineRequest{}.most_lines;
  int threads = 0;
  AnswerBy by = AnswerBy::kStars;
  std::string memory, output;
  bool overwrite = false;
};

/// The terrain, and what was done to the polygon.
struct AskedTerrain {
  const Terrain& terrain;
  const CrsFacts& crs;
  std::optional<Transformed> transformed;
};

void check_options(const IsolineOptions& options, const Context& context) {
  if (!options.levels.given()) {
    throw Error(ErrorCode::invalid_argument,
                "the levels are given by --level H... or by --interval D; give one of them");
  }
  static_cast<void>(isoline_format_of(options.output));
  if (options.polygons) check_isoline_fields(options.output, "--polygons");
  if (options.output != "-") {
    check_output(options.output, options.overwrite);
  } else if (context.json) {
    throw Error(ErrorCode::invalid_argument,
                "--json and -o - both write to stdout; give the isolines a file name");
  }
}

std::string folder_for_temporaries(const IsolineOptions& options) {
  if (!options.terrain.temporary_folder.empty()) return options.terrain.temporary_folder;
  if (options.output != "-") return folder_of(options.output);
  return system_temporary_folder();
}

void report(const IsolineOptions& options, const Isolines& lines,
            const IsolineLayer::Written& written, const AskedTerrain& asked,
            const Context& context) {
  const StoreFile& store = asked.terrain.store();
  if (context.json) {
    print_json({{"output", options.output},
                {"levels", lines.levels()},
                {"lines", written.lines},
                {"rings", written.rings},
                {"points", written.points},
                {"crossed",
                 {{"triangles", lines.crossed.triangles},
                  {"vertices", lines.crossed.vertices},
                  {"segments", lines.crossed.segments}}},
                {"tiles", lines.tiles},
                {"certified_error", lines.certified_error},
                {"certified_deviation", lines.certified_deviation},
                {"border_moved_at_most", border_move_json(store, lines.certified_error)},
                {"exact", lines.exact},
                {"transformed", transformed_json(asked.transformed)},
                {"units", units_json(asked.crs)},
                {"cost", cost_json(lines.cost)}});
  } else if (!context.quiet && options.output != "-") {
    std::printf("%s: %s (%s closed) at %s, %s; certified %s%s\n", options.output.c_str(),
                counted(written.lines, "isoline").c_str(), grouped(written.rings).c_str(),
                counted(lines.levels().size(), "level").c_str(),
                counted(written.points, "point").c_str(),
                short_number(lines.certified_error).c_str(), lines.exact ? "; exact" : "");
  }
}

int run_lines(const IsolineOptions& options, const IsolineRequest& request,
              const AskedTerrain& asked, const Context& context) {
  const Isolines lines = asked.terrain.isolines(request, options.by);
  const IndexLevels index{options.levels.interval.value_or(0.0), options.levels.base};
  IsolineLayer layer(
      {options.output, options.overwrite, options.z, false, asked.crs, index, context.stop});
  const IsolineLayer::Written written = layer.add(lines);
  layer.publish();
  if (written.lines == 0 && !context.quiet) {
    std::fprintf(stderr, "ptin: warning: no surface crosses these levels; the layer is empty\n");
  }
  report(options, lines, written, asked, context);
  return kExitDone;
}

/// True when the terrain is a full grid of samples without a void. Its border is straight then, so
/// its triangles away from the levels may stay coarse. Otherwise bands need the borders of voids
/// everywhere, and the index does not know those.
bool has_straight_border(const StoreFile& store) {
  const GridBox& b = store.facts().bounds;
  const std::uint64_t full = (static_cast<std::uint64_t>(b.max_x - b.min_x) + 1) *
                             (static_cast<std::uint64_t>(b.max_y - b.min_y) + 1);
  return store.facts().free_of_voids && store.facts().source_samples == full &&
         store.t0().vertices.size() + store.record_count() == full;
}

/// The part of the TIN that the bands of a request need.
RefinedTin refine_for_bands(const IsolineRequest& request, const LevelSet& levels,
                            const Terrain& terrain) {
  QueryLimits limits = request.limits;
  limits.memory_bytes /= 2;
  if (has_straight_border(terrain.store()) && !request.detail.vertices) {
    const PredicatePtr crossing = levels.crossing();
    RefineRequest refine;
    refine.region = request.region;
    refine.detail = request.detail;
    refine.also = crossing.get();
    refine.limits = limits;
    return terrain.refine(refine);
  }
  PartRequest part;
  part.region = request.region;
  part.detail = request.detail;
  part.limits = limits;
  TinParts parts = terrain.parts(part);
  Tin* tin = parts.part(terrain.store().facts().bounds);
  if (tin == nullptr) {
    throw Error(
        ErrorCode::resource_exhausted,
        "the TIN of the bands takes more than half of the memory: give more --memory, or ask "
        "for a window or a larger error",
        terrain.store().path());
  }
  link_tin(*tin);
  RefinedTin result;
  result.tin = std::move(*tin);
  result.certified_error = parts.detail().certificate().error;
  result.certified_deviation = parts.detail().certificate().deviation;
  result.exact = parts.detail().is_exact(terrain.store().facts());
  result.cost = parts.cost();
  return result;
}

std::unique_ptr<OGRGeometry> polygon_geometry(const BandPolygon& polygon) {
  auto geometry = std::make_unique<OGRPolygon>();
  for (const std::vector<MapPoint>& points : polygon.rings) {
    auto ring = std::make_unique<OGRLinearRing>();
    ring->setNumPoints(static_cast<int>(points.size()), FALSE);
    for (int i = 0; i < static_cast<int>(points.size()); ++i) {
      ring->setPoint(i, points[static_cast<std::size_t>(i)].x,
                     points[static_cast<std::size_t>(i)].y);
    }
    geometry->addRingDirectly(ring.release());
  }
  return geometry;
}

/// Writes one feature for each band that has an area, as gdal_contour -p does.
std::uint64_t write_bands(const std::vector<BandPolygon>& polygons, const LevelSet& levels,
                          const StoreFacts& facts, const IsolineOptions& options,
                          const std::string& wkt) {
  VectorFile file(options.output, options.overwrite,
                  {"contour",
                   wkbMultiPolygon,
                   {{"ID", VectorFile::FieldType::kInteger},
                    {"elev_min", VectorFile::FieldType::kReal},
                    {"elev_max", VectorFile::FieldType::kReal}},
                   wkt});
  std::uint64_t features = 0;
  for (std::size_t i = 0; i < polygons.size();) {
    const std::uint32_t band = polygons[i].band;
    auto parts = std::make_unique<OGRMultiPolygon>();
    for (; i < polygons.size() && polygons[i].band == band; ++i) {
      parts->addGeometryDirectly(polygon_geometry(polygons[i]).release());
    }
    const double low = band == 0 ? facts.min_height : levels.height(band - 1);
    const double high = band == levels.size() ? facts.max_height : levels.height(band);
    const VectorFile::Value values[] = {static_cast<std::int64_t>(features), low, high};
    file.add(std::move(parts), values);
    ++features;
  }
  file.publish();
  return features;
}

int run_polygons(const IsolineOptions& options, const IsolineRequest& request,
                 const AskedTerrain& asked, const Context& context) {
  const Terrain& terrain = asked.terrain;
  const StoreFacts& facts = terrain.store().facts();
  const LevelSet levels(request.levels, facts.heights);
  RefinedTin refined = refine_for_bands(request, levels, terrain);
  const Mesh mesh = request.region ? cut_to_region(refined, facts, *request.region)
                                   : surface_mesh(refined, facts);
  refined.tin = {};
  std::vector<double> heights;  // Decoded as those of vertices are.
  for (std::size_t i = 0; i < levels.size(); ++i) {
    heights.push_back(facts.heights.height_of_code(levels.code(i)));
  }
  // The refined mesh is freed by now: the limit counts its cut copy and the polygons.
  const QueryContext query(request.limits, terrain.store().path());
  const std::vector<BandPolygon> polygons =
      band_polygons({mesh.vertices, mesh.triangles}, heights, query);
  if (polygons.size() > request.most_lines) {
    throw Error(ErrorCode::resource_exhausted,
                "there are " + std::to_string(polygons.size()) +
                    " polygons, more than the limit of " + std::to_string(request.most_lines) +
                    ": ask for fewer levels or a larger error, or raise --max-lines",
                options.terrain.file);
  }
  const std::uint64_t features = write_bands(polygons, levels, facts, options, asked.crs.wkt);
  if (context.json) {
    print_json(
        {{"output", options.output},
         {"levels", levels.heights()},
         {"features", features},
         {"polygons", polygons.size()},
         {"certified_error", refined.certified_error},
         {"certified_deviation", refined.certified_deviation},
         {"border_moved_at_most", border_move_json(terrain.store(), refined.certified_error)},
         {"exact", refined.exact},
         {"transformed", transformed_json(asked.transformed)},
         {"units", units_json(asked.crs)},
         {"cost", cost_json(refined.cost)}});
  } else if (!context.quiet && options.output != "-") {
    std::printf("%s: %s of %s\n", options.output.c_str(), counted(features, "band").c_str(),
                counted(polygons.size(), "polygon").c_str());
  }
  return kExitDone;
}

int run_isoline(const IsolineOptions& options, const Context& context) {
  check_options(options, context);
  const Terrain terrain = open_terrain(options.terrain, context);
  warn_of_terrain(terrain.store(), options.detail.error, context);
  const CrsFacts crs = crs_facts(terrain.store());
  IsolineRequest request;
  request.levels = levels_of(options.levels, terrain.store().facts());
  const AskedRegion region = region_of(options.region, terrain.store().facts(), crs);
  tell_transformed(region.transformed, "the polygon", crs, context);
  request.region = region.region;
  request.detail = detail_of(options.detail);
  request.most_lines = options.max_lines;
  request.limits.memory_bytes = memory_limit_of(options.memory, request.limits.memory_bytes);
  request.temporary_folder = folder_for_temporaries(options);
  request.threads = thread_count(options.threads);
  request.limits.stop = context.stop;
  request.counts_vertices = context.json;
  const AskedTerrain asked{terrain, crs, region.transformed};
  return options.polygons ? run_polygons(options, request, asked, context)
                          : run_lines(options, request, asked, context);
}

}  // namespace

Action declare_isoline(CLI::App& app, Context& context) {
  const auto options = std::make_shared<IsolineOptions>();
  add_terrain_options(app, options->terrain, true);
  app.get_option("--tmp")->description(
      "Folder for temporary files: lines that do not fit in --memory (default: OUT's folder), "
      "--index spatialindex (default: beside FILE)");
  add_level_options(app, options->terrain.measures, options->levels,
                    "Heights, in the height's unit", "Every multiple of D, from the base");
  add_region_options(app, options->region, RegionKinds::kWithInside);
  add_detail_options(app, options->terrain.measures, options->detail, "",
                     "The isolines of the TIN of the terrain's N most important vertices");
  auto* z = app.add_flag("--3d", options->z, "Points carry the height of their line");
  app.add_flag("-p,--polygons", options->polygons,
               "Polygons between the levels, with elev_min and elev_max, instead of lines")
      ->excludes(z);
  app.add_option("-o,--output", options->output,
                 "The layer to write; its extension chooses the format: " +
                     known_isoline_extensions() + "; - is GeoJSON on stdout")
      ->type_name("OUT")
      ->required();
  add_by_option(app, options->by);
  app.add_option("--max-lines", options->max_lines,
                 "Refuse, before anything is written, when there are more lines, or polygons")
      ->type_name("N")
      ->check(counts())
      ->capture_default_str();
  app.add_option("--memory", options->memory,
                 "Memory for the extraction, as 512M or 2G (default 4G); what does not fit goes to "
                 "--tmp")
      ->type_name("SIZE");
  app.add_option(
         "--threads", options->threads,
         "Threads (default: one a processor that affinity and cgroups leave this process);\n"
         "the lines are the same for any number")
      ->type_name("N")
      ->check(CLI::Range(1, 1024));
  app.add_flag("--overwrite", options->overwrite, "Replace an existing output");
  return [options, &context] { return run_isoline(*options, context); };
}

}  // namespace ptin::tools
