// SPDX-License-Identifier: GPL-3.0-or-later
//
// ptin render: a picture of the TIN.
#include <algorithm>
#include <cmath>
#include <cstdio>

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
  ask::RegionText region;
  std::optional<double> error;
  std::vector<int> size;
  bool wireframe = false;
  bool pages = false;
  bool no_legend = false;
  std::optional<std::uint64_t> memory;
  OutputOptions out;
};

void check_options(const RenderOptions& options) {
  const std::string& path = options.out.output;
  if (!is_picture_name(path)) {
    throw Error(ErrorCode::invalid_argument,
                "unknown extension; known are " + known_picture_extensions(), path);
  }
  check_output(path, options.out.overwrite);
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
              options.out.output);
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
  const Terrain terrain = open_terrain(options.terrain, options.error, context);
  const StoreFile& store = terrain.store();
  const CrsFacts crs = crs_facts(store);
  const std::optional<Region> region =
      region_of(options.region, store.facts(), crs, context).region;
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
  Canvas canvas(options.out.output, options.out.overwrite, view.width, view.height);
  const ReliefStyle style = draw(canvas, options, refined, store.facts(), view, context.stop);
  if (!options.no_legend) draw_legend(canvas, view, style, unit_of_ground(crs), crs.vertical_unit);
  canvas.publish();
  if (!context.quiet) warn_of_picture(refined, store, options.out.output);

  const ask::Json answer = {
      {"output", options.out.output},
      {"width", view.width},
      {"height", view.height},
      {"tolerance", request.detail.tolerance ? ask::Json(*request.detail.tolerance) : ask::Json()},
      {"vertices", refined.vertices},
      {"triangles", refined.triangles},
      {"exaggeration", style.exaggeration}};
  if (context.json) {
    print_answer(answer, ask::facts_of(refined, store, crs));
  } else if (!context.quiet) {
    const std::string level = request.detail.tolerance
                                  ? "within " + short_number(refined.certified_error)
                                  : "the full TIN";
    const std::string steepness = style.exaggeration == 1.0
                                      ? "as they are"
                                      : short_number(style.exaggeration) + " times as steep";
    std::printf("%s: %d x %d pixels, %s, %s; slopes shaded %s\n", options.out.output.c_str(),
                view.width, view.height, counted(refined.triangles, "triangle").c_str(),
                level.c_str(), steepness.c_str());
  }
  return kExitDone;
}

void add_question(ask::Parameters& rows, RenderOptions& options) {
  add_terrain(rows, options.terrain, false);
  ask::add_window(rows, options.region, ask::Door::kProgram);
  ask::add_error(rows, options.error,
                 "Certified error allowed; without it as fine as the pixels can show");
  rows.add("size", &options.size, "W H", "Pixels (default: the longer side has 1200)")
      .within({.least = 1, .most = kMostPixels})
      .values(2, 2);
  rows.add("wireframe", &options.wireframe, "", "Draw the triangles");
  rows.add("pages", &options.pages, "", "Colour triangles by the page that each came from");
  rows.add("no-legend", &options.no_legend, "", "No scale bar and no height colours");
  add_output(rows, options.out, "The picture to write: " + known_picture_extensions());
  ask::add_memory(rows, options.memory);
}

}  // namespace

Declared declare_render(Context& context) { return declared<RenderOptions>(context, run_render); }

}  // namespace ptin::tools
