// SPDX-License-Identifier: GPL-3.0-or-later
//
// ptin render: a picture of the TIN.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <utility>

#include <nlohmann/json.hpp>

#include "engine/crs/credits.h"
#include "engine/crs/crs_facts.h"
#include "engine/crs/ground.h"
#include "storage/file/file_questions.h"
#include "tools/error_status.h"
#include "tools/facts/answers.h"
#include "tools/facts/human.h"
#include "tools/output/output_file.h"
#include "tools/plot/axis.h"
#include "tools/plot/canvas.h"
#include "tools/ptin/error_stats.h"
#include "tools/ptin/isoline_layer.h"
#include "tools/ptin/query_options.h"
#include "tools/ptin/source_counts.h"
#include "tools/render/contours.h"
#include "tools/render/north.h"
#include "tools/render/overlay.h"
#include "tools/render/sheet.h"

namespace ptin::tools {

namespace {

/// How a picture is laid out.
enum class SheetStyle : std::uint8_t { kMap, kPlain, kPrint };
constexpr std::array<std::pair<const char*, SheetStyle>, 3> kSheetStyles = {
    {{"map", SheetStyle::kMap}, {"plain", SheetStyle::kPlain}, {"print", SheetStyle::kPrint}}};

struct RenderOptions {
  TerrainOptions terrain;
  ask::RegionText region;
  std::optional<double> error;
  std::vector<int> size;
  bool wireframe = false;
  bool pages = false;
  std::optional<double> contours;  ///< Interval, height's unit.
  std::string style = "map";
  std::optional<std::uint64_t> memory;
  OutputOptions out;
};

SheetStyle style_of(const RenderOptions& options) {
  const auto* const found = std::find_if(kSheetStyles.begin(), kSheetStyles.end(),
                                         [&](const auto& s) { return options.style == s.first; });
  return found->second;  // the row of --style allows no other text
}

/// Dots of a relief for a pixel of the sheet, along each side. A pixel is 1/96 inch, as in SVG and PDF.
double dots_of(const RenderOptions& options) {
  constexpr double kDotsPerInch = 300, kPixelsPerInch = 96;
  return style_of(options) == SheetStyle::kPrint ? kDotsPerInch / kPixelsPerInch : 1.0;
}

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

/// A map, and the sheet that it is drawn on.
struct Picture {
  View map;                           ///< In pixels of the sheet.
  std::optional<SheetLayout> around;  ///< None: the map is all.
  SheetText text;
  double dots = 1.0;

  [[nodiscard]] int width() const { return around ? around->width : map.width; }
  [[nodiscard]] int height() const { return around ? around->height : map.height; }
  [[nodiscard]] View relief() const { return supersampled(map, dots); }
};

/// The memory that is left for the TIN beside the picture, in bytes.
/// @throws Error resource_exhausted  the picture alone takes more than the limit
std::uint64_t memory_beside_picture(const RenderOptions& options, const Picture& picture) {
  const std::uint64_t limit = memory_limit_of(options.memory);
  const View relief = picture.relief();
  // Pixels of the relief, of the picture and of the sheet; making a file takes less.
  const std::uint64_t bytes =
      static_cast<std::uint64_t>(relief.width) * static_cast<std::uint64_t>(relief.height) *
      (kSupersampling * kSupersampling * raster_bytes_per_pixel(options.pages) +
       2 * sizeof(Image::pixels[0]));
  if (bytes < limit) return limit - bytes;
  throw Error(ErrorCode::resource_exhausted,
              "a picture of " + std::to_string(relief.width) + " x " +
                  std::to_string(relief.height) + " pixels takes " + human_bytes(bytes) + ", and " +
                  human_bytes(limit) + " are allowed; give a smaller --size or more --memory",
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

MapPoint middle_of(const Window& window) {
  return {(window.min_x + window.max_x) / 2, (window.min_y + window.max_y) / 2};
}

View view_of(const Window& window, const CrsFacts& crs, int width, int height) {
  return make_view(window, ground_of(crs).per_map_unit(middle_of(window)), width, height);
}

/// The words of the foot: the CRS, what heights are above, the source.
std::string foot_of(const std::string& attribution, const CrsFacts& crs) {
  std::string foot = crs.name.empty() ? "unknown CRS" : crs.name;
  if (!crs.code.empty()) foot += " (" + crs.code + ")";
  if (!crs.geographic && crs.horizontal_unit != "unknown") {
    foot += ", coordinates in " + plural_of(crs.horizontal_unit);
  }
  const std::string vertical = crs.vertical_name.empty() ? "" : ", " + crs.vertical_name;
  if (crs.vertical_unit != "unknown") foot += ". Heights in " + plural_of(crs.vertical_unit);
  foot += (crs.vertical_unit != "unknown" ? vertical : "") + ".";
  return attribution.empty() ? foot : foot + " " + attribution;
}

/// The words on how exact the picture is.
/// @param tolerance  That was asked for, if any. It is told where it holds: it is the rounder number. A file
///                   that keeps less detail certifies more.
std::string detail_text(const ask::AnswerFacts& facts, const std::optional<double>& tolerance,
                        const CrsFacts& crs) {
  if (facts.exact) return "full TIN";
  double within = facts.certified_error;
  if (tolerance && within <= *tolerance) {
    within = *tolerance;
  } else if (within > 0) {
    // A bound is rounded upwards, to the third digit.
    const double digit = std::pow(10.0, std::floor(std::log10(within)) - 2);
    within = std::ceil(within / digit) * digit;
  }
  const std::string unit = short_unit(crs.vertical_unit);
  return "every sample within " + short_number(within) + (unit.empty() ? "" : " " + unit);
}

SheetText text_of(const RenderOptions& options, const StoreFile& store, const CrsFacts& crs) {
  const Credits credits = credits_of(store);
  SheetText text;
  text.title = credits.title.empty() ? std::filesystem::path(options.terrain.file).stem().string()
                                     : credits.title;
  text.foot = foot_of(credits.attribution, crs);
  text.length_unit = unit_of_ground(crs);
  text.height_unit = crs.vertical_unit;
  text.is_in_degrees = crs.geographic;
  return text;
}

/// Lays the picture out. Without --size the map's longer side has 1200 pixels, in print 1000, which a
/// page of A4 holds.
Picture picture_of(const RenderOptions& options, const Window& window, const CrsFacts& crs,
                   SheetText text) {
  constexpr double kPageShare = 1000.0 / 1200.0;
  const bool is_print = style_of(options) == SheetStyle::kPrint;
  const bool has_sheet = style_of(options) != SheetStyle::kPlain;
  Picture picture{{}, std::nullopt, std::move(text), dots_of(options)};
  if (options.size.empty()) {
    picture.map = view_of(window, crs, 0, 0);
    if (is_print) {
      const View page = supersampled(picture.map, kPageShare);
      picture.map = view_of(window, crs, page.width, page.height);
    }
    if (has_sheet) {
      picture.around = layout_around(picture.map.width, picture.map.height, picture.text);
    }
    return picture;
  }
  if (has_sheet) picture.around = layout_within(options.size[0], options.size[1], picture.text);
  const CanvasBox map = picture.around
                            ? picture.around->map
                            : CanvasBox{0, 0, double(options.size[0]), double(options.size[1])};
  picture.map = view_of(window, crs, static_cast<int>(map.width()), static_cast<int>(map.height()));
  if (!picture.around) return picture;
  // The frame leaves out what lies beside the window.
  const double width = std::round(map.width() - 2 * picture.map.left);
  const double height = std::round(map.height() - 2 * picture.map.top);
  picture.map = view_of(window, crs, static_cast<int>(width), static_cast<int>(height));
  picture.around = with_frame(*std::move(picture.around), width, height);
  return picture;
}

/// The window, and the map beside it that is seen when the picture has another shape.
Window visible_window(const View& view) {
  const double beside = view.left / view.scale_x;
  const double above = view.top / view.scale_y;
  const Window& w = view.window;
  return {w.min_x - beside, w.min_y - above, w.max_x + beside, w.max_y + above};
}

/// The isolines of the level that the picture shows; none where none were asked for.
std::optional<Isolines> contours_of(const RenderOptions& options, const RefineRequest& request,
                                    const Terrain& terrain) {
  if (!options.contours) return std::nullopt;
  IsolineRequest lines;
  ask::Levels levels;
  levels.interval = options.contours;
  lines.levels = ask::levels_of(levels, terrain.store().facts());
  lines.region = request.region;
  lines.detail = request.detail;
  lines.limits = request.limits;
  lines.temporary_folder = folder_of(options.out.output);
  return terrain.isolines(lines, AnswerBy::kBest);
}

/// What lies under the pixels, and what is drawn over them.
struct Shown {
  TerrainRaster raster;
  std::optional<RefinedTin> mesh;  ///< Where triangles or their pages are drawn.
  std::optional<Isolines> contours;
  ask::AnswerFacts facts;
  QueryCost cost;
  std::stop_token stop;
};

/// Asks for all that the picture shows.
Shown ask_for(const RenderOptions& options, const RefineRequest& request, const Picture& picture,
              const Terrain& terrain, const CrsFacts& crs) {
  Shown shown;
  shown.stop = request.limits.stop;
  const View pixels = supersampled(picture.relief(), kSupersampling);
  const auto take = [&](const auto& result) {
    shown.facts = ask::facts_of(result, terrain.store(), crs);
    shown.cost = result.cost;
    shown.facts.cost = &shown.cost;
  };
  if (options.wireframe || options.pages) {
    shown.mesh = terrain.refine(request);
    take(*shown.mesh);
  }
  if (options.pages) {
    shown.raster = rasterize(*shown.mesh, terrain.store().facts(), pixels, request.limits.stop);
  } else {
    const RasterResult result =
        sample_terrain(terrain, request.detail, request.limits, pixels, shown.raster);
    if (!shown.mesh) take(result);
  }
  shown.contours = contours_of(options, request, terrain);
  return shown;
}

/// Draws the terrain on a sheet; returns what it looks like.
ReliefStyle draw(Canvas& canvas, const RenderOptions& options, const Shown& shown,
                 const Picture& picture, const StoreFacts& facts) {
  const std::stop_token& stop = shown.stop;
  const View relief = picture.relief();
  const bool shows_facets = options.wireframe || options.pages;
  ReliefStyle style =
      choose_style(shown.raster, relief, options.pages,
                   shows_facets ? 1 : pixels_between_samples(facts.map, relief) * kSupersampling);
  style.hatching = static_cast<int>(std::lround(style.hatching * picture.dots));
  const View& map = picture.map;
  canvas.enter(picture.around ? picture.around->map
                              : CanvasBox{0, 0, double(map.width), double(map.height)});
  canvas.paint(draw_relief(shown.raster, relief, kSupersampling, style, stop), picture.dots);
  if (options.wireframe) draw_wireframe(canvas, *shown.mesh, facts, map, stop);
  if (shown.contours) {
    const IndexLevels index{options.contours.value_or(0.0), 0.0};
    draw_contours(
        canvas, *shown.contours, map, [&](double h) { return index.holds(h); }, stop);
  }
  canvas.unclip();
  if (picture.around) draw_sheet(canvas, *picture.around, map, style, picture.text);
  return style;
}

void warn_of_picture(const TerrainRaster& raster, const StoreFile& store,
                     const std::string& output) {
  const auto shows = [&](PointState state) {
    return std::find(raster.states.begin(), raster.states.end(), state) != raster.states.end();
  };
  if (shows(PointState::kSurface)) return;
  if (!shows(PointState::kVoid)) {
    std::fprintf(stderr, "ptin: warning: no triangle lies under a pixel; %s shows nothing\n",
                 output.c_str());
  } else if (has_surface(store)) {
    std::fprintf(stderr, "ptin: warning: all that meets the window is void; %s shows no surface\n",
                 output.c_str());
  }
}

/// The level of detail: what was asked for; the full TIN where triangles are not drawn and the file holds
/// a raster's heights, which cost less than a level; or else as fine as the pixels can show.
RefineRequest request_of(const RenderOptions& options, bool has_region, const Picture& picture,
                         const StoreFile& store) {
  RefineRequest request;
  request.limits.memory_bytes = memory_beside_picture(options, picture);
  if (options.contours) request.limits.memory_bytes /= 2;  // the lines have the other half
  const Window seen = visible_window(picture.map);
  if (has_region) request.region = seen;
  const bool draws_triangles = options.wireframe || options.pages;
  request.detail.tolerance = options.error;
  if (!options.error && (draws_triangles || store.floor() == nullptr)) {
    request.detail.tolerance = tolerance_for(store, seen, picture.relief());
  }
  request.form = ResultForm::kMeetingRegion;
  request.page_of_triangle = options.pages;
  return request;
}

void report(const RenderOptions& options, const ask::Json& answer, const Shown& shown) {
  const double exaggeration = answer["exaggeration"].get<double>();
  const std::string triangles = shown.mesh ? counted(shown.mesh->triangles, "triangle") + ", " : "";
  const std::string level = answer["tolerance"].is_null()
                                ? "the full TIN"
                                : "within " + short_number(shown.facts.certified_error);
  const std::string steepness =
      exaggeration == 1.0 ? "as they are" : short_number(exaggeration) + " times as steep";
  std::printf("%s: %d x %d pixels, %s%s; slopes shaded %s\n", options.out.output.c_str(),
              answer["width"].get<int>(), answer["height"].get<int>(), triangles.c_str(),
              level.c_str(), steepness.c_str());
}

int run_render(const RenderOptions& options, const Context& context) {
  check_options(options);
  const Terrain terrain = open_terrain(options.terrain, options.error, context);
  const StoreFile& store = terrain.store();
  const CrsFacts crs = crs_facts(store);
  const std::optional<Region> region =
      region_of(options.region, store.facts(), crs, context).region;
  const Window window = region ? std::get<Window>(*region) : whole_window(store.facts());
  Picture picture = picture_of(options, window, crs, text_of(options, store, crs));
  RefineRequest request = request_of(options, region.has_value(), picture, store);
  request.limits.stop = context.stop;
  // PROJ is asked where there is a sheet to draw on alone: it takes longer than a small picture.
  if (picture.around) picture.text.north = north_at(middle_of(window), crs);
  const Shown shown = ask_for(options, request, picture, terrain, crs);
  picture.text.detail = detail_text(shown.facts, request.detail.tolerance, crs);
  Canvas canvas(options.out.output, options.out.overwrite, picture.width(), picture.height(),
                picture.dots);
  const ReliefStyle style = draw(canvas, options, shown, picture, store.facts());
  canvas.publish();
  if (!context.quiet) warn_of_picture(shown.raster, store, options.out.output);

  const auto or_null = [&](std::uint64_t RefinedTin::*count) {
    return shown.mesh ? ask::Json((*shown.mesh).*count) : ask::Json();
  };
  const ask::Json answer = {
      {"output", options.out.output},
      {"width", canvas.width()},
      {"height", canvas.height()},
      {"tolerance", request.detail.tolerance ? ask::Json(*request.detail.tolerance) : ask::Json()},
      {"vertices", or_null(&RefinedTin::vertices)},
      {"triangles", or_null(&RefinedTin::triangles)},
      {"exaggeration", style.exaggeration}};
  if (context.json) {
    print_answer(answer, shown.facts);
  } else if (!context.quiet) {
    report(options, answer, shown);
  }
  return kExitDone;
}

void add_question(ask::Parameters& rows, RenderOptions& options) {
  add_terrain(rows, options.terrain, false);
  ask::add_window(rows, options.region, ask::Door::kProgram);
  ask::add_error(rows, options.error,
                 "Certified error allowed; without it as fine as the pixels can show");
  rows.add("size", &options.size, "W H",
           "Pixels of the whole picture (default: the longer side of the map has 1200, in print "
           "1000); in print 96 an inch")
      .within({.least = 1, .most = kMostPixels})
      .values(2, 2);
  rows.add("wireframe", &options.wireframe, "", "Draw the triangles");
  rows.add("pages", &options.pages, "", "Colour triangles by the page that each came from");
  rows.add("contours", &options.contours, "D",
           "Draw isolines every D, every fifth heavier and with its height")
      .in(ask::Unit::kHeight)
      .within(NumberRange::kPositive);
  rows.add("style", &options.style, "S",
           "map: with frame, coordinates, title and legend; plain: the terrain alone; print: a map "
           "at "
           "300 dots per inch")
      .of({"map", "plain", "print"});
  add_output(rows, options.out, "The picture to write: " + known_picture_extensions());
  ask::add_memory(rows, options.memory);
}

}  // namespace

Declared declare_render(Context& context) { return declared<RenderOptions>(context, run_render); }

}  // namespace ptin::tools
