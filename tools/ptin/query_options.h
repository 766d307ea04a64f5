// SPDX-License-Identifier: GPL-3.0-or-later
//
// Options that all questions to a .ptin file share: the file and how it is read, the region, the
// level of detail, levels, memory.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "engine/crs/crs_facts.h"
#include "engine/memory_units.h"
#include "engine/query/questions.h"
#include "tools/ptin/command.h"
#include "tools/ptin/measures.h"
#include "tools/region/on_terrain.h"
#include "tools/region/straight_sides.h"

namespace ptin::tools {

/// FILE, which may lie elsewhere, how it is read, --index and --tmp; and what waits for its units.
struct TerrainOptions {
  std::string file;
  std::string remote_cache;  ///< Text for parse_memory; empty: the default.
  std::string cache_folder;
  std::string index = "packed";
  std::string temporary_folder;
  bool no_mmap = false;
  Measures measures;  ///< Of all options of the subcommand.
};
void add_terrain_options(CLI::App& app, TerrainOptions& options, bool has_index);
/// Opens the terrain, and settles the measures.
/// @throws Error as Terrain::open, open_remote_store and Measures::settle
[[nodiscard]] Terrain open_terrain(const TerrainOptions& options, const Context& context);
/// The same without T0 as a mesh.
[[nodiscard]] std::shared_ptr<const StoreFile> open_store(const TerrainOptions& options,
                                                          const Context& context);

/// --window, --polygon, --point: at most one.
struct RegionOptions {
  std::vector<double> window;
  std::string polygon;
  std::vector<double> point;

  [[nodiscard]] bool given() const { return !window.empty() || !polygon.empty() || !point.empty(); }
};
enum class RegionKinds : std::uint8_t { kWindow, kWithInside, kAll };
/// @param kinds  A window alone, a window or a polygon, or a point too.
void add_region_options(CLI::App& app, RegionOptions& options,
                        RegionKinds kinds = RegionKinds::kAll);
/// A region, and what was done to it where it came from another CRS.
struct AskedRegion {
  std::optional<Region> region;  ///< None: everywhere.
  std::optional<Transformed> transformed;
};
/// The region that was asked for, which meets the box of the terrain's samples.
/// @throws Error as window_of, read_polygon and check_on_terrain
[[nodiscard]] AskedRegion region_of(const RegionOptions& options, const StoreFacts& facts,
                                    const CrsFacts& crs);

/// The object `transformed` of an answer; null where nothing was.
[[nodiscard]] nlohmann::json transformed_json(const std::optional<Transformed>& transformed);
/// Says on stderr what was transformed, and what bound holds. Silent with -q and --json.
/// @param what  "the lines", "the polygon".
void tell_transformed(const std::optional<Transformed>& transformed, const std::string& what,
                      const CrsFacts& crs, const Context& context);

/// Declares --curvature and --refraction, of subcommands that look over the ground (engine/query/sight/curvature.h).
void add_curvature_option(CLI::App& app, double& coefficient);

/// Writes a warning to stderr where all places lie outside of the box of the terrain's samples, with
/// what may have been meant. Silent with -q and --json.
/// @param what  One of them, as "point".
void warn_of_outside(std::span<const MapPoint> places, const std::string& what,
                     const StoreFacts& facts, const CrsFacts& crs, const Context& context);

/// --error and --vertices, of which at most one may be given: the level of detail.
struct DetailOptions {
  std::optional<double> error;
  std::optional<std::uint64_t> vertices;
};
/// @param measures       That wait for the terrain.
/// @param error_help     What --error means for this subcommand; appended to the words that hold
///                       for all.
/// @param vertices_help  What --vertices means for this subcommand.
void add_detail_options(CLI::App& app, Measures& measures, DetailOptions& options,
                        const std::string& error_help, const std::string& vertices_help);
/// Declares --error alone.
CLI::Option* add_error_option(CLI::App& app, Measures& measures, std::optional<double>& error,
                              const std::string& help);
/// Writes a warning to stderr where a terrain has no surface, so that every answer is void, and where
/// the file keeps less detail than --error asks for (`build --max-error`): the answer then certifies
/// what the file keeps. Silent with -q and --json.
/// @throws Error corruption as has_surface()
void warn_of_terrain(const StoreFile& store, const std::optional<double>& error,
                     const Context& context);

/// --level or --interval with --base: the heights of isolines.
struct LevelOptions {
  std::vector<double> levels;
  std::optional<double> interval;
  double base = 0.0;

  [[nodiscard]] bool given() const { return !levels.empty() || interval; }
};
/// @param measures                   That wait for the terrain.
/// @param level_help, interval_help  What each asks for here.
void add_level_options(CLI::App& app, Measures& measures, LevelOptions& options,
                       const std::string& level_help, const std::string& interval_help);
/// The heights that were given, or the multiples of the interval, counted from the base, that lie
/// within the heights of the terrain; the next one above where none does.
/// @throws Error as levels_at()
[[nodiscard]] std::vector<double> levels_of(const LevelOptions& options, const StoreFacts& facts);

/// Declares --memory SIZE.
void add_memory_option(CLI::App& app, std::string& memory);
/// --by: stars or splits.
void add_by_option(CLI::App& app, AnswerBy& by);
/// The bytes that --memory names. Without --memory: `otherwise`, or three quarters of what the
/// process is allowed where that is less.  @throws Error invalid_argument as parse_memory
[[nodiscard]] std::uint64_t memory_limit_of(const std::string& memory,
                                            std::uint64_t otherwise = kMemoryOfQuestion);

/// The level of detail that --error or --vertices asks for.
[[nodiscard]] DetailRequest detail_of(const DetailOptions& options);
/// Memory as memory_limit_of(), and the program's stop token.
[[nodiscard]] QueryLimits limits_of(const std::string& memory, const Context& context);

/// The cost of an answer under the names of tools/API.md, "JSON".
[[nodiscard]] nlohmann::json cost_json(const QueryCost& cost);

/// Prints JSON, indented, and a newline to stdout. Infinite numbers become null.
/// @throws Error as write_to_stdout
void print_json(const nlohmann::json& json);

}  // namespace ptin::tools
