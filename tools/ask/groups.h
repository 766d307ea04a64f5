// SPDX-License-Identifier: GPL-3.0-or-later
//
// Parameters that several questions have: each group is declared here, and nowhere else.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "engine/query/questions.h"
#include "tools/ask/parameter.h"

namespace ptin::ask {

// Each adds its rows; those of one row return it.

/// `error`.
Parameter& add_error(Parameters& rows, std::optional<double>& error, std::string help);
/// `error` and `vertices`, of which at most one may be given: the level of detail.
/// @param error_more     What an error means to this question, behind the words that hold for all.
/// @param vertices_help  What it asks for.
void add_detail(Parameters& rows, DetailRequest& detail, const std::string& error_more,
                const std::string& vertices_help, Door doors = Door::kBoth);

/// A region as it is given: at most one of these.
struct RegionText {
  std::optional<Window> window;
  std::string polygon;        ///< WKT, or a file that holds it.
  std::vector<double> point;  ///< x, y.

  [[nodiscard]] bool given() const { return window || !polygon.empty() || !point.empty(); }
};
/// --window on the command line; over HTTP `bbox`, in the CRS of the client.
void add_window(Parameters& rows, RegionText& region, Door doors);
/// The same, and --polygon.
void add_region(Parameters& rows, RegionText& region, Door doors);

/// Heights of isolines and of volumes: `level`, or `interval` with `base`.
struct Levels {
  std::vector<double> levels;
  std::optional<double> interval;
  double base = 0.0;

  [[nodiscard]] bool given() const { return !levels.empty() || interval; }
};
/// @param level_help, interval_help  What each asks for here.
void add_levels(Parameters& rows, Levels& levels, const std::string& level_help,
                const std::string& interval_help, Door doors);
/// The heights that were given, or the multiples of the interval, counted from the base, that lie
/// within the heights of the terrain; the next one above where none does.
/// @throws Error as levels_at()
[[nodiscard]] std::vector<double> levels_of(const Levels& levels, const StoreFacts& facts);

/// `curvature`, and on the command line --refraction, of questions that look over the ground
/// (engine/query/sight/curvature.h).
void add_curvature(Parameters& rows, double& coefficient);
/// --by: heights, stars or splits.
void add_by(Parameters& rows, AnswerBy& by);
/// --threads. 0: as many as the process may use.
void add_threads(Parameters& rows, int& threads, std::string help, double most = 1024);
/// --memory. None: the program chooses.
Parameter& add_memory(
    Parameters& rows, std::optional<std::uint64_t>& memory,
    std::string help = "Memory that the answer may take, as 512M or 2G (default 4G)");

/// A format of an answer, as `f` names it.
struct Format {
  std::string_view name;
  std::string_view media;
};
/// `f`. The header Accept chooses where it does not.
void add_format(Parameters& rows, std::string& format, std::span<const Format> formats);
/// A parameter of the service whose text has no effect, or is read by its question.
Parameter& add_text(Parameters& rows, std::string_view name, std::string help,
                    std::string_view example = {});
/// `coords`: positions and shapes of a client as WKT, which the question reads.
Parameter& add_coords(Parameters& rows, std::string help, std::string_view example);
/// `crs`: that of positions which come from a client of the service and go to it.
void add_crs(Parameters& rows);

}  // namespace ptin::ask
