// SPDX-License-Identifier: GPL-3.0-or-later
//
// ptin isoline: isolines as a vector layer, by gdal_contour's conventions.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>
#include <optional>

#include <nlohmann/json.hpp>

#include "engine/crs/crs_facts.h"
#include "engine/mesh/link.h"
#include "engine/query/questions.h"
#include "storage/file/file_questions.h"
#include "tools/ask/questions.h"
#include "tools/error_status.h"
#include "tools/facts/answers.h"
#include "tools/facts/human.h"
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
  ask::IsolineQuestion question;
  AnswerBy by = AnswerBy::kBest;
  bool z = false;
  bool polygons = false;
  int threads = 0;
  std::optional<std::uint64_t> memory;
  OutputOptions out;
};

/// The terrain, and what was done to the polygon.
struct AskedTerrain {
  const Terrain& terrain;
  const CrsFacts& crs;
  std::optional<Transformed> transformed;
};

void check_options(const IsolineOptions& options, const Context& context) {
  if (!options.question.levels.given()) {
    throw Error(ErrorCode::invalid_argument,
                "the levels are given by --level H... or by --interval D; give one of them");
  }
  static_cast<void>(isoline_format_of(options.out.output));
  if (options.polygons) check_isoline_fields(options.out.output, "--polygons");
  check_file_or_stdout(options.out, "the isolines", context.json);
}

std::string folder_for_temporaries(const IsolineOptions& options) {
  if (!options.terrain.temporary_folder.empty()) return options.terrain.temporary_folder;
  if (options.out.output != "-") return folder_of(options.out.output);
  return system_temporary_folder();
}

void report(const IsolineOptions& options, const Isolines& lines,
            const IsolineLayer::Written& written, const AskedTerrain& asked,
            const Context& context) {
  if (context.json) {
    print_answer({{"output", options.out.output}}, ask::isoline_fields(),
                 {&lines, written.lines, written.rings, written.points},
                 ask::facts_of(lines, asked.terrain.store(), asked.crs, &asked.transformed));
  } else if (!context.quiet && options.out.output != "-") {
    std::printf("%s: %s (%s closed) at %s, %s; certified %s%s\n", options.out.output.c_str(),
                counted(written.lines, "isoline").c_str(), grouped(written.rings).c_str(),
                counted(lines.levels().size(), "level").c_str(),
                counted(written.points, "point").c_str(),
                short_number(lines.certified_error).c_str(), lines.exact ? "; exact" : "");
  }
}

int run_lines(const IsolineOptions& options, const IsolineRequest& request,
              const AskedTerrain& asked, const Context& context) {
  const Isolines lines = asked.terrain.isolines(request, options.by);
  const IndexLevels index{options.question.levels.interval.value_or(0.0),
                          options.question.levels.base};
  warn_of_unnamed_crs(options.out, asked.crs, context);
  IsolineLayer layer({options.out.output, options.out.overwrite, options.z, false, asked.crs, index,
                      context.stop});
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

void add_polygon(const BandPolygon& polygon, Geometry& all) {
  for (const std::vector<MapPoint>& ring : polygon.rings) {
    all.points.insert(all.points.end(), ring.begin(), ring.end());
    all.end_path();
  }
  all.polygons.push_back(all.paths.size());
}

/// Writes one feature for each band that has an area, as gdal_contour -p does.
std::uint64_t write_bands(const std::vector<BandPolygon>& polygons, const LevelSet& levels,
                          const StoreFacts& facts, const IsolineOptions& options,
                          const CrsFacts& crs) {
  const auto fields = ask::band_row_fields();
  VectorFile file(options.out.output, options.out.overwrite,
                  {"contour", GeometryKind::kMultiPolygon, ask::layer_fields_of(fields), crs});
  std::uint64_t features = 0;
  for (std::size_t i = 0; i < polygons.size();) {
    const std::uint32_t band = polygons[i].band;
    Geometry parts;
    for (; i < polygons.size() && polygons[i].band == band; ++i) add_polygon(polygons[i], parts);
    const double low = band == 0 ? facts.min_height : levels.height(band - 1);
    const double high = band == levels.size() ? facts.max_height : levels.height(band);
    file.add(parts, ask::layer_values_of(fields.values_of({features, low, false, nullptr, high})));
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
  warn_of_unnamed_crs(options.out, asked.crs, context);
  const std::uint64_t features = write_bands(polygons, levels, facts, options, asked.crs);
  if (context.json) {
    print_answer({{"output", options.out.output}}, ask::band_fields(),
                 {levels.heights(), features, polygons.size()},
                 ask::facts_of(refined, terrain.store(), asked.crs, &asked.transformed));
  } else if (!context.quiet && options.out.output != "-") {
    std::printf("%s: %s of %s\n", options.out.output.c_str(), counted(features, "band").c_str(),
                counted(polygons.size(), "polygon").c_str());
  }
  return kExitDone;
}

int run_isoline(const IsolineOptions& options, const Context& context) {
  check_options(options, context);
  const Terrain terrain =
      open_terrain(options.terrain, options.question.request.detail.tolerance, context);
  const CrsFacts crs = crs_facts(terrain.store());
  IsolineRequest request = options.question.request;
  request.levels = ask::levels_of(options.question.levels, terrain.store().facts());
  const AskedRegion region =
      region_of(options.question.region, terrain.store().facts(), crs, context);
  request.region = region.region;
  request.limits.memory_bytes = memory_limit_of(options.memory, request.limits.memory_bytes);
  request.temporary_folder = folder_for_temporaries(options);
  request.threads = thread_count(options.threads);
  request.limits.stop = context.stop;
  request.counts_vertices = context.json;
  const AskedTerrain asked{terrain, crs, region.transformed};
  return options.polygons ? run_polygons(options, request, asked, context)
                          : run_lines(options, request, asked, context);
}

void add_question(ask::Parameters& rows, IsolineOptions& options) {
  add_terrain(rows, options.terrain, true,
              "Folder for temporary files: lines that do not fit in --memory (default: OUT's "
              "folder), --index spatialindex (default: beside FILE)");
  ask::add_question(rows, options.question);
  ask::add_by(rows, options.by);
  rows.add("3d", &options.z, "", "Points carry the height of their line");
  rows.add("polygons", &options.polygons, "",
           "Polygons between the levels, with elev_min and elev_max, instead of lines")
      .spelled("-p,--polygons")
      .excluding("3d by");
  add_output(rows, options.out,
             "The layer to write; its extension chooses the format: " + known_isoline_extensions() +
                 "; - is GeoJSON on stdout");
  ask::add_memory(
      rows, options.memory,
      "Memory for the extraction, as 512M or 2G (default 4G); what does not fit goes to --tmp");
  ask::add_threads(rows, options.threads,
                   "Threads (default: one a processor that affinity and cgroups leave this "
                   "process); the lines are the same for any number");
}

}  // namespace

Declared declare_isoline(Context& context) {
  return declared<IsolineOptions>(context, run_isoline);
}

}  // namespace ptin::tools
