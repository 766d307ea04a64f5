// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/ptin/build_command.h"

#include <optional>

#include <CLI/CLI.hpp>

#include "tools/ptin/build_checks.h"
#include "tools/ptin/query_options.h"

namespace ptin::tools {

namespace {

/// What is read, and what of it.
void add_source_options(CLI::App& app, BuildCommand& command) {
  BuildOptions& options = command.options;
  app.add_option(
      "INPUT", command.inputs,
      "A raster that GDAL reads, several of one grid, or points: LAS, CSV or XYZ text (.gz\n"
      "too), or a layer that OGR reads; several files of one CRS; or a TIN: PLY, OBJ, 2DM, "
      "LandXML");
  app.add_option("--nodata", options.nodata,
                 "This stored value (before scale and offset) means void; overrides the source's")
      ->type_name("V");
  app.add_option("--resolution", options.resolution, "Points, TINs: the grid unit, in CRS units")
      ->check(plain_measure(ask::kPositive, "in CRS units"))
      ->type_name("R");
  app.add_option("--class", options.classes,
                 "LAS: keep points of these classes, such as 2 for ground; 2,9 for several")
      ->delimiter(',')
      ->allow_extra_args(false)
      ->type_name("N");
  app.add_option("--returns", command.returns,
                 "LAS: keep the last return of each pulse (near the ground), the first, or all\n"
                 "(default)")
      ->check(CLI::IsMember({"all", "first", "last"}))
      ->type_name("WHICH");
  app.add_option("--duplicates", command.duplicates,
                 "Points, --repair: the height of those that fall together: mean (default), min, "
                 "max, or\n"
                 "first (of the first input that has one)")
      ->check(CLI::IsMember({"mean", "min", "max", "first"}))
      ->type_name("RULE");
  app.add_option("--layer", options.layer, "Points of this layer, where a file holds several")
      ->type_name("NAME");
  app.add_option("--columns", options.columns,
                 "Text: the names of its columns from the left; x, y, z or as a header may name\n"
                 "them, by any other name columns that are passed over (default: a header's, else "
                 "x y z)")
      ->delimiter(',')
      ->type_name("NAME");
  app.add_flag("--skip-invalid", options.skip_invalid,
               "Text: pass over rows that are no points, and say how many there are (default: the "
               "first\n"
               "one is refused)");
  app.add_option("--z-field", options.z_field,
                 "The attribute that holds the height of a layer's points (default: their z)")
      ->type_name("NAME");
  app.add_flag("--repair", options.repair,
               "TINs: leave the triangles and triangulate the vertices anew; voids by --max-edge");
  app.add_option("--max-edge", options.max_edge,
                 "Points, --repair: triangles with an edge longer than this become void; CRS "
                 "units, or metres\n"
                 "where those are degrees")
      ->check(plain_measure(ask::kPositive, "in CRS units, or metres where those are degrees"))
      ->type_name("L");
  app.add_option("--breaklines", options.breaklines,
                 "Points, --repair: lines that become edges of the TIN, from layers that OGR reads "
                 "or\n"
                 "LandXML; without heights they are laid on the surface; several files, behind "
                 "INPUT")
      ->type_name("FILE");
  app.add_option("--breakline-layer", options.breakline_layer,
                 "Breaklines of this layer, where a file holds several")
      ->type_name("NAME");
  app.add_option("--boundary", options.boundary,
                 "Points, --repair: polygons outside of which all is void, from a layer that OGR "
                 "reads or\n"
                 "LandXML; without heights they are laid on the surface")
      ->type_name("FILE");
  app.add_option("--boundary-layer", options.boundary_layer,
                 "The boundary is this layer, where its file holds several")
      ->type_name("NAME");
  app.add_option("--bbox", command.bbox, "Leave out samples outside of this box, in CRS units")
      ->expected(4)
      ->check(numbers(ask::kFinite, "in CRS units"))
      ->type_name("XMIN YMIN XMAX YMAX");
  app.add_option("--a-srs,--a_srs", options.a_srs,
                 "The CRS; overrides the source's (EPSG code, WKT, PROJ string)")
      ->type_name("CRS");
  app.add_option("--vertical-crs", options.vertical_crs, "The vertical CRS, as EPSG:5773")
      ->type_name("CRS");
}

/// The work: its tiles, memory, threads and temporary files, and whether it goes on.
void add_work_options(CLI::App& app, BuildCommand& command) {
  app.add_option(
         "--tile", command.options.tile,
         "Samples along a leaf of the tile hierarchy, of points and TINs about as many (default:\n"
         "by the number of samples)")
      ->type_name("SIDE");
  app.add_option("--memory", command.memory,
                 "Hard limit on the memory of the process, as 512M or 2G (default: 1G, or less\n"
                 "where a cgroup or a resource limit allows less)")
      ->type_name("SIZE");
  app.add_option(
         "--threads", command.threads,
         "Threads (default: one a processor that affinity and cgroups leave this process);\n"
         "fewer are used where memory is short. The output is the same for any number")
      ->check(CLI::Range(1, 1024))
      ->type_name("N");
  app.add_option("--tmp", command.tmp, "Folder for temporary files (default: beside the output)")
      ->check(CLI::ExistingDirectory)
      ->type_name("DIR");
  auto* resume = app.add_flag("--resume", command.resume, "Go on with an interrupted build");
  app.add_flag("--discard", command.discard,
               "Remove an interrupted build first; without INPUT, only that")
      ->excludes(resume);
  app.add_flag("--dry-run", command.dry_run, "Say what the build would need, and stop");
  app.add_option("--progress-fd", command.progress_fd,
                 "Write progress as lines of JSON to this file descriptor")
      ->check(numbers(ask::kNotNegative, ""))
      ->type_name("FD");
  auto* parts = app.add_option("--parts", command.parts,
                               "Read the source and divide the rest into this many jobs of a batch "
                               "system, which\n"
                               "`ptin build-part` does")
                    ->check(CLI::Range(1, 1 << 20))
                    ->type_name("N");
  auto* plan = app.add_option("--plan", command.plan, "With --parts: the plan to write for them")
                   ->needs(parts)
                   ->type_name("FILE");
  parts->needs(plan);
}

CostModel cost_of(const std::string& name) {
  if (name == "roi") return CostModel::kRoi;
  return name == "elevation" ? CostModel::kElevation : CostModel::kError;
}

std::optional<PointMerge> merge_of(const std::string& name) {
  if (name.empty()) return std::nullopt;
  if (name == "min") return PointMerge::kLowest;
  if (name == "max") return PointMerge::kHighest;
  return name == "first" ? PointMerge::kFirst : PointMerge::kMean;
}

ReturnChoice returns_of(const std::string& name) {
  if (name == "first") return ReturnChoice::kFirst;
  return name == "last" ? ReturnChoice::kLast : ReturnChoice::kAll;
}

}  // namespace

void complete_options(BuildCommand& command) {
  BuildOptions& options = command.options;
  options.cost = cost_of(command.cost);
  options.duplicates = merge_of(command.duplicates);
  options.returns = returns_of(command.returns);
  if (!command.bbox.empty())
    options.bbox = {command.bbox[0], command.bbox[1], command.bbox[2], command.bbox[3]};
}

void declare_build_options(CLI::App& app, BuildCommand& command) {
  BuildOptions& options = command.options;
  add_source_options(app, command);
  app.add_option("-o,--output", command.output, "The .ptin file to write")
      ->type_name("FILE")
      ->required();
  app.add_option("--cost", command.cost,
                 "In which order vertices go: error (default, for levels of detail), roi (point\n"
                 "location) or elevation (isolines)")
      ->check(CLI::IsMember({"error", "roi", "elevation"}));
  app.add_option("--max-error", options.max_error,
                 "Leave out detail below this error, in the height's unit")
      ->check(plain_measure(ask::kNotNegative, "in the height's unit"))
      ->type_name("E");
  app.add_option(
         "--void-slope", options.void_slope,
         "Error charged for each ground unit that the border of a void moves: at an error E it\n"
         "moves by E / S at most")
      ->check(numbers(ask::kNotNegative, ""))
      ->type_name("S")
      ->capture_default_str();
  add_work_options(app, command);
  app.add_flag("--overwrite", command.overwrite, "Replace an existing output");
}

}  // namespace ptin::tools
