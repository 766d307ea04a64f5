// SPDX-License-Identifier: GPL-3.0-or-later
//
// ptin viewshed: what one observer sees, as a raster or as points.
#include <algorithm>
#include <array>
#include <cstdio>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <gdal_priv.h>
#include <nlohmann/json.hpp>
#include <ogr_geometry.h>

#include "engine/construct/memory_plan.h"
#include "engine/crs/crs_facts.h"
#include "engine/crs/ground.h"
#include "engine/query/questions.h"
#include "engine/stop.h"
#include "tools/error_status.h"
#include "tools/facts/answers.h"
#include "tools/facts/human.h"
#include "tools/facts/numbers.h"
#include "tools/formats/geotiff_crs.h"
#include "tools/formats/vector_file.h"
#include "tools/output/file_name.h"
#include "tools/output/gdal_output.h"
#include "tools/output/output_file.h"
#include "tools/output/pending_file.h"
#include "tools/ptin/pixel_size.h"
#include "tools/ptin/query_options.h"
#include "tools/region/on_terrain.h"

namespace ptin::tools {

namespace {

struct ViewshedOptions {
  TerrainOptions terrain;
  double x = 0, y = 0, height = 0;
  double target_height = 0, radius = 0;
  double curvature = Curvature{}.coefficient;
  bool absolute = false;
  std::optional<std::string> pixel_size;
  DetailOptions detail;
  std::string memory, output;
  bool overwrite = false;
};

constexpr std::uint64_t kLeastCache = std::uint64_t{1} << 20;
constexpr std::uint64_t kMostCache = std::uint64_t{64} << 20;

std::uint64_t request_memory(const ViewshedOptions& options) {
  return memory_limit_of(options.memory, QueryLimits{}.memory_bytes);
}

bool is_raster(const std::string& path) {
  const std::string extension = lower_extension(path);
  return extension == ".tif" || extension == ".tiff";
}

/// The side of a pixel that was asked for; none: none was.
std::vector<Length> sides_of(const ViewshedOptions& options) {
  if (!options.pixel_size) return {};
  return pixel_sides_of({*options.pixel_size});
}

/// The pixels that were asked for, in map units; none: those of the terrain's raster. As in an
/// export a raster has 2 x 2 at least.
std::optional<std::array<double, 2>> pixel_size_of(const ViewshedOptions& options,
                                                   const CrsFacts& crs,
                                                   const ViewshedRequest& request) {
  const std::vector<Length> sides = sides_of(options);
  if (sides.empty()) return std::nullopt;
  const std::array<double, 2> size = pixel_size_of(sides, crs, request.eye);
  const bool is_wider = size[0] * request.ground_per_map_x > request.radius;
  const bool is_higher = size[1] * request.ground_per_map_y > request.radius;
  if (request.radius > 0 && (is_wider || is_higher)) {
    throw Error(ErrorCode::invalid_argument,
                "pixels of " + short_number(size[0]) + " x " + short_number(size[1]) +
                    " map units are larger than the radius, so the raster would be one pixel wide "
                    "or high; give a smaller size (over ground as 90m), or a larger --radius",
                "--pixel-size");
  }
  return size;
}

void check_options(const ViewshedOptions& options) {
  if (options.output == "-") {
    throw Error(ErrorCode::invalid_argument, "the output must be a file: .tif for a raster, " +
                                                 known_vector_extensions() + " for vertices");
  }
  if (!is_raster(options.output) && find_vector_format(options.output) == nullptr) {
    throw Error(ErrorCode::invalid_argument,
                "the name must end in .tif for a raster, or in one of " +
                    known_vector_extensions() + " for vertices",
                options.output);
  }
  static_cast<void>(sides_of(options));
  if (!is_raster(options.output) && options.pixel_size) {
    throw Error(ErrorCode::invalid_argument, "--pixel-size is for rasters (.tif); leave it out",
                options.output);
  }
  check_output(options.output, options.overwrite);
}

void check_stop(const Context& context, const ViewshedOptions& options) {
  stop_if_asked(context.stop, "writing", options.output);
}

/// Writes the raster by rows of blocks, between which a stop is obeyed.
void write_pixels(GDALRasterBand& band, const Viewshed& seen, const ViewshedOptions& options,
                  const Context& context) {
  const int width = band.GetXSize();
  int block_width = 0, block_height = 0;
  band.GetBlockSize(&block_width, &block_height);
  for (int row = 0; row < band.GetYSize(); row += block_height) {
    check_stop(context, options);
    const int rows = std::min(block_height, band.GetYSize() - row);
    const Sight* const first =
        seen.pixels.data() + static_cast<std::size_t>(row) * static_cast<std::size_t>(width);
    require_done(band.RasterIO(GF_Write, 0, row, width, rows, const_cast<Sight*>(first), width,
                               rows, GDT_Byte, 0, 0, nullptr),
                 "cannot write the raster", options.output);
  }
}

void write_raster(const Viewshed& seen, const ViewshedOptions& options, const std::string& wkt,
                  const Context& context) {
  PendingFile pending(options.output, options.overwrite);
  const char* creation[] = {"COMPRESS=DEFLATE", "TILED=YES", "BIGTIFF=IF_SAFER", nullptr};
  const int width = static_cast<int>(seen.width);
  const int height = static_cast<int>(seen.height);
  GDALDatasetUniquePtr file(driver_named("GTiff").Create(
      pending.temporary().c_str(), width, height, 1, GDT_Byte, const_cast<char**>(creation)));
  if (!file) throw gdal_failure("cannot create the raster", options.output);
  double transform[6] = {seen.first.x - seen.step_x / 2, seen.step_x, 0,
                         seen.first.y + seen.step_y / 2, 0,           -seen.step_y};
  require_done(file->SetGeoTransform(transform), "cannot place the raster", options.output);
  set_geotiff_crs(*file, wkt, false, options.output);
  GDALRasterBand* band = file->GetRasterBand(1);
  require_done(band->SetNoDataValue(static_cast<double>(Sight::kNothing)),
               "cannot set the nodata value", options.output);
  // The mesh is freed by now: half of its memory is enough for GDAL.
  const std::uint64_t memory = request_memory(options);
  const GdalCacheLimit cache(std::clamp<std::uint64_t>(memory / 2, kLeastCache, kMostCache));
  CPLErrorReset();
  write_pixels(*band, seen, options, context);
  file->FlushCache(true);
  file.reset();
  if (CPLGetLastErrorType() == CE_Failure) {
    throw gdal_failure("cannot write the raster", options.output);
  }
  pending.publish();
}

void write_vertices(const Viewshed& seen, const ViewshedOptions& options, const std::string& wkt,
                    const Context& context) {
  VectorFile file(options.output, options.overwrite,
                  {"viewshed",
                   wkbPoint,
                   {{"height", VectorFile::FieldType::kReal},
                    {"visible", VectorFile::FieldType::kFlag},
                    {"certain", VectorFile::FieldType::kFlag}},
                   wkt});
  std::size_t written = 0;
  for (const Viewshed::Target& v : seen.vertices) {
    if (written++ % kStopInterval == 0) check_stop(context, options);
    const VectorFile::Value values[] = {v.height, static_cast<std::int64_t>(v.visible ? 1 : 0),
                                        static_cast<std::int64_t>(v.certain ? 1 : 0)};
    file.add(std::make_unique<OGRPoint>(v.position.x, v.position.y), values);
  }
  file.publish();
}

/// Counts of targets as JSON; null where they were not asked for.
nlohmann::json counts_json(bool asked, std::uint64_t visible, std::uint64_t hidden,
                           std::uint64_t undecided) {
  if (!asked) return nullptr;
  return {{"visible", visible}, {"hidden", hidden}, {"undecided", undecided}};
}

void report(const ViewshedOptions& options, const Viewshed& seen, const StoreFile& store,
            const CrsFacts& crs, const Context& context) {
  const bool raster = is_raster(options.output);
  if (context.json) {
    print_json({{"output", options.output},
                {"eye_height", seen.eye_height},
                {"width", seen.width},
                {"height", seen.height},
                {"pixels", counts_json(raster, seen.visible_pixels, seen.hidden_pixels,
                                       seen.undecided_pixels)},
                {"vertices", counts_json(!raster, seen.visible_vertices, seen.hidden_vertices,
                                         seen.undecided_vertices)},
                {"certified_error", seen.certified_error},
                {"certified_deviation", seen.certified_deviation},
                {"border_moved_at_most", border_move_json(store, seen.certified_error)},
                {"exact", seen.exact},
                {"units", units_json(crs)},
                {"cost", cost_json(seen.cost)}});
  } else if (!context.quiet) {
    const std::uint64_t visible = raster ? seen.visible_pixels : seen.visible_vertices;
    const std::uint64_t hidden = raster ? seen.hidden_pixels : seen.hidden_vertices;
    const std::uint64_t undecided = raster ? seen.undecided_pixels : seen.undecided_vertices;
    const std::string open =
        undecided == 0 ? "" : " for certain, " + grouped(undecided) + " undecided";
    std::printf("%s: %s of %s %s visible%s%s\n", options.output.c_str(), grouped(visible).c_str(),
                grouped(visible + hidden + undecided).c_str(), raster ? "pixels" : "vertices",
                open.c_str(), seen.exact ? "" : ", not exact");
  }
}

int run_viewshed(const ViewshedOptions& options, const Context& context) {
  check_options(options);
  const Terrain terrain = open_terrain(options.terrain, context);
  warn_of_terrain(terrain.store(), options.detail.error, context);
  // Without --pixel-size, a terrain of points is refused here: its grid is far finer than anybody
  // wants to see.
  if (is_raster(options.output) && !options.pixel_size) {
    static_cast<void>(own_pixel_size(terrain.store()));
  }
  const CrsFacts crs = crs_facts(terrain.store());
  ViewshedRequest request;
  request.eye = {options.x, options.y};
  check_on_terrain(request.eye, terrain.store().facts(), "X Y");
  request.eye_height = options.height;
  request.absolute = options.absolute;
  request.target_height = options.target_height;
  const Ground ground = ground_of(crs);
  request.curvature = {options.curvature, ground.earth_diameter};
  const MapPoint per_unit = ground.per_map_unit(request.eye);
  request.ground_per_map_x = per_unit.x;
  request.ground_per_map_y = per_unit.y;
  request.detail = detail_of(options.detail);
  request.limits.stop = context.stop;
  request.limits.memory_bytes = request_memory(options);
  request.radius =
      ground.geographic ? options.radius / ground.metres_per_height : options.radius * per_unit.x;
  request.pixel_size = pixel_size_of(options, crs, request);
  request.pixels = is_raster(options.output);
  request.list_vertices = !request.pixels;
  const Viewshed seen = terrain.viewshed(request);
  if (is_raster(options.output)) {
    write_raster(seen, options, crs.wkt, context);
  } else {
    write_vertices(seen, options, crs.wkt, context);
  }
  report(options, seen, terrain.store(), crs, context);
  return kExitDone;
}

}  // namespace

Action declare_viewshed(CLI::App& app, Context& context) {
  const auto options = std::make_shared<ViewshedOptions>();
  add_terrain_options(app, options->terrain, true);
  const CLI::Validator position = numbers(NumberRange::kFinite, "in map units");
  Measures& measures = options->terrain.measures;
  app.add_option("X", options->x, "The observer's position, in map units")
      ->required()
      ->check(position);
  app.add_option("Y", options->y, "")->required()->check(position);
  measures
      .add(app, "H", options->height, MeasureKind::kHeight, NumberRange::kFinite,
           "The observer's height above the surface")
      ->required();
  measures
      .add(app, "--radius", options->radius, MeasureKind::kGround, NumberRange::kPositive,
           "How far to look: map units (metres in a geographic CRS), or 5km, 3mi")
      ->type_name("R")
      ->required();
  app.add_flag("--absolute", options->absolute, "H is a height of itself, not above the surface");
  measures
      .add(app, "--target-height", options->target_height, MeasureKind::kHeight,
           NumberRange::kFinite, "Height of targets above the surface")
      ->type_name("T");
  add_curvature_option(app, options->curvature);
  app.add_option(
         "--pixel-size", options->pixel_size,
         "Side of a pixel, in map units, or over ground as 90m, 0.1km or 300ft, converted at "
         "the observer (default: that of the raster it was built from)")
      ->type_name("S");
  add_detail_options(
      app, options->terrain.measures, options->detail,
      " at the radius, less towards the observer; where the full TIN may answer otherwise, a "
      "target is undecided (192 seems visible, 64 hidden; `certain` is 0)",
      "Of the TIN of the terrain's N most important vertices, and more towards the "
      "observer; undecided targets as with --error");
  app.add_option("-o,--output", options->output,
                 "A raster (.tif: visible 255, hidden 0, no target 128), or the vertices with "
                 "`visible` and "
                 "`certain` (" +
                     known_vector_extensions() + ")")
      ->type_name("OUT")
      ->required();
  app.add_option("--memory", options->memory, "Memory for the answer, as 512M or 2G (default 4G)")
      ->type_name("SIZE");
  app.add_flag("--overwrite", options->overwrite, "Replace an existing output");
  return [options, &context] { return run_viewshed(*options, context); };
}

}  // namespace ptin::tools
