// SPDX-License-Identifier: GPL-3.0-or-later
//
// What all questions of the command line share: the file and how it is read, outputs, memory, and
// what is told of a question and its answer.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "engine/crs/crs_facts.h"
#include "engine/memory_units.h"
#include "engine/query/questions.h"
#include "tools/ask/answer_facts.h"
#include "tools/ask/groups.h"
#include "tools/ptin/command.h"
#include "tools/region/on_terrain.h"
#include "tools/region/straight_sides.h"

namespace ptin::tools {

/// FILE, which may lie elsewhere, how it is read, --index and --tmp.
struct TerrainOptions {
  std::string file;
  std::optional<std::uint64_t> remote_cache;  ///< Bytes.
  std::string cache_folder;
  std::string index = "packed";
  std::string temporary_folder;
  bool no_mmap = false;
};
/// @param tmp_help  Of --tmp beside --index; empty: that of the index alone.
void add_terrain(ask::Parameters& rows, TerrainOptions& options, bool has_index,
                 const std::string& tmp_help = {});
/// Opens the terrain, and turns what was given with a unit into its units. Warns on stderr, but with -q
/// and --json, where it has no surface, so that every answer is void, and where the file keeps less
/// detail than the error asks for (`build --max-error`): the answer then certifies what the file keeps.
/// @param error  The allowed one.
/// @throws Error as Terrain::open, open_remote_store, ask::Reading::settle and has_surface()
[[nodiscard]] Terrain open_terrain(const TerrainOptions& options,
                                   const std::optional<double>& error, const Context& context);
/// Opens the file alone.
[[nodiscard]] std::shared_ptr<const StoreFile> open_store(const TerrainOptions& options,
                                                          const Context& context);

/// -o and --overwrite.
struct OutputOptions {
  std::string output;
  bool overwrite = false;
};
void add_output(ask::Parameters& rows, OutputOptions& options, std::string help,
                bool is_required = true, std::string_view metavar = "OUT");

/// Looks at an output before the work: it must not be there, or may be replaced; - is stdout, which
/// --json would write to, too.
/// @param what  "the stream".
/// @throws Error as check_output()
void check_file_or_stdout(const OutputOptions& out, const std::string& what, bool json);

/// A region, and what was done to it where it came from another CRS.
struct AskedRegion {
  std::optional<Region> region;  ///< None: everywhere.
  std::optional<Transformed> transformed;
};
/// The region that was asked for, which meets the box of the terrain's samples. Tells what was
/// transformed.
/// @throws Error as read_polygon and check_on_terrain
[[nodiscard]] AskedRegion region_of(const ask::RegionText& text, const StoreFacts& facts,
                                    const CrsFacts& crs, const Context& context);

/// Warns where a layer that is GeoJSON loses the CRS, which GeoJSON names by a code or not at all.
/// Silent with -q and --json.
void warn_of_unnamed_crs(const OutputOptions& out, const CrsFacts& crs, const Context& context);

/// Says on stderr what was transformed, and what bound holds. Silent with -q and --json.
/// @param what  "the lines", "the polygon".
void tell_transformed(const std::optional<Transformed>& transformed, const std::string& what,
                      const CrsFacts& crs, const Context& context);

/// Writes a warning to stderr where all places lie outside of the box of the terrain's samples, with
/// what may have been meant. Silent with -q and --json.
/// @param what  One of them, as "point".
void warn_of_outside(std::span<const MapPoint> places, const std::string& what,
                     const StoreFacts& facts, const CrsFacts& crs, const Context& context);

/// The bytes of --memory. Without it: `otherwise`, or three quarters of what the process is allowed
/// where that is less.
[[nodiscard]] std::uint64_t memory_limit_of(std::optional<std::uint64_t> memory,
                                            std::uint64_t otherwise = kMemoryOfQuestion);
/// Memory as memory_limit_of(), and the program's stop token.
[[nodiscard]] QueryLimits limits_of(std::optional<std::uint64_t> memory, const Context& context);

/// Adds what the command line tells of a row.
template <typename Row>
void add_told(ask::Json& answer, const ask::Fields<Row>& all, const Row& row) {
  const auto fields = all.told(ask::Told::kProgram & ask::Told::kObject);
  ask::put(answer, fields, fields.values_of(row));
}
/// Prints an answer with the fields that every answer has.  @throws Error as write_to_stdout
void print_answer(ask::Json answer, const ask::AnswerFacts& facts);
/// The same with those of this one.
template <typename Row>
void print_answer(ask::Json answer, const ask::Fields<Row>& fields, const Row& row,
                  const ask::AnswerFacts& facts) {
  add_told(answer, fields, row);
  print_answer(std::move(answer), facts);
}
/// Prints JSON, indented and by the order of names, and a newline to stdout. Infinite numbers become null.
/// @throws Error as write_to_stdout
void print_json(const nlohmann::json& json);

}  // namespace ptin::tools
