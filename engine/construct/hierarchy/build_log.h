// SPDX-License-Identifier: GPL-3.0-or-later
//
// The log of a build: which tiles are collapsed, which are tightened and what is written, in memory
// and in the manifest.
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

/// Endings of the names of a tile's temporary files:
/// - segment: records of a tile of level 2 or more, which wait for tightening;
/// - pushed: what a tile pushes up to its parent;
/// - records: final records of a batch, under the name of its top, while they wait for their turn;
/// - bounds: the raises that a batch shows, for each ancestor of its top; or the final bounds of
///   what a tile of level 2 or more pushed up.
inline constexpr const char* kSegmentEnding = ".segment";
inline constexpr const char* kPushedEnding = ".pushed";
inline constexpr const char* kRecordsEnding = ".records";
inline constexpr const char* kBoundsEnding = ".bounds";

/// The temporary files of a collapsed tile. A file of 0 bytes does not exist.
struct CollapsedTile {
  ArrayFileFacts segment;
  ArrayFileFacts pushed;
  ArrayFileFacts records;
  std::uint64_t lone_samples = 0;
};

/// Collects notes of finished work, and writes them to the manifest at checkpoints. A checkpoint
/// syncs the output and the temporary files that the notes name, then appends the notes to the
/// manifest, then removes the files that are superfluous by these notes. So the manifest never
/// tells of work that is not durable. After a crash the work since the last checkpoint is done
/// again.
/// Threads: one at a time.
class BuildLog {
 public:
  /// Takes up the notes of an interrupted build, if the workspace has any, and sets the output back
  /// to the position that they name. Workspace and output must outlive the log.
  /// @param interval  Least time between checkpoints that are not forced.
  /// @throws Error as SegmentOutput::resume
  BuildLog(Workspace& workspace, SegmentOutput& output, std::chrono::milliseconds interval);

  [[nodiscard]] Workspace& workspace() const noexcept { return workspace_; }
  [[nodiscard]] SegmentOutput& output() const noexcept { return output_; }

  /// Name of a tile's temporary file: `LEVEL-X-Y` and one of the endings.
  [[nodiscard]] static std::string name(const TileId& id, const char* ending);
  /// The path of that file.
  [[nodiscard]] std::string path(const TileId& id, const char* ending) const {
    return workspace_.temporary(name(id, ending));
  }

  /// Tiles whose collapses are done.
  [[nodiscard]] const std::map<TileId, CollapsedTile>& collapsed() const noexcept {
    return collapsed_;
  }
  /// Facts of the `.bounds` files: of the tops of batches that have been replayed, and of tiles of
  /// level 2 or more whose bounds are final.
  [[nodiscard]] const std::map<TileId, ArrayFileFacts>& tightened() const noexcept {
    return tightened_;
  }
  /// Number of batches, in their order, whose own records (of leaves and top) are in the output.
  [[nodiscard]] std::uint64_t leaves_written() const noexcept { return leaves_written_; }
  /// Number of batches, in their order, that tightening is done with: their raises are noted, and
  /// the segments of the ancestors that they close are in the output.
  [[nodiscard]] std::uint64_t batches_written() const noexcept { return batches_written_; }

  void note_collapsed(const TileId& id, const CollapsedTile& tile);
  void note_tightened(const TileId& id, const ArrayFileFacts& bounds);
  /// Sets both numbers, and takes the position of the output, which stands at the end of what these
  /// batches wrote.
  void note_written(std::uint64_t leaves, std::uint64_t batches);
  /// Removes the file at the next checkpoint, when all notes so far are durable.
  void remove_later(const TileId& id, const char* ending);
  /// Makes a checkpoint, unless the last one is more recent than the interval.
  /// @param force  A checkpoint in any case.
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
  nlohmann::json position_;  ///< Of the output, at the last note_written().
  std::vector<nlohmann::json> lines_;
  std::vector<std::string> unsynced_, superfluous_;
};

}  // namespace ptin
