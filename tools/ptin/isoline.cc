// SPDX-License-Identifier: GPL-3.0-or-later
//
// ptin isoline: isolines as a vector layer, by gdal_contour's conventions.
#include "engine/query/isoline.h"

#include <cmath>
#include <cstdio>
#include <filesystem>
#include <memory>

#include "tools/error_status.h"
#include "tools/formats/vector_file.h"
#include "tools/output_file.h"
#include "tools/ptin/crs_facts.h"
#include "tools/ptin/human.h"
#include "tools/ptin/query_options.h"

namespace ptin::tools {

namespace {

struct IsolineOptions {
  TerrainOptions terrain;
  RegionOptions region;
  std::vector<double> levels;
  std::optional<double> interval;
  double base = 0.0;
  std::optional<double> error;
  bool z = false;
  std::uint64_t max_lines = IsolineRequest{}.most_lines;
  std::string memory, output;
  bool overwrite = false;
};

void check_options(const IsolineOptions& options, const Context& context) {
  if (options.levels.empty() != options.interval.has_value()) {
    throw Error(ErrorCode::invalid_argument,
                "the levels are given by --level H... or by --interval D; give one of them");
  }
  if (options.error && !(*options.error >= 0)) {
    throw Error(ErrorCode::invalid_argument, "--error must be a number >= 0, in the height's unit");
  }
  static_cast<void>(vector_format_of(options.output));
  if (options.output != "-") {
    check_output(options.output, options.overwrite);
  } else if (context.json) {
    throw Error(ErrorCode::invalid_argument,
                "--json and -o - both write to stdout; give the isolines a file name");
  }
}

std::string folder_for_temporaries(const IsolineOptions& options) {
  if (!options.terrain.temporary_folder.empty()) return options.terrain.temporary_folder;
  if (options.output == "-") return std::filesystem::temp_directory_path().string();
  const auto folder = std::filesystem::path(options.output).parent_path();
  return folder.empty() ? "." : folder.string();
}

std::vector<double> levels_of(const IsolineOptions& options, const StoreFacts& facts) {
  if (!options.interval) return options.levels;
  return levels_at(*options.interval, options.base, facts.min_height, facts.max_height);
}

struct Written {
  std::uint64_t features = 0, rings = 0, points = 0;
};

Written write_lines(const Isolines& lines, const IsolineOptions& options, const std::string& wkt,
                    const Context& context) {
  VectorFile file(
      options.output, options.overwrite,
      {"contour",
       options.z ? wkbLineString25D : wkbLineString,
       {{"ID", VectorFile::FieldType::kInteger}, {"elev", VectorFile::FieldType::kReal}},
       wkt});
  Written written;
  std::vector<MapPoint> points;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    if (i % 1024 == 0 && context.stop.stop_requested()) {
      throw Error(ErrorCode::cancelled, "cancelled while writing", options.output);
    }
    const Isoline line = lines.line(i, points);
    const double elevation = lines.levels()[line.level];
    const VectorFile::Value values[] = {static_cast<std::int64_t>(i), elevation};
    file.add(line_geometry(line.points, options.z ? &elevation : nullptr), values);
    ++written.features;
    written.rings += line.ring ? 1 : 0;
    written.points += line.points.size();
  }
  file.publish();
  return written;
}

void report(const IsolineOptions& options, const Isolines& lines, const Written& written,
            const CrsFacts& crs, const Context& context) {
  if (context.json) {
    print_json({{"output", options.output},
                {"levels", lines.levels()},
                {"lines", written.features},
                {"rings", written.rings},
                {"points", written.points},
                {"crossed",
                 {{"triangles", lines.crossed.triangles},
                  {"vertices", lines.crossed.vertices},
                  {"segments", lines.crossed.segments}}},
                {"tiles", lines.tiles},
                {"certified_error", lines.certified_error},
                {"certified_deviation", lines.certified_deviation},
                {"exact", lines.exact},
                {"units", {{"horizontal", crs.horizontal_unit}, {"height", crs.vertical_unit}}},
                {"cost", cost_json(lines.cost)}});
  } else if (!context.quiet && options.output != "-") {
    std::printf("%s: %s isolines (%s closed) at %zu levels, %s points; certified %s%s\n",
                options.output.c_str(), grouped(written.features).c_str(),
                grouped(written.rings).c_str(), lines.levels().size(),
                grouped(written.points).c_str(), short_number(lines.certified_error).c_str(),
                lines.exact ? "; exact" : "");
  }
}

int run_isoline(const IsolineOptions& options, const Context& context) {
  check_options(options, context);
  const ProgressiveTin terrain = open_terrain(options.terrain);
  const CrsFacts crs = crs_facts(terrain.store());
  IsolineRequest request;
  request.levels = levels_of(options, terrain.store().facts());
  if (request.levels.empty()) {
    throw Error(
        ErrorCode::invalid_argument,
        "no multiple of the interval lies within the heights of the terrain; give a smaller "
        "--interval, or --base",
        options.terrain.file);
  }
  if (const auto region = region_of(options.region, crs.wkt)) {
    request.window = std::get<Window>(*region);
  }
  request.tolerance = options.error;
  request.most_lines = options.max_lines;
  if (!options.memory.empty()) request.memory_limit_bytes = parse_bytes(options.memory);
  request.temporary_folder = folder_for_temporaries(options);
  request.stop = context.stop;
  const Isolines lines = isolines(terrain, request);
  const Written written = write_lines(lines, options, crs.wkt, context);
  if (written.features == 0 && !context.quiet) {
    std::fprintf(stderr, "ptin: warning: no surface crosses these levels; the layer is empty\n");
  }
  report(options, lines, written, crs, context);
  return kExitDone;
}

}  // namespace

Action declare_isoline(CLI::App& app, Context& context) {
  const auto options = std::make_shared<IsolineOptions>();
  add_terrain_options(app, options->terrain, true);
  auto* level = app.add_option("--level,--fl", options->levels, "Heights, in the height's unit")
                    ->type_name("H...");
  auto* interval =
      app.add_option("-i,--interval", options->interval, "Every multiple of D, from the base")
          ->type_name("D")
          ->excludes(level);
  app.add_option("--base,--off", options->base, "Where the intervals are counted from (default 0)")
      ->type_name("B")
      ->needs(interval);
  add_region_options(app, options->region, true);
  app.add_option("--error", options->error, "Certified error allowed, in the height's unit")
      ->type_name("E");
  app.add_flag("--3d", options->z, "Points carry the height of their line");
  app.add_option("-o,--output", options->output,
                 "The layer to write; its extension chooses the format: " +
                     known_vector_extensions() + "; - is GeoJSON on stdout")
      ->type_name("OUT")
      ->required();
  app.add_option("--max-lines", options->max_lines,
                 "Refuse, before anything is written, when there are more lines")
      ->type_name("N")
      ->capture_default_str();
  app.add_option("--memory", options->memory,
                 "Memory for the extraction, as 512M or 2G (default 4G); what does not fit goes to "
                 "--tmp (default: OUT's folder)")
      ->type_name("SIZE");
  app.add_flag("--overwrite", options->overwrite, "Replace an existing output");
  add_common_options(app, context, true);
  return [options, &context] { return run_isoline(*options, context); };
}

}  // namespace ptin::tools
