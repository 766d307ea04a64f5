// SPDX-License-Identifier: GPL-3.0-or-later
//
// Options that all questions to a .ptin file share: the file and how it is read, the region, the
// level of detail.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "engine/query/progressive_tin.h"
#include "tools/ptin/command.h"

namespace ptin::tools {

/// FILE, --no-mmap, --index and --tmp.
struct TerrainOptions {
  std::string file;
  std::string index = "packed";
  std::string temporary_folder;
  bool no_mmap = false;
};
void add_terrain_options(CLI::App& app, TerrainOptions& options, bool has_index);
/// @throws Error as ProgressiveTin::open
[[nodiscard]] ProgressiveTin open_terrain(const TerrainOptions& options);

/// --window, --polygon, --point: at most one.
struct RegionOptions {
  std::vector<double> window;
  std::string polygon;
  std::vector<double> point;

  [[nodiscard]] bool given() const { return !window.empty() || !polygon.empty() || !point.empty(); }
};
void add_region_options(CLI::App& app, RegionOptions& options, bool window_only = false);
/// @throws Error as read_polygon; invalid_argument when a number is not finite or the window is
/// inverted
[[nodiscard]] std::optional<Region> region_of(const RegionOptions& options,
                                              const std::string& crs_wkt);

/// --curvature, of whatever looks over the ground (engine/query/curvature.h).
void add_curvature_option(CLI::App& app, double& coefficient);

/// The cost of an answer under the names of DESIGN.md, section 8.
[[nodiscard]] nlohmann::json cost_json(const QueryCost& cost);

/// Prints JSON, indented, and a newline to stdout. Infinite numbers become null.
void print_json(const nlohmann::json& json);

}  // namespace ptin::tools
