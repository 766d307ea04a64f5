// SPDX-License-Identifier: GPL-3.0-or-later
//
// ptin export: the TIN at any level of detail, larger than memory too.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <memory>

#include "engine/crs/crs_facts.h"
#include "engine/query/terrain.h"
#include "storage/file/file_questions.h"
#include "tools/error_status.h"
#include "tools/export/raster_export.h"
#include "tools/export/tin_sink.h"
#include "tools/facts/answers.h"
#include "tools/facts/human.h"
#include "tools/output/file_name.h"
#include "tools/output/output_file.h"
#include "tools/progress.h"
#include "tools/ptin/mesh_crs.h"
#include "tools/ptin/pixel_content.h"
#include "tools/ptin/pixel_size.h"
#include "tools/ptin/query_options.h"

namespace ptin::tools {

namespace {

struct ExportOptions {
  TerrainOptions terrain;
  RegionOptions region;
  DetailOptions detail;
  std::vector<std::string> pixel_size;
  PixelContentOptions content;
  std::optional<double> nodata;
  std::vector<std::string> creation_options;
  std::string format;
  std::string memory;
  std::string output;
  bool overwrite = false;
};

/// A format: one that writes triangles into a sink, or a raster.
struct ExportFormat {
  const char* name;  ///< As GDAL calls it.
  /// The extension that chooses the format; empty where only --format does.
  const char* extension;
  std::unique_ptr<TinSink> (*make_sink)(const SinkTarget& target);  ///< Null for rasters.
  bool is_cog;
};
constexpr std::array<ExportFormat, 8> kFormats = {
    {{"PLY", ".ply", make_ply_sink, false},
     {"LandXML", ".xml", make_land_xml_sink, false},
     {"DXF", ".dxf", make_dxf_sink, false},
     {"STL", ".stl", make_stl_sink, false},
     {"GPKG", ".gpkg", make_geopackage_sink, false},
     {"FlatGeobuf", ".fgb", make_flatgeobuf_sink, false},
     {"GTiff", ".tif", nullptr, false},
     {"COG", "", nullptr, true}}};

std::string known_formats() {
  std::string known;
  for (const ExportFormat& format : kFormats)
    known.append(known.empty() ? "" : ", ").append(format.name);
  return known;
}

std::string known_extensions() {
  std::string known;
  for (const ExportFormat& format : kFormats) {
    if (*format.extension != 0) known.append(known.empty() ? "" : ", ").append(format.extension);
  }
  return known;
}

const ExportFormat& format_of(const ExportOptions& options) {
  const std::string extension = lower_extension(options.output);
  for (const ExportFormat& format : kFormats) {
    if (options.format.empty() ? (!extension.empty() && (extension == format.extension ||
                                                         (extension == ".tiff" &&
                                                          std::string(".tif") == format.extension)))
                               : lower_case(options.format) == lower_case(format.name)) {
      return format;
    }
  }
  if (!options.format.empty()) {
    throw Error(ErrorCode::invalid_argument, "unknown format; known are " + known_formats(),
                options.format);
  }
  throw Error(
      ErrorCode::invalid_argument,
      "the extension names no format; known are " + known_extensions() + ", or give --format",
      options.output);
}

/// The shares of --memory, in bytes. The rest is for the program itself and the allocator's slack.
struct ExportMemory {
  static constexpr std::uint64_t kProgram = std::uint64_t{16} << 20;
  explicit ExportMemory(std::uint64_t bytes)
      : part((bytes - kProgram) / 2), buffers(bytes / 16), index(bytes / 4) {}
  std::uint64_t part;     ///< One refined part, and the patch made from it.
  std::uint64_t buffers;  ///< For pixels; for GDAL's cache; for the open border: each.
  std::uint64_t index;    ///< A format's index of features, or of blocks.
};

ExportMemory memory_of(const ExportOptions& options) {
  constexpr std::uint64_t kLeast = std::uint64_t{32} << 20;
  const std::uint64_t bytes = memory_limit_of(options.memory, std::uint64_t{1} << 30);
  if (bytes < kLeast)
    throw Error(ErrorCode::invalid_argument, "--memory must be at least 32M", options.memory);
  return ExportMemory(bytes);
}

/// What the options say of pixels and slopes.
PixelContent content_of(const ExportOptions& options, const ExportFormat& format) {
  const bool is_layer =
      format.make_sink == make_geopackage_sink || format.make_sink == make_flatgeobuf_sink;
  return pixel_content_of(options.content, format.make_sink == nullptr, is_layer);
}

void check_options(const ExportOptions& options, const ExportFormat& format) {
  check_detail(options.detail);
  static_cast<void>(pixel_sides_of(options.pixel_size));
  const bool is_raster = format.make_sink == nullptr;
  if (!is_raster &&
      (!options.pixel_size.empty() || options.nodata || !options.creation_options.empty())) {
    throw Error(ErrorCode::invalid_argument,
                "--pixel-size, --nodata and --co are for rasters (.tif)", options.output);
  }
  const PixelContent content = content_of(options, format);
  if (options.nodata && content.value != PixelValue::kHeight) {
    throw Error(ErrorCode::invalid_argument,
                "is for heights; slopes and aspects have -9999 as nodata, hillshades 0",
                "--nodata");
  }
  if (is_raster && !options.region.polygon.empty()) {
    throw Error(ErrorCode::invalid_argument,
                "a raster has a --window; cut it by a polygon with gdalwarp -cutline");
  }
  if (format.make_sink == make_flatgeobuf_sink && lower_extension(options.output) != ".fgb") {
    throw Error(ErrorCode::invalid_argument,
                "GDAL makes a folder of a FlatGeobuf whose name does not end in .fgb; name it so",
                options.output);
  }
  check_output(options.output, options.overwrite);
}

/// The sum of two bounds, rounded up.
double sum_above(double a, double b) {
  return a == 0 || b == 0 ? a + b : std::nextafter(a + b, HUGE_VAL);
}

/// What was made, for the report.
struct Exported {
  std::uint64_t vertices = 0, triangles = 0, cells = 0;
  std::int64_t columns = 0, rows = 0;
  std::array<double, 2> pixel_size{};  ///< Map units.
  Certificate certificate;
  double rounding = 0.0;  ///< Of heights to pixels; rasters only.
};

using Report = std::function<void(double)>;

Exported export_triangles(const PartRefiner& refiner, const ExportFormat& format,
                          const SinkTarget& target, const Report& report) {
  Exported made;
  const std::unique_ptr<TinSink> sink = format.make_sink(target);
  PatchMaker maker(refiner.terrain().store(), refiner.request().region);
  walk_cells(refiner, [&](const GridCell& cell, const RefinedTin& refined, double done) {
    sink->add(maker.make(cell, refined, target.border_bytes));
    ++made.cells;
    report(done);
  });
  maker.finish();
  sink->publish();
  made.vertices = maker.vertices();
  made.triangles = maker.triangles();
  return made;
}

/// The pixels that were asked for.
PixelGrid grid_of(const ExportOptions& options, const StoreFile& store, const CrsFacts& crs) {
  std::optional<Window> window;
  if (const auto region = region_of(options.region, store.facts(), crs.wkt))
    window = std::get<Window>(*region);
  const std::array<double, 2> size = options.pixel_size.empty()
                                         ? own_pixel_size(store)
                                         : pixel_size_of(pixel_sides_of(options.pixel_size), crs,
                                                         middle_of(window, store.facts()));
  return {store.facts(), size, window};
}

Exported export_pixels(const PartRefiner& refiner, const PixelGrid& grid,
                       const RasterTarget& target, const Report& report) {
  Exported made;
  made.rounding = export_raster(refiner, grid, target, report);
  made.columns = grid.columns();
  made.rows = grid.rows();
  const std::array<double, 6> transform = grid.geotransform();
  made.pixel_size = {transform[1], -transform[5]};
  return made;
}

void warn_without_index(const ExportFormat& format, const SinkTarget& target,
                        const Context& context) {
  if (context.quiet || format.make_sink != make_flatgeobuf_sink || flatgeobuf_index_fits(target))
    return;
  std::fprintf(stderr,
               "ptin: warning: %s has no spatial index: it would take more than a quarter of the "
               "memory given; write .gpkg, or give more --memory\n",
               target.path.c_str());
}

Exported export_as(const ExportFormat& format, const ExportOptions& options, const Terrain& terrain,
                   const Context& context) {
  const CrsFacts crs = crs_facts(terrain.store());
  const ExportMemory memory = memory_of(options);
  PartRequest request;
  if (format.make_sink != nullptr)
    request.region = region_of(options.region, terrain.store().facts(), crs.wkt);
  request.detail = detail_of(options.detail);
  request.limits.memory_bytes = memory.part;
  request.limits.stop = context.stop;
  const PixelContent content = content_of(options, format);
  std::optional<PixelGrid> grid;
  if (format.make_sink == nullptr) grid.emplace(grid_of(options, terrain.store(), crs));
  const PartRefiner refiner = terrain.parts(request);

  Progress progress(Progress::style_for(context.quiet, stderr));
  const Report report = [&](double done) {
    constexpr double kSteps = 10'000.0;
    progress.report("exporting", static_cast<std::uint64_t>(done * kSteps), 10'000);
  };
  report(0.0);
  Exported made;
  if (format.make_sink != nullptr) {
    SinkTarget target{
        options.output, options.overwrite, crs,         frame_of(terrain.store().facts(), crs),
        false,          memory.buffers,    memory.index};
    target.slope_in_percent = content.in_percent;
    target.most_triangles = 2 * (refiner.records() + terrain.store().t0().vertices.size());
    made = export_triangles(refiner, format, target, report);
    progress.finish();
    warn_without_index(format, target, context);
    if (made.triangles == 0 && !context.quiet) {
      std::fprintf(stderr, "ptin: warning: the region holds no surface; %s has no triangle\n",
                   options.output.c_str());
    }
  } else {
    const RasterTarget target{
        options.output,
        options.overwrite,
        format.is_cog,
        content,
        options.nodata.value_or(default_nodata(terrain.store().facts(), content.value)),
        options.creation_options,
        crs,
        memory.buffers,
        memory.index};
    made = export_pixels(refiner, *grid, target, report);
  }
  progress.finish();
  made.certificate = refiner.detail().certificate();
  made.certificate.error = sum_above(made.certificate.error, made.rounding);
  made.certificate.deviation = sum_above(made.certificate.deviation, made.rounding);
  return made;
}

bool has_heights(const ExportOptions& options) { return options.content.what == "height"; }

/// Adds to an answer what some outputs alone have, and takes out what they do not: the certificate
/// speaks of heights.
void add_content(nlohmann::json& answer, const ExportOptions& options, const ExportFormat& format,
                 const Terrain& terrain) {
  if (format.make_sink == nullptr) answer["what"] = options.content.what;
  if (options.content.what == "slope") answer["slope_unit"] = slope_unit_of(options.content);
  if (!has_heights(options)) answer["certified_error"] = answer["certified_deviation"] = nullptr;
  if (format.make_sink == make_stl_sink) {
    answer["local_frame"] =
        frame_json(frame_of(terrain.store().facts(), crs_facts(terrain.store())));
  }
}

int run_export(const ExportOptions& options, const Context& context) {
  const ExportFormat& format = format_of(options);
  check_options(options, format);
  const auto start = std::chrono::steady_clock::now();
  const Terrain terrain = open_terrain(options.terrain);
  warn_of_base_error(terrain.store(), options.detail.error, context);
  const Exported made = export_as(format, options, terrain, context);
  const double seconds =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  const Certificate& certificate = made.certificate;
  const std::uint64_t bytes = bytes_of_file(options.output);
  const bool is_raster = format.make_sink == nullptr;
  const StoreFacts& facts = terrain.store().facts();
  if (context.json) {
    nlohmann::json answer = {
        {"output", options.output},
        {"format", format.name},
        {"certified_error", certificate.error},
        {"certified_deviation", certificate.deviation},
        {"border_moved_at_most", border_move_json(terrain.store(), certificate.error)},
        {"exact", certificate.complete && facts.base_error == 0 && made.rounding == 0},
        {"units", units_json(crs_facts(terrain.store()))},
        {"bytes", bytes},
        {"seconds", seconds}};
    if (is_raster) {
      answer["width"] = made.columns;
      answer["height"] = made.rows;
      answer["pixel_size"] = made.pixel_size;
    } else {
      answer["vertices"] = made.vertices;
      answer["triangles"] = made.triangles;
      answer["cells"] = made.cells;
    }
    add_content(answer, options, format, terrain);
    print_json(answer);
  } else if (!context.quiet) {
    const std::string size =
        is_raster ? grouped(static_cast<std::uint64_t>(made.columns)) + " x " +
                        grouped(static_cast<std::uint64_t>(made.rows)) + " pixels of " +
                        short_number(made.pixel_size[0]) + " x " + short_number(made.pixel_size[1])
                  : counted(made.vertices, "vertex", "vertices") + ", " +
                        counted(made.triangles, "triangle") + " in " + counted(made.cells, "cell");
    const bool may_change_class = !facts.free_of_voids && !certificate.complete;
    std::printf("%s: %s, %s, %.2f s; %swithin %s at every sample%s, %s at any point\n",
                options.output.c_str(), size.c_str(), human_bytes(bytes).c_str(), seconds,
                has_heights(options) ? "" : (options.content.what + " of a TIN that is ").c_str(),
                short_number(certificate.error).c_str(),
                may_change_class ? " (but where voids moved)" : "",
                short_number(certificate.deviation).c_str());
    if (format.make_sink == make_stl_sink) {
      std::printf("  frame  %s\n", frame_text(frame_of(facts, crs_facts(terrain.store()))).c_str());
    }
  }
  return kExitDone;
}

}  // namespace

Action declare_export(CLI::App& app, Context& context) {
  const auto options = std::make_shared<ExportOptions>();
  add_terrain_options(app, options->terrain, false);
  add_region_options(app, options->region);
  app.remove_option(app.get_option("--point"));
  add_detail_options(app, options->detail, " (default: the full TIN)",
                     "The TIN of the terrain's N most important vertices");
  app.add_option("-o,--output", options->output,
                 "The file to write; its extension chooses the format: " + known_extensions())
      ->type_name("OUT")
      ->required();
  app.add_option("--format,--of", options->format,
                 "The format: " + known_formats() + " (default: by the extension)")
      ->type_name("NAME");
  app.add_option("--pixel-size", options->pixel_size,
                 "Rasters: the size of a pixel, one number or two, in map units, or over ground as "
                 "90m, 0.1km or 300ft, converted at the middle of the window (default: the source "
                 "raster's)")
      ->expected(1, 2)
      ->type_name("SIZE");
  add_pixel_content_options(app, options->content);
  app.add_option("--nodata", options->nodata,
                 "Rasters of heights: the value where there is no surface (default -9999)")
      ->type_name("V");
  app.add_option("--co", options->creation_options,
                 "Rasters: a creation option of GDAL's driver; may be given several times")
      ->type_name("KEY=VALUE")
      ->allow_extra_args(false);
  app.add_option("--memory", options->memory, "Memory to work in, as 512M or 2G (default 1G)")
      ->type_name("SIZE");
  app.add_flag("--overwrite", options->overwrite, "Replace an existing output");
  return [options, &context] { return run_export(*options, context); };
}

}  // namespace ptin::tools
