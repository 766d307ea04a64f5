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

#include "engine/construct/memory_plan.h"
#include "engine/crs/crs_facts.h"
#include "engine/crs/ground.h"
#include "engine/query/questions.h"
#include "engine/stop.h"
#include "tools/ask/questions.h"
#include "tools/error_status.h"
#include "tools/facts/answers.h"
#include "tools/facts/human.h"
#include "tools/formats/geotiff_crs.h"
#include "tools/formats/vector_file.h"
#include "tools/output/file_name.h"
#include "tools/output/gdal_output.h"
#include "tools/output/output_file.h"
#include "tools/output/pending_file.h"
#include "tools/ptin/answer_output.h"
#include "tools/ptin/pixel_size.h"
#include "tools/ptin/query_options.h"
#include "tools/region/on_terrain.h"

namespace ptin::tools {

namespace {

struct ViewshedOptions {
  TerrainOptions terrain;
  ask::ViewshedQuestion question;
  std::vector<std::string> pixel_size;
  std::optional<std::uint64_t> memory;
  OutputOptions out;
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

/// The pixels that were asked for, in map units; none: those of the terrain's raster. As in an
/// export a raster has 2 x 2 at least.
std::optional<std::array<double, 2>> pixel_size_of(const ViewshedOptions& options,
                                                   const CrsFacts& crs,
                                                   const ViewshedRequest& request) {
  const std::vector<Length> sides = pixel_sides_of(options.pixel_size);
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
  if (options.out.output == "-") {
    throw Error(ErrorCode::invalid_argument, "the output must be a file: .tif for a raster, " +
                                                 known_vector_extensions() + " for vertices");
  }
  if (!is_raster(options.out.output) && find_vector_format(options.out.output) == nullptr) {
    throw Error(ErrorCode::invalid_argument,
                "the name must end in .tif for a raster, or in one of " +
                    known_vector_extensions() + " for vertices",
                options.out.output);
  }
  static_cast<void>(pixel_sides_of(options.pixel_size));
  if (!is_raster(options.out.output) && !options.pixel_size.empty()) {
    throw Error(ErrorCode::invalid_argument, "--pixel-size is for rasters (.tif); leave it out",
                options.out.output);
  }
  check_output(options.out.output, options.out.overwrite);
}

void check_stop(const Context& context, const ViewshedOptions& options) {
  stop_if_asked(context.stop, "writing", options.out.output);
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
                 "cannot write the raster", options.out.output);
  }
}

void write_raster(const Viewshed& seen, const ViewshedOptions& options, const std::string& wkt,
                  const Context& context) {
  PendingFile pending(options.out.output, options.out.overwrite);
  const char* creation[] = {"COMPRESS=DEFLATE", "TILED=YES", "BIGTIFF=IF_SAFER", nullptr};
  const int width = static_cast<int>(seen.width);
  const int height = static_cast<int>(seen.height);
  GDALDatasetUniquePtr file(driver_named("GTiff").Create(
      pending.temporary().c_str(), width, height, 1, GDT_Byte, const_cast<char**>(creation)));
  if (!file) throw gdal_failure("cannot create the raster", options.out.output);
  double transform[6] = {seen.first.x - seen.step_x / 2, seen.step_x, 0,
                         seen.first.y + seen.step_y / 2, 0,           -seen.step_y};
  require_done(file->SetGeoTransform(transform), "cannot place the raster", options.out.output);
  set_geotiff_crs(*file, wkt, false, options.out.output);
  GDALRasterBand* band = file->GetRasterBand(1);
  require_done(band->SetNoDataValue(static_cast<double>(Sight::kNothing)),
               "cannot set the nodata value", options.out.output);
  // The mesh is freed by now: half of its memory is enough for GDAL.
  const std::uint64_t memory = request_memory(options);
  const GdalCacheLimit cache(std::clamp<std::uint64_t>(memory / 2, kLeastCache, kMostCache));
  CPLErrorReset();
  write_pixels(*band, seen, options, context);
  file->FlushCache(true);
  file.reset();
  if (CPLGetLastErrorType() == CE_Failure) {
    throw gdal_failure("cannot write the raster", options.out.output);
  }
  pending.publish();
}

void write_vertices(const Viewshed& seen, const ViewshedOptions& options, const CrsFacts& crs,
                    const Context& context) {
  write_rows(
      options.out, AnswerForm::kLayer, context, {"viewshed", GeometryKind::kPoint, {}, crs},
      ask::target_fields(), seen.vertices.size(),
      [&](std::size_t i) -> const Viewshed::Target& {
        if (i % kStopInterval == 0) check_stop(context, options);
        return seen.vertices[i];
      },
      [&](std::size_t i) { return point_geometry(seen.vertices[i].position); });
}

void report(const ViewshedOptions& options, const Viewshed& seen, const StoreFile& store,
            const CrsFacts& crs, const Context& context) {
  const bool raster = is_raster(options.out.output);
  if (context.json) {
    print_answer({{"output", options.out.output}}, ask::viewshed_fields(), seen,
                 ask::facts_of(seen, store, crs));
  } else if (!context.quiet) {
    const std::uint64_t visible = raster ? seen.visible_pixels : seen.visible_vertices;
    const std::uint64_t hidden = raster ? seen.hidden_pixels : seen.hidden_vertices;
    const std::uint64_t undecided = raster ? seen.undecided_pixels : seen.undecided_vertices;
    const std::string open =
        undecided == 0 ? "" : " for certain, " + grouped(undecided) + " undecided";
    std::printf("%s: %s of %s %s visible%s%s\n", options.out.output.c_str(),
                grouped(visible).c_str(), grouped(visible + hidden + undecided).c_str(),
                raster ? "pixels" : "vertices", open.c_str(), seen.exact ? "" : ", not exact");
  }
}

int run_viewshed(const ViewshedOptions& options, const Context& context) {
  check_options(options);
  const Terrain terrain =
      open_terrain(options.terrain, options.question.request.detail.tolerance, context);
  // Without --pixel-size, a terrain of points is refused here: its grid is far finer than anybody
  // wants to see.
  if (is_raster(options.out.output) && options.pixel_size.empty()) {
    static_cast<void>(own_pixel_size(terrain.store()));
  }
  const CrsFacts crs = crs_facts(terrain.store());
  ViewshedRequest request = options.question.request;
  request.eye = {options.question.x, options.question.y};
  check_on_terrain(request.eye, terrain.store().facts(), "X Y");
  const Ground ground = ground_of(crs);
  ask::set_ground(request, ground);
  request.limits.stop = context.stop;
  request.limits.memory_bytes = request_memory(options);
  const double radius = options.question.radius;
  request.radius =
      ground.geographic ? radius / ground.metres_per_height : radius * request.ground_per_map_x;
  request.pixel_size = pixel_size_of(options, crs, request);
  request.pixels = is_raster(options.out.output);
  request.list_vertices = !request.pixels;
  const Viewshed seen = terrain.viewshed(request);
  if (is_raster(options.out.output)) {
    write_raster(seen, options, crs.wkt, context);
  } else {
    write_vertices(seen, options, crs, context);
  }
  report(options, seen, terrain.store(), crs, context);
  return kExitDone;
}

void add_question(ask::Parameters& rows, ViewshedOptions& options) {
  add_terrain(rows, options.terrain, true);
  ask::add_question(rows, options.question);
  rows.add("pixel-size", &options.pixel_size, "S",
           "Side of a pixel, in map units, or over ground as 90m, 0.1km or 300ft, converted at the "
           "observer (default: that of the raster it was built from)");
  add_output(rows, options.out,
             "A raster (.tif: visible 255, hidden 0, no target 128), or the vertices with "
             "`visible` and `certain` (" +
                 known_vector_extensions() + ")");
  ask::add_memory(rows, options.memory, "Memory for the answer, as 512M or 2G (default 4G)");
}

}  // namespace

Declared declare_viewshed(Context& context) {
  return declared<ViewshedOptions>(context, run_viewshed);
}

}  // namespace ptin::tools
