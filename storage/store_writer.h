// SPDX-License-Identifier: GPL-3.0-or-later
//
// Writes a .ptin file: records in, packed R-tree bulk-loaded over their pages, published whole or
// not at all.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "storage/error_table.h"
#include "storage/file/file_layer.h"
#include "storage/floor_writer.h"
#include "storage/index_writer.h"
#include "storage/packed_segment.h"
#include "storage/page_journal.h"
#include "storage/page_slots.h"
#include "storage/store_file.h"

namespace ptin {

/// When there is a directory for points (storage/FORMAT.md, "Directory"), and how it is cut.
struct DirectoryOptions {
  /// Fewer pages are found in as many rounds by the index, whose upper levels come with the opening.
  std::uint64_t least_pages = 1024;
  /// Own pages of a cell, where not too many cells come of that: the more, the longer a node; the
  /// fewer, the more pages belong to several cells.
  std::uint64_t pages_of_cell = 600;
  /// So that the directory stays below 48 KiB, and with all else that comes at the opening of a file
  /// that lies elsewhere below 64 KiB.
  std::uint32_t most_cells = 4900;
  /// Budget: one byte of nodes for so many bytes of pages. Above it there are fewer cells; if even
  /// one does not fit, since the stars of most pages reach far, there is no directory.
  std::uint64_t page_bytes_of_byte = 200;
};

struct StoreWriterOptions {
  /// Whether to replace an existing file. When off, an existing file is an invalid_argument.
  bool overwrite = false;
  /// A power of two from 4096 to 65536. StoreFacts::page_bytes is not looked at.
  std::uint32_t page_bytes = 4096;
  /// The files to write through; borrowed; null means those of the system. For tests.
  FileLayer* files = nullptr;
  /// A folder on the file system of the target. When it is named, the writer keeps its work there
  /// until publish(), in the files `pages` and `descriptors`, so that another writer can go on from
  /// a checkpoint; the owner of the folder removes them. When it is not named, nothing is ever left
  /// behind.
  std::string work_folder = {};
  DirectoryOptions directory = {};
};

/// How much of an unfinished store is in its place, and what is counted of it.
struct StoreCheckpoint {
  std::uint64_t pages = 0;
  std::uint64_t chain = 0;       ///< PageJournal::chain() of these pages.
  std::vector<ErrorBin> errors;  ///< As PackedSegment::errors, of all of them.
  std::uint16_t max_rank = 0;
};

/// The file in a work folder that holds the pages, one behind the other from its beginning.
[[nodiscard]] std::string pages_file_in(const std::string& work_folder);

/// Writes a store beside the target, under a temporary name; publish() syncs and renames it. A
/// writer that is destroyed without publish() removes what it wrote: the target's name never shows
/// a part. (A process that is killed leaves a file named .TARGET.PID-N.tmp.)
///
/// The file keeps the order in which segments come, whatever their records need of each other. The
/// bytes depend on what is given alone.
///
/// Memory: 1 MiB, and about one byte for a hundred records, since leaves of the index go to a
/// nameless side file.
class StoreWriter {
 public:
  /// @throws Error invalid_argument (target exists and overwrite is off), io_error, not_found (no
  /// such folder)
  static std::unique_ptr<StoreWriter> create(const std::string& path,
                                             const StoreWriterOptions& options);
  StoreWriter(const StoreWriter&) = delete;
  StoreWriter& operator=(const StoreWriter&) = delete;

  /// Goes on from a checkpoint that a writer with the same work folder, target and options made.
  /// Pages behind the checkpoint are forgotten; those before it are read again and checked. To be
  /// called first.
  /// REQUIRES: a work folder.
  /// @throws Error corruption (the pages are not those of the checkpoint), io_error
  /// Cost: one reading of the pages.
  void resume(const StoreCheckpoint& checkpoint, const HeightEncoding& heights);

  /// The checkpoint behind the last segment. REQUIRES: a work folder.
  [[nodiscard]] StoreCheckpoint position() const;
  /// Makes all segments so far durable. REQUIRES: a work folder.
  /// @throws Error resource_exhausted, io_error
  void sync();

  /// Appends one segment, packed for pages of StoreWriterOptions::page_bytes.
  /// @throws Error resource_exhausted (disk full), io_error, invalid_argument (another encoding of
  ///               heights than before), internal (pages that are not those of the descriptors)
  void add_segment(const PackedSegment& segment, const HeightEncoding& heights);

  /// Appends a segment whose pages somebody has put into pages_file_in() of the work folder already,
  /// behind all that were added before: another thread, or another process. `segment.pages` is not
  /// looked at.  REQUIRES: a work folder.
  /// @throws Error resource_exhausted (disk full), io_error, invalid_argument (another encoding of
  ///               heights than before)
  void add_placed(const PackedSegment& segment, const HeightEncoding& heights);

  /// Takes the heights of the raster that the terrain is of. To be called before publish(); what an
  /// earlier call gave is forgotten.
  /// @param fill  Adds all tiles, in the order of their keys; where it returns false there are no
  ///              heights.
  /// @throws Error resource_exhausted (disk full), io_error; what `fill` throws
  void add_floor(const FloorFacts& facts, const std::function<bool(FloorWriter&)>& fill);

  /// Writes T0, metadata, index and tables, syncs, renames onto the target, syncs the folder. To be
  /// called once, at the end. Cost besides: moves as many bytes of pages as the front of the file
  /// is long.
  /// @param metadata_json  UTF-8 JSON; not looked at.
  /// @throws Error invalid_argument    facts or T0 that no reader would accept; the target has
  ///                                   appeared meanwhile and `overwrite` is off
  ///               resource_exhausted  disk full
  ///               io_error            also when all is done but the folder could not be synced
  void publish(const StoreFacts& facts, const CoarsestTin& t0, const std::string& metadata_json);

 private:
  StoreWriter(const std::string& path, const StoreWriterOptions& options);
  void start(const HeightEncoding& heights);
  void count(const std::vector<ErrorBin>& errors, std::uint16_t max_rank);
  void restore_moved_pages();
  void take_back(const layout::NodeEntry& entry, std::vector<std::byte>& page);
  PageSlots move_pages_behind(std::uint64_t front_bytes);
  void write_floor(std::uint64_t nodes_offset);

  std::string path_;
  StoreWriterOptions options_;
  FileLayer& files_;
  std::string folder_, stem_;
  ScratchFile file_;
  std::optional<PageJournal> journal_;
  std::optional<HeightEncoding> heights_;
  std::optional<IndexWriter> index_;
  ErrorTable errors_;
  std::vector<layout::FloorNode> floor_nodes_;  ///< Empty: there are no heights of a raster.
  std::unique_ptr<ScratchFile> floor_pages_;
  std::uint64_t floor_bytes_ = 0, floor_checksum_ = 0;  ///< Of the pages.
  std::uint64_t written_bytes_ = 0;  ///< Pages lie at the start of the file until publish().
  std::uint16_t max_rank_ = 0;
  bool published_ = false;
};

}  // namespace ptin
