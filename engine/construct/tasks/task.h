// SPDX-License-Identifier: GPL-3.0-or-later
//
// The work of a build as tasks: each reads the files that it names and writes files of its own, and
// can be done again with the same result, by any thread, process or machine that sees these files.
#pragma once

#include <array>
#include <compare>
#include <cstdint>
#include <functional>
#include <map>
#include <stop_token>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "engine/construct/scratch/array_file.h"
#include "engine/construct/tile/tile_tree.h"
#include "engine/error.h"

namespace ptin {

enum class TaskKind : std::uint8_t {
  // Reading a source, before its tiles are known; numbered from 0.
  kScan,   ///< A band of a raster: its heights are looked at.
  kRead,   ///< A portion of points: those that are wanted go to a spool.
  kShare,  ///< A share of these: they are put on the grid, apart for each range of the curve.
  kSort,   ///< A range of the curve: its points are sorted into buckets.
  // Tiles.
  kCollapse,  ///< A batch: its leaves are read from the source, collapsed and joined.
  kJoin,      ///< A tile of level 2 or more: what its children pushed up is joined and collapsed.
  kTighten,   ///< A batch: the segments above it are replayed over its leaves.
  kClose,     ///< A tile of level 2 or more: its segment gets its final bounds, and is packed.
  kPlace,     ///< The pages of a batch or a tile are copied to their place in the output.
};

/// A task's kind, and its tile: the top of a batch, or a tile of level 2 or more.
struct TaskName {
  TaskKind kind = TaskKind::kCollapse;
  TileId tile;
  friend auto operator<=>(const TaskName&, const TaskName&) = default;
};

/// A task of reading has its number in the place of a tile.
[[nodiscard]] inline TaskName numbered(TaskKind kind, std::size_t number) noexcept {
  return {kind, {0, static_cast<std::int64_t>(number), 0}};
}
[[nodiscard]] inline std::size_t number_of(const TaskName& name) noexcept {
  return static_cast<std::size_t>(name.tile.x);
}

/// A sentence's subject: "collapsing tile 1-3-0".
[[nodiscard]] std::string to_string(const TaskName& name);
/// The stage of the build that a kind of task belongs to, as StageProgress has it; a literal.
[[nodiscard]] const char* stage_of(TaskKind kind) noexcept;

/// What tasks hand to one another, each in a file `LEVEL-X-Y.ending` (file_name()).
enum class TileFile : std::uint8_t {
  kPushed,        ///< By collapse and join: what the tile pushes up.
  kSegment,       ///< By join: records that wait for tightening.
  kBounds,        ///< By tighten and close: raises for each tile above, the root's first; by close
                  ///< also the final bounds of what the tile pushed up.
  kPages,         ///< By collapse and close: final pages, in the order of their segments.
  kDescriptions,  ///< By the same: of each segment, what the output must know of its pages.
  kIndex          ///< By tasks of reading, under names of their own: what came of them. Also the
                  ///< plan that such tasks go by.
};
inline constexpr std::size_t kTileFiles = 6;

[[nodiscard]] std::string file_name(const TileId& tile, TileFile file);
/// The task that writes a file.
[[nodiscard]] TaskName producer_of(const TileId& tile, TileFile file) noexcept;

/// A file that a task reads, and how its content is recognised.
struct InputFile {
  TileId tile;
  TileFile file = TileFile::kPushed;
  ArrayFileFacts facts;
};

/// What a worker is given. The order of inputs is that of:
/// - read, share, sort: the plan of all of them;
/// - join: the `pushed` of its children, in the order of TileTree::children();
/// - tighten: the `pushed` of the root; the `segment` of each tile above, the root first;
/// - close: its `segment`; the `bounds` of its children;
/// - place: its `pages`.
struct Task {
  TaskName name;
  std::vector<InputFile> inputs;
  std::uint64_t offset = 0;  ///< Place: where the pages go, in bytes from the first page.
  /// Its price: memory that it takes, by estimate; of reading, memory that it may sort in.
  std::uint64_t bytes = 0;
  // What follows is of the process that does it, and in no message.
  std::stop_token stop{};
  /// Called now and then with how much is done, never less than before: bytes of a text, samples of
  /// a raster or of whole leaves, points. May be empty.
  std::function<void(std::uint64_t done)> progress{};
  void tell(std::uint64_t done) const {
    if (progress) {
      progress(done);
    }
  }
};

/// What a worker reports when a task is done.
struct TaskResult {
  std::array<ArrayFileFacts, kTileFiles> files{};  ///< By TileFile; 0 bytes: no such file.
  std::uint64_t page_bytes = 0;                    ///< Bytes of the pages themselves.
  std::uint64_t lone_samples = 0;                  ///< Collapse: in its leaves; see StartedTile.
  std::string told{};                              ///< Scan: what was found; at most 1 KB.
  [[nodiscard]] const ArrayFileFacts& facts(TileFile file) const {
    return files[static_cast<std::size_t>(file)];
  }
  [[nodiscard]] ArrayFileFacts& facts(TileFile file) {
    return files[static_cast<std::size_t>(file)];
  }
};

/// Results of tasks that are done, those of one kind by number or by tile.
using TaskResults = std::map<TaskName, TaskResult>;

/// Does tasks. What it needs for one beside the inputs and options of the build it takes from files
/// that the task names: any process that sees these does it.
class TaskWorker {
 public:
  TaskWorker() = default;
  TaskWorker(const TaskWorker&) = delete;
  TaskWorker& operator=(const TaskWorker&) = delete;
  virtual ~TaskWorker() = default;

  /// Does a task. It can be done again, with the same result; files of its names that are there
  /// already are replaced.
  /// Threads: several tasks at once.
  /// @throws DamagedInput  an input is not what its task wrote
  /// @throws Error  as the source; cancelled, io_error, resource_exhausted
  [[nodiscard]] virtual TaskResult run(const Task& task) = 0;
};

/// Thrown by a task when a file that it reads is not what was written, or is gone: the task that
/// wrote it is to be done again.
class DamagedInput : public Error {
 public:
  DamagedInput(const InputFile& input, const Error& error)
      : Error(error.code(), error.message(), error.context()),
        tile_(input.tile),
        file_(input.file) {}
  [[nodiscard]] const TileId& tile() const noexcept { return tile_; }
  [[nodiscard]] TileFile file() const noexcept { return file_; }
  [[nodiscard]] TaskName producer() const noexcept { return producer_of(tile_, file_); }

 private:
  TileId tile_;
  TileFile file_;
};

/// Calls `use()`, which reads an input.
/// @throws DamagedInput  it met bytes that are not what was written, or found no file
template <class Use>
auto use_input(const InputFile& input, Use&& use) {
  try {
    return use();
  } catch (const Error& e) {
    if (e.code() == ErrorCode::corruption || e.code() == ErrorCode::not_found) {
      throw DamagedInput(input, e);
    }
    throw;
  }
}

/// Opens an input in the folder of the tasks' files and calls `read(reader)`.
/// @throws DamagedInput  as use_input()
template <class Read>
auto read_input(const std::string& folder, const InputFile& input, Read&& read) {
  return use_input(input, [&] {
    ArrayFileReader reader(folder + "/" + file_name(input.tile, input.file), input.facts);
    return read(reader);
  });
}

// As JSON: for the manifest, for messages between processes and for the notes of parts. At most
// 1 KB, for trees of up to 20 levels.
[[nodiscard]] nlohmann::json json_of(const ArrayFileFacts& facts);
[[nodiscard]] nlohmann::json json_of(const TaskName& name);
[[nodiscard]] nlohmann::json json_of(const Task& task);
[[nodiscard]] nlohmann::json json_of(const TaskResult& result);
/// @throws nlohmann::json::exception  the JSON is none that json_of() made
[[nodiscard]] ArrayFileFacts array_facts_in(const nlohmann::json& json);
[[nodiscard]] TaskName task_name_in(const nlohmann::json& json);
[[nodiscard]] Task task_in(const nlohmann::json& json);
[[nodiscard]] TaskResult task_result_in(const nlohmann::json& json);

}  // namespace ptin
