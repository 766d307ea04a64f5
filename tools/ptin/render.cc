// SPDX-License-Identifier: GPL-3.0-or-later
//
// ptin render: a picture of the TIN.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>

#include <nlohmann/json.hpp>

#include "engine/crs/crs_facts.h"
#include "engine/crs/ground.h"
#include "tools/error_status.h"
#include "tools/facts/answers.h"
#include "tools/facts/human.h"
#include "tools/output/output_file.h"
#include "tools/plot/canvas.h"
#include "tools/ptin/error_stats.h"
#include "tools/ptin/query_options.h"
#include "tools/ptin/source_counts.h"
#include "tools/render/overlay.h"

namespace ptin::tools {

namespace {

struct RenderOptions {
  TerrainOptions terrain;
  RegionOptions region;
  std::optional<double> error;
  std::vector<int> size;
  bool wireframe = false;
  bool pages = false;
  bool no_legend = false;
  std::string memory, output;
  bool overwrite = false;
};

void check_options(const RenderOptions& options) {
  const std::string& path = options.output;
  if (!is_picture_name(path)) {
    throw Error(ErrorCode::invalid_argument,
                "unknown extension; known are " + known_picture_extensions(), path);
  }
  check_output(path, options.overwrite);
}

Window whole_window(const StoreFacts& facts) {
  const MapPoint low = facts.map.to_map(facts.bounds.min_x, facts.bounds.min_y);
  const MapPoint high = facts.map.to_map(facts.bounds.max_x, facts.bounds.max_y);
  return {low.x, low.y, high.x, high.y};
}

constexpr int kSupersampling = 2;

/// The memory that is left for the TIN beside the picture, in bytes.
/// @throws Error resource_exhausted  the picture alone takes more than the limit
std::uint64_t memory_beside_picture(const RenderOptions& options, const View& view) {
  const std::uint64_t limit = memory_limit_of(options.memory);
  // Pixels of the relief, of the picture and of the sheet; making a file takes less.
  const std::uint64_t bytes =
      static_cast<std::uint64_t>(view.width) * static_cast<std::uint64_t>(view.height) *
      (kSupersampling * kSupersampling * raster_bytes_per_pixel(options.pages) +
       2 * sizeof(Image::pixels[0]));
  if (bytes < limit) return limit - bytes;
  throw Error(ErrorCode::resource_exhausted,
              "a picture of " + std::to_string(view.width) + " x " + std::to_string(view.height) +
                  " pixels takes " + human_bytes(bytes) + ", and " + human_bytes(limit) +
                  " are allowed; give a smaller --size or more --memory",
              options.output);
}

/// A tolerance at which the TIN has at most a few vertices a pixel: none where the full TIN has no
/// more, else the smallest round tolerance that does.
std::optional<double> tolerance_for(const StoreFile& store, const Window& window,
                                    const View& view) {
  const std::uint64_t pixels =
      static_cast<std::uint64_t>(view.width) * static_cast<std::uint64_t>(view.height);
  IoCounters io;
  const std::optional<double> least =
      detail_for(store, std::max<std::uint64_t>(300'000, 2 * pixels), window, io).tolerance;
  if (!least) return std::nullopt;
  const std::vector<double> tolerances = round_tolerances(store, 60);
  const auto round = std::lower_bound(tolerances.begin(), tolerances.end(), *least);
  return round != tolerances.end() ? *round : *least;
}

View view_of(const RenderOptions& options, const Window& window, const CrsFacts& crs) {
  const MapPoint middle{(window.min_x + window.max_x) / 2, (window.min_y + window.max_y) / 2};
  const bool sized = !options.size.empty();
  if (sized && (options.size[0] < 1 || options.size[1] < 1)) {
    throw Error(ErrorCode::invalid_argument,
                "the picture's sides must be from 1 to " + std::to_string(kMostPixels) + " pixels",
                "--size");
  }
  return make_view(window, ground_of(crs).per_map_unit(middle), sized ? options.size[0] : 0,
                   sized ? options.size[1] : 0);
}

/// The window, and the map beside it that is seen when the picture has another shape.
Window visible_window(const View& view) {
  const double beside = view.left / view.scale_x;
  const double above = view.top / view.scale_y;
  const Window& w = view.window;
  return {w.min_x - beside, w.min_y - above, w.max_x + beside, w.max_y + above};
}

/// Draws the terrain on a sheet; returns what it looks like.
ReliefStyle draw(Canvas& canvas, const RenderOptions& options, const RefinedTin& refined,
                 const StoreFacts& facts, const View& view, const std::stop_token& stop) {
  const TerrainRaster raster = rasterize(refined, facts, supersampled(view, kSupersampling), stop);
  const bool shows_facets = options.wireframe || options.pages;
  const ReliefStyle style =
      choose_style(raster, view, options.pages,
                   shows_facets ? 1 : pixels_between_samples(facts.map, view) * kSupersampling);
  canvas.paint(draw_relief(raster, view, kSupersampling, style, stop));
  if (options.wireframe) draw_wireframe(canvas, refined, facts, view, stop);
  return style;
}

void warn_of_picture(const RefinedTin& refined, const StoreFile& store, const std::string& output) {
  const std::vector<TriangleClass>& classes = refined.tin.classes;
  if (refined.triangles == 0) {
    std::fprintf(stderr, "ptin: warning: no triangle meets the window; %s shows nothing\n",
                 output.c_str());
  } else if (std::count(classes.begin(), classes.end(), TriangleClass::kSurface) == 0 &&
             has_surface(store)) {
    std::fprintf(stderr, "ptin: warning: all that meets the window is void; %s shows no surface\n",
                 output.c_str());
  }
}

int run_render(const RenderOptions& options, const Context& context) {
  check_options(options);
  const Terrain terrain = open_terrain(options.terrain, context);
  warn_of_terrain(terrain.store(), options.error, context);
  const StoreFile& store = terrain.store();
  const CrsFacts crs = crs_facts(store);
  const std::optional<Region> region = region_of(options.region, store.facts(), crs).region;
  const Window window = region ? std::get<Window>(*region) : whole_window(store.facts());
  const View view = view_of(options, window, crs);

  RefineRequest request;
  request.limits.memory_bytes = memory_beside_picture(options, view);
  if (region) request.region = visible_window(view);
  request.detail.tolerance =
      options.error ? options.error : tolerance_for(store, visible_window(view), view);
  request.form = ResultForm::kMeetingRegion;
  request.page_of_triangle = options.pages;
  request.limits.stop = context.stop;
  const RefinedTin refined = terrain.refine(request);
  Canvas canvas(options.output, options.overwrite, view.width, view.height);
  const ReliefStyle style = draw(canvas, options, refined, store.facts(), view, context.stop);
  if (!options.no_legend) draw_legend(canvas, view, style, unit_of_ground(crs), crs.vertical_unit);
  canvas.publish();
  if (!context.quiet) warn_of_picture(refined, store, options.output);

  const nlohmann::json answer = {
      {"output", options.output},
      {"width", view.width},
      {"height", view.height},
      {"tolerance",
       request.detail.tolerance ? nlohmann::json(*request.detail.tolerance) : nlohmann::json()},
      {"vertices", refined.vertices},
      {"triangles", refined.triangles},
      {"certified_error", refined.certified_error},
      {"certified_deviation", refined.certified_deviation},
      {"border_moved_at_most", border_move_json(terrain.store(), refined.certified_error)},
      {"exact", refined.exact},
      {"units", units_json(crs)},
      {"exaggeration", style.exaggeration},
      {"cost", cost_json(refined.cost)}};
  if (context.json) {
    print_json(answer);
  } else if (!context.quiet) {
    const std::string level = request.detail.tolerance
                                  ? "within " + short_number(refined.certified_error)
                                  : "the full TIN";
    const std::string steepness = style.exaggeration == 1.0
                                      ? "as they are"
                                      : short_number(style.exaggeration) + " times as steep";
    std::printf("%s: %d x %d pixels, %s, %s; slopes shaded %s\n", options.output.c_str(),
                view.width, view.height, counted(refined.triangles, "triangle").c_str(),
                level.c_str(), steepness.c_str());
  }
  return kExitDone;
}

}  // namespace

Action declare_render(CLI::App& app, Context& context) {
  const auto options = std::make_shared<RenderOptions>();
  add_terrain_options(app, options->terrain, false);
  add_region_options(app, options->region, RegionKinds::kWindow);
  add_error_option(app, options->terrain.measures, options->error,
                   "Certified error allowed, in the height's unit, or as 50cm (default: as fine as "
                   "the pixels can show)");
  app.add_option("--size", options->size, "Pixels (default: the longer side has 1200)")
      ->expected(2)
      ->type_name("W H");
  app.add_flag("--wireframe", options->wireframe, "Draw the triangles");
  app.add_flag("--pages", options->pages, "Colour triangles by the page that each came from");
  app.add_flag("--no-legend", options->no_legend, "No scale bar and no height colours");
  app.add_option("-o,--output", options->output,
                 "The picture to write: " + known_picture_extensions())
      ->type_name("OUT")
      ->required();
  add_memory_option(app, options->memory);
  app.add_flag("--overwrite", options->overwrite, "Replace an existing output");
  return [options, &context] { return run_render(*options, context); };
}

}  // namespace ptin::tools
