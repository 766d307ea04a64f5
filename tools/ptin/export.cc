// SPDX-License-Identifier: GPL-3.0-or-later
//
// ptin export: the TIN at any level of detail, larger than memory too.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <memory>

#include <nlohmann/json.hpp>

#include "engine/crs/border_move.h"
#include "engine/crs/crs_facts.h"
#include "engine/memory_units.h"
#include "engine/query/questions.h"
#include "storage/file/file_questions.h"
#include "tools/error_status.h"
#include "tools/export/pixel_grid.h"
#include "tools/export/raster_export.h"
#include "tools/export/source_export.h"
#include "tools/export/tin_sink.h"
#include "tools/facts/answers.h"
#include "tools/facts/human.h"
#include "tools/output/file_name.h"
#include "tools/output/output_file.h"
#include "tools/progress.h"
#include "tools/ptin/export_report.h"
#include "tools/ptin/model_options.h"
#include "tools/ptin/pixel_content.h"
#include "tools/ptin/pixel_size.h"
#include "tools/ptin/query_options.h"
#include "tools/ptin/source_counts.h"
#include "tools/region/mesh_crs.h"

namespace ptin::tools {

namespace {

struct ExportOptions {
  TerrainOptions terrain;
  ask::RegionText region;
  DetailRequest detail;
  ModelOptions model;
  bool source = false;
  std::vector<std::string> pixel_size;
  std::string type;
  PixelContentOptions content;
  std::optional<double> nodata;
  std::vector<std::string> creation_options;
  std::string format;
  std::optional<std::uint64_t> memory;
  OutputOptions out;
};

/// A format: one that writes triangles into a sink, or a raster.
struct ExportFormat {
  const char* name;  ///< As GDAL calls it.
  /// The extension that chooses the format; empty where only --format does.
  const char* extension;
  std::unique_ptr<TinSink> (*make_sink)(const SinkTarget& target);  ///< Null for rasters.
  bool is_cog;
};
constexpr std::array<ExportFormat, 10> kFormats = {
    {{"PLY", ".ply", make_ply_sink, false},
     {"OBJ", ".obj", make_obj_sink, false},
     {"2DM", ".2dm", make_two_dm_sink, false},
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
  const std::string extension = lower_extension(options.out.output);
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
  if (extension == ".glb" && options.format.empty()) {
    throw Error(
        ErrorCode::invalid_argument,
        "a GLB is written from a whole mesh, which `ptin refine` does; export writes meshes "
        "of any size, as " +
            known_extensions(),
        options.out.output);
  }
  throw Error(
      ErrorCode::invalid_argument,
      "the extension names no format; known are " + known_extensions() + ", or give --format",
      options.out.output);
}

/// The shares of --memory, in bytes. The rest is for the program itself and the allocator's slack.
struct ExportMemory {
  static constexpr std::uint64_t kProgram = std::uint64_t{16} << 20;
  explicit ExportMemory(std::uint64_t bytes)
      : part((bytes - kProgram) / 2), buffers(bytes / 16), index(bytes / 4) {}
  std::uint64_t part;     ///< One part, and the patch made from it.
  std::uint64_t buffers;  ///< For pixels; for GDAL's cache; for the open border: each.
  std::uint64_t index;    ///< A format's index of features, or of blocks.
};

ExportMemory memory_of(const ExportOptions& options) {
  constexpr std::uint64_t kLeast = std::uint64_t{32} << 20;
  const std::uint64_t bytes = memory_limit_of(options.memory, kMemoryOfParts);
  if (bytes < kLeast) refuse("must be at least 32M", "--memory");
  return ExportMemory(bytes);
}

/// What the options say of pixels and slopes.
PixelContent content_of(const ExportOptions& options, const ExportFormat& format) {
  const bool is_layer =
      format.make_sink == make_geopackage_sink || format.make_sink == make_flatgeobuf_sink;
  return pixel_content_of(options.content, format.make_sink == nullptr, is_layer);
}

/// Refuses what --source leaves no choice of.
void check_source(const ExportOptions& options, bool is_raster) {
  if (!options.source) return;
  if (!is_raster) refuse("is for rasters: name the output .tif", "--source");
  const bool has_choice = options.region.given() || options.detail.tolerance ||
                          options.detail.vertices || !options.pixel_size.empty() ||
                          options.content.what != "height" || options.nodata ||
                          !options.type.empty();
  if (has_choice) {
    refuse(
        "writes the whole raster as it was: leave the region, the level of detail, --pixel-size, "
        "--what, --type and --nodata out",
        "--source");
  }
}

void check_options(const ExportOptions& options, const ExportFormat& format) {
  static_cast<void>(pixel_sides_of(options.pixel_size));
  const bool is_raster = format.make_sink == nullptr;
  if (!is_raster &&
      (!options.pixel_size.empty() || options.nodata || !options.creation_options.empty())) {
    throw Error(ErrorCode::invalid_argument,
                "--pixel-size, --nodata and --co are for rasters (.tif)", options.out.output);
  }
  const PixelContent content = content_of(options, format);
  if (options.nodata && content.value != PixelValue::kHeight) {
    throw Error(ErrorCode::invalid_argument,
                "is for heights; slopes and aspects have -9999 as nodata, hillshades 0",
                "--nodata");
  }
  check_source(options, is_raster);
  if (!options.type.empty() && (!is_raster || content.value != PixelValue::kHeight)) {
    throw Error(ErrorCode::invalid_argument, "is for rasters of heights (.tif)", "--type");
  }
  if (is_raster && !options.region.polygon.empty()) {
    throw Error(ErrorCode::invalid_argument,
                "a raster has a --window; cut it by a polygon with gdalwarp -cutline");
  }
  if (format.make_sink == make_flatgeobuf_sink && lower_extension(options.out.output) != ".fgb") {
    throw Error(ErrorCode::invalid_argument,
                "GDAL makes a folder of a FlatGeobuf whose name does not end in .fgb; name it so",
                options.out.output);
  }
  check_model(options.model, options.out.output);
  check_output(options.out.output, options.out.overwrite);
}

/// The sum of two bounds, rounded up.
double sum_above(double a, double b) {
  return a == 0 || b == 0 ? a + b : std::nextafter(a + b, HUGE_VAL);
}

using Report = std::function<void(double)>;

Exported export_triangles(TinParts& parts, const ExportFormat& format, const SinkTarget& target,
                          const Report& report) {
  Exported made;
  const std::unique_ptr<TinSink> sink = format.make_sink(target);
  PatchMaker maker(parts.terrain().store(), parts.request().region);
  walk_cells(parts, [&](const GridCell& cell, const Tin& part, double done) {
    sink->add(maker.make(cell, part, target.border_bytes));
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
RasterRequest pixels_of(const ExportOptions& options, const std::optional<Region>& region,
                        const StoreFile& store, const CrsFacts& crs, const Context& context) {
  std::optional<Window> window;
  if (region) window = std::get<Window>(*region);
  const std::array<double, 2> size = options.pixel_size.empty()
                                         ? own_pixel_size(store)
                                         : pixel_size_of(pixel_sides_of(options.pixel_size), crs,
                                                         middle_of(window, store.facts()));
  RasterRequest request = pixels_in(window, size, store.facts());
  request.detail = options.detail;
  request.limits.memory_bytes = memory_of(options).part;
  request.limits.stop = context.stop;
  return request;
}

Exported export_pixels(const Terrain& terrain, const RasterRequest& request,
                       const RasterTarget& target, const Report& report) {
  Exported made;
  const WrittenRaster written = export_raster(terrain, request, target, report);
  made.rounding = written.rounding;
  made.surface_pixels = written.surface_pixels;
  made.columns = request.pixels.width;
  made.rows = request.pixels.height;
  made.pixel_size = {request.lattice.step_x, -request.lattice.step_y};
  return made;
}

/// The samples of what was exported that the level of detail moved across the border of voids.
/// None where nothing bounds how far the border moved, or the ground around it does not fit the memory.
std::optional<ClassChanges> changes_of(const TinParts& parts, const ExportOptions& options,
                                       const std::optional<Region>& region) {
  const StoreFile& store = parts.terrain().store();
  ClassChangesRequest request;
  request.region = region;
  request.detail = options.detail;
  request.reach = border_reach(store, parts.detail().certificate().error);
  request.limits = parts.request().limits;
  if (!std::isfinite(request.reach[0]) || !std::isfinite(request.reach[1])) return std::nullopt;
  try {
    return class_changes(parts.terrain(), request);
  } catch (const Error& e) {
    if (e.code() == ErrorCode::resource_exhausted) return std::nullopt;
    throw;
  }
}

PartRequest request_of(const ExportOptions& options, const ExportFormat& format,
                       const std::optional<Region>& region, const Context& context) {
  PartRequest request;
  if (format.make_sink != nullptr) request.region = region;
  request.detail = options.detail;
  request.limits.memory_bytes = memory_of(options).part;
  request.limits.stop = context.stop;
  return request;
}

SinkTarget sink_target(const ExportFormat& format, const ExportOptions& options,
                       const TinParts& parts) {
  const StoreFile& store = parts.terrain().store();
  const CrsFacts crs = crs_facts(store);
  const ExportMemory memory = memory_of(options);
  LocalFrame frame = frame_of(store.facts(), crs);
  apply_model(options.model, options.out.output, frame.scale);
  return {options.out.output,
          options.out.overwrite,
          crs,
          frame,
          options.model.base,
          content_of(options, format).in_percent,
          memory.buffers,
          memory.index,
          parts.triangles()};
}

void warn_of_triangles(const Exported& made, const ExportFormat& format, const SinkTarget& target) {
  if (format.make_sink == make_flatgeobuf_sink && !flatgeobuf_index_fits(target)) {
    std::fprintf(stderr,
                 "ptin: warning: %s has no spatial index: it would take more than a quarter of the "
                 "memory given; write .gpkg, or give more --memory\n",
                 target.path.c_str());
  }
  if (made.triangles == 0) {
    std::fprintf(stderr, "ptin: warning: the region holds no surface; %s has no triangle\n",
                 target.path.c_str());
  }
}

/// Refuses a nodata value that pixels of a type cannot have, and one of no choice that may be a height.
void check_nodata(double nodata, bool is_given, GDALDataType type, const StoreFacts& facts) {
  if (!GDALDataTypeIsInteger(type)) return;
  const std::string name = GDALGetDataTypeName(type);
  if (is_given && GDALAdjustValueToDataType(type, nodata, nullptr, nullptr) != nodata) {
    refuse(
        "no " + name + " is " + short_number(nodata) + ": pixels without surface would be heights",
        "--nodata");
  }
  if (!is_given && may_be_pixel(facts, nodata, type)) {
    refuse("the heights take up all of " + name +
               ": give --nodata a number that is none, or another type",
           "--type");
  }
}

RasterTarget raster_target(const ExportFormat& format, const ExportOptions& options,
                           const StoreFile& store) {
  const ExportMemory memory = memory_of(options);
  const PixelContent content = content_of(options, format);
  std::optional<GDALDataType> type;
  if (!options.type.empty()) type = GDALGetDataTypeByName(options.type.c_str());
  const double nodata = options.nodata.value_or(default_nodata(store.facts(), content.value, type));
  if (type) check_nodata(nodata, options.nodata.has_value(), *type, store.facts());
  return {options.out.output,       options.out.overwrite, format.is_cog,  content,      nodata,
          options.creation_options, crs_facts(store),      memory.buffers, memory.index, type};
}

Exported export_as(const ExportFormat& format, const ExportOptions& options, const Terrain& terrain,
                   const Context& context) {
  const StoreFile& store = terrain.store();
  const CrsFacts crs = crs_facts(store);
  const AskedRegion asked = region_of(options.region, store.facts(), crs, context);
  const bool is_raster = format.make_sink == nullptr;
  std::optional<RasterRequest> pixels;
  if (is_raster) pixels = pixels_of(options, asked.region, store, crs, context);
  TinParts parts = terrain.parts(request_of(options, format, asked.region, context));
  Progress progress(Progress::style_for(context.quiet, stderr));
  const Report report = [&](double done) {
    constexpr double kSteps = 10'000.0;
    progress.report("exporting", static_cast<std::uint64_t>(done * kSteps), 10'000);
  };
  report(0.0);
  // Before anything is published: what may fail for want of memory must leave nothing behind.
  const std::optional<ClassChanges> changes = changes_of(parts, options, asked.region);
  const std::uint64_t lone_samples = source_count(store, "lone_samples");
  Exported made;
  if (is_raster) {
    made = export_pixels(terrain, *pixels, raster_target(format, options, store), report);
    progress.finish();
    if (!context.quiet && made.surface_pixels == 0 && has_surface(store)) {
      std::fprintf(stderr,
                   "ptin: warning: no pixel's centre lies on surface; %s has nodata alone, so ask "
                   "for another --window\n",
                   options.out.output.c_str());
    }
  } else {
    const SinkTarget target = sink_target(format, options, parts);
    made = export_triangles(parts, format, target, report);
    progress.finish();
    if (!context.quiet) warn_of_triangles(made, format, target);
    if (format.make_sink == make_stl_sink) made.frame = target.frame;
  }
  made.output = options.out.output;
  made.format = format.name;
  made.transformed = asked.transformed;
  made.is_raster = is_raster;
  made.what = options.content.what;
  if (made.what == "slope") made.slope_unit = slope_unit_of(options.content);
  made.changes = changes;
  made.certificate = parts.detail().certificate();
  made.certificate.error = sum_above(made.certificate.error, made.rounding);
  made.certificate.deviation = sum_above(made.certificate.deviation, made.rounding);
  made.bytes = bytes_of_file(options.out.output);
  made.lone_samples = lone_samples;
  return made;
}

/// Writes the source raster.
Exported export_source_as(const ExportFormat& format, const ExportOptions& options,
                          const Terrain& terrain, const Context& context) {
  const RasterTarget target = raster_target(format, options, terrain.store());
  const SourceRaster source = source_raster_of(terrain, target.crs);
  Progress progress(Progress::style_for(context.quiet, stderr));
  export_source(
      terrain, source, target,
      [&](double done) {
        progress.report("exporting", static_cast<std::uint64_t>(done * 10'000.0), 10'000);
      },
      context.stop);
  progress.finish();
  const StoreFacts& facts = terrain.store().facts();
  Exported made;
  made.output = options.out.output;
  made.format = format.name;
  made.is_raster = made.is_source = true;
  made.columns = source.form.width;
  made.rows = source.form.height;
  made.pixel_size = {facts.map.step_x, facts.map.step_y};
  made.surface_pixels = facts.source_samples;
  made.certificate = certify_below(terrain.store(), -1.0);
  made.changes.emplace();
  made.bytes = bytes_of_file(options.out.output);
  return made;
}

int run_export(const ExportOptions& options, const Context& context) {
  const ExportFormat& format = format_of(options);
  check_options(options, format);
  const auto start = std::chrono::steady_clock::now();
  const Terrain terrain = open_terrain(options.terrain, options.detail.tolerance, context);
  Exported made = options.source ? export_source_as(format, options, terrain, context)
                                 : export_as(format, options, terrain, context);
  made.seconds = seconds_since(start);
  if (context.json) {
    print_json_of(made, terrain.store());
  } else if (!context.quiet) {
    print_exported(made, terrain.store().facts());
  }
  return kExitDone;
}

void add_question(ask::Parameters& rows, ExportOptions& options) {
  add_terrain(rows, options.terrain, false);
  ask::add_region(rows, options.region, ask::Door::kProgram);
  ask::add_detail(rows, options.detail, "; without it the full TIN",
                  "The TIN of the terrain's N most important vertices");
  add_output(rows, options.out,
             "The file to write; its extension chooses the format: " + known_extensions());
  rows.add("format", &options.format, "NAME",
           "The format: " + known_formats() + " (default: by the extension)")
      .spelled("--format,--of");
  rows.add("source", &options.source, "",
           "Rasters: the raster that the terrain was built from, bit for bit, lone samples too; "
           "refused where something of it was not kept");
  rows.add("pixel-size", &options.pixel_size, "SIZE",
           "Rasters: the size of a pixel, one number or two, in map units, or over ground as 90m, "
           "0.1km or 300ft, converted at the middle of the window (default: the source raster's)")
      .values(1, 2);
  add_pixel_content(rows, options.content);
  add_model(rows, options.model);
  rows.add(
          "type", &options.type, "TYPE",
          "Rasters of heights: the type of pixels, to which heights are rounded (default: Float32, "
          "or Float64 where that does not hold the heights of vertices)")
      .of({"Int16", "Int32", "Float32", "Float64"});
  rows.add("nodata", &options.nodata, "V",
           "Rasters of heights: the value where there is no surface, which no height is (default "
           "-9999)")
      .within(NumberRange::kAny);
  rows.add("co", &options.creation_options, "KEY=VALUE",
           "Rasters: a creation option of GDAL's driver; may be given several times")
      .repeated();
  ask::add_memory(rows, options.memory, "Memory to work in, as 512M or 2G (default 1G)");
}

}  // namespace

Declared declare_export(Context& context) { return declared<ExportOptions>(context, run_export); }

}  // namespace ptin::tools
