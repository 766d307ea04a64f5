// SPDX-License-Identifier: GPL-3.0-or-later
//
// What is done of a build, in memory and in the manifest.
#pragma once

#include <chrono>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "engine/construct/hierarchy/segment_output.h"
#include "engine/construct/scratch/array_file.h"
#include "engine/construct/scratch/workspace.h"
#include "engine/construct/tile/tile_tree.h"

namespace ptin {

/// Endings of the names of a tile's temporary files: its segment; what it pushes up; records of its
/// leaves that wait to be written; its final bounds.
inline constexpr const char* kSegmentEnding = ".segment";
inline constexpr const char* kPushedEnding = ".pushed";
inline constexpr const char* kRecordsEnding = ".records";
inline constexpr const char* kBoundsEnding = ".bounds";

/// The files of a tile after its collapses. Those without bytes do not exist.
struct CollapsedTile {
  ArrayFileFacts segment;
  ArrayFileFacts pushed;
  ArrayFileFacts records;  ///< Of its leaves, while they wait for their turn to be written.
  std::uint64_t lone_samples = 0;
};

/// Notes go to the manifest at checkpoints: the output and the temporary files are synced, then
/// their lines written, then what they made superfluous is removed. Work since the last one is done
/// again after a crash. Threads: one at a time.
class BuildLog {
 public:
  /// Takes up what the workspace's manifest says.
  /// @param interval  Least time between checkpoints that are not forced.
  BuildLog(Workspace& workspace, SegmentOutput& output, std::chrono::milliseconds interval);

  [[nodiscard]] Workspace& workspace() const noexcept { return workspace_; }
  [[nodiscard]] SegmentOutput& output() const noexcept { return output_; }

  /// `L-X-Y`, with one of the endings: the name of a tile's temporary file.
  [[nodiscard]] static std::string name(const TileId& id, const char* ending);
  [[nodiscard]] std::string path(const TileId& id, const char* ending) const {
    return workspace_.temporary(name(id, ending));
  }

  /// Tiles whose collapses are done.
  [[nodiscard]] const std::map<TileId, CollapsedTile>& collapsed() const noexcept {
    return collapsed_;
  }
  /// Tiles whose bounds are final: facts of the file that holds them.
  [[nodiscard]] const std::map<TileId, ArrayFileFacts>& tightened() const noexcept {
    return tightened_;
  }
  /// Batches whose leaves, and whose own and closed segments, have been written, in their order.
  [[nodiscard]] std::uint64_t leaves_written() const noexcept { return leaves_written_; }
  [[nodiscard]] std::uint64_t batches_written() const noexcept { return batches_written_; }

  void note_collapsed(const TileId& id, const CollapsedTile& tile);
  void note_tightened(const TileId& id, const ArrayFileFacts& bounds);
  /// The output stands at the end of these batches now.
  void note_written(std::uint64_t leaves, std::uint64_t batches);
  /// The file is not needed once all notes so far are durable.
  void remove_later(const TileId& id, const char* ending);
  /// @throws Error resource_exhausted, io_error
  void checkpoint(bool force);

 private:
  void take_up(const nlohmann::json& line);

  Workspace& workspace_;
  SegmentOutput& output_;
  std::chrono::milliseconds interval_;
  std::chrono::steady_clock::time_point last_ = std::chrono::steady_clock::now();
  std::map<TileId, CollapsedTile> collapsed_;
  std::map<TileId, ArrayFileFacts> tightened_;
  std::uint64_t leaves_written_ = 0, batches_written_ = 0;
  nlohmann::json position_;  ///< Of the output, at the end of those batches.
  std::vector<nlohmann::json> lines_;
  std::vector<std::string> unsynced_, superfluous_;
};

}  // namespace ptin
