// SPDX-License-Identifier: GPL-3.0-or-later
//
// Points, pairs and lines as callers give them: text, or a vector layer.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "engine/geometry/affine.h"
#include "engine/query/questions.h"
#include "tools/ptin/command.h"
#include "tools/region/vector_input.h"

namespace ptin::tools {

/// --columns, --layer and --id: what of an input is meant.
struct InputChoice {
  std::vector<std::string> columns;  ///< Text: names from the left; empty: a header's, or none.
  std::string layer;                 ///< Empty: the only layer that fits.
  std::string id;  ///< Empty: the first column or attribute that is no coordinate.
};
/// Declares --layer and --id beside `source`, the option that names the input, and --columns where
/// an input may be text.
/// @param columns  The names that --columns must have; empty: there is no --columns.
void add_input_options(CLI::App& app, InputChoice& choice, CLI::Option* source,
                       const std::string& columns);

/// What was asked for, in the order of the input.
template <typename T>
struct Asked {
  std::vector<T> all;
  std::vector<std::string> ids;            ///< Ids beside `all`; empty where the input tells none.
  std::optional<Transformed> transformed;  ///< The change of the sides of lines.
};

/// Reads points from text (engine/construct/read/text_rows.h; "-" is standard input) or from a
/// layer, whose points and multipoints are transformed to the terrain's CRS
/// (tools/region/vector_input.h). Names that tell text are those of `build`, and names without
/// extension; with a layer in `choice` none does.
/// @throws Error not_found, io_error; invalid_argument  as TextRows, as for_each_feature(); no
///               finite number where a coordinate belongs; another geometry; a choice that means
///               nothing for the input
[[nodiscard]] Asked<MapPoint> read_points(const std::string& path, const InputChoice& choice,
                                          const TerrainPlane& plane);

/// Reads pairs of points as read_points(): in text x, y and height above ground of the one end,
/// then of the other; in a layer lines from one end to the other, whose heights are in attributes
/// named h1 and h2 (or as columns are), else their z.
/// @throws Error as read_points()
[[nodiscard]] Asked<SightPair> read_pairs(const std::string& path, const InputChoice& choice,
                                          const TerrainPlane& plane);

/// Writes a warning to stderr where an input held nothing, so that the answer is empty. Silent with
/// -q and --json.
/// @param what  Should have been read, as "point".
void warn_of_empty_input(bool is_empty, const std::string& path, const std::string& what,
                         const Context& context);

/// Reads lines from WKT (LINESTRING, MULTILINESTRING), from a file with WKT, or from a layer, which
/// is transformed to the terrain's CRS. Each part of a multi-line is a line of its own.
/// @throws Error not_found, invalid_argument
[[nodiscard]] Asked<std::vector<MapPoint>> read_lines(const std::string& text,
                                                      const InputChoice& choice,
                                                      const TerrainPlane& plane);

}  // namespace ptin::tools
