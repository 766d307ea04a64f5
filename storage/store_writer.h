// SPDX-License-Identifier: GPL-3.0-or-later
//
// Writes a .ptin file: records in, packed R-tree bulk-loaded over their pages, published whole or
// not at all.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>

#include "storage/page_journal.h"
#include "storage/record.h"
#include "storage/store_file.h"

namespace ptin {

class FileLayer;

struct StoreWriterOptions {
  bool overwrite =
      false;  ///< Replace an existing file; otherwise its existence is an invalid_argument.
  std::uint32_t page_bytes =
      4096;  ///< Power of two from 4096 to 65536. StoreFacts::page_bytes is not looked at.
  FileLayer* files =
      nullptr;  ///< Through which to write; borrowed; null means the system. For tests.
  /// A folder on the file system of the target. When it is named, work is kept there, in the files
  /// `pages` and `descriptors`, until publish(), so that another writer can go on from a
  /// checkpoint; its owner removes them. Otherwise nothing is ever left behind.
  std::string work_folder = {};
};

/// Writes beside the target under a temporary name; publish() syncs and renames. Destroyed without
/// publish(), it removes what it wrote: the target's name never shows a part. (A process that is
/// killed leaves a file named .TARGET.PID-N.tmp.)
/// Segments arrive in any order of dependency; the file keeps the order of segments, each on pages
/// of its own, and inside a segment orders records by record_order.h. The bytes depend on
/// nothing but what is given. Memory: one segment twice and 32 bytes for each of its records while
/// it is ordered; 2 MiB; less than one byte for a hundred records (leaves of the index go to a
/// nameless side file).
class StoreWriter {
 public:
  /// @throws Error invalid_argument (target exists and overwrite is off), io_error, not_found (no
  /// such folder)
  static std::unique_ptr<StoreWriter> create(const std::string& path,
                                             const StoreWriterOptions& options);
  StoreWriter(const StoreWriter&) = delete;
  StoreWriter& operator=(const StoreWriter&) = delete;
  virtual ~StoreWriter() = default;

  /// Goes on from a checkpoint that a writer with the same work folder, target and options made:
  /// pages behind it are forgotten, those before it are read again and checked. To be called first.
  /// @throws Error corruption (the pages are not those of the checkpoint), io_error
  /// Cost: one reading of the pages.
  virtual void resume(const StoreCheckpoint& checkpoint, const HeightEncoding& heights) = 0;

  /// Where the writer stands: behind the last segment. Only with a work folder, as sync().
  [[nodiscard]] virtual StoreCheckpoint position() const = 0;
  /// Makes all segments so far durable.
  /// @throws Error resource_exhausted, io_error
  virtual void sync() = 0;

  /// Appends one segment. `records` is reordered in place.
  /// @throws Error resource_exhausted (disk full), io_error, invalid_argument (another encoding of
  ///               heights than before), internal (a record that no reader would accept)
  virtual void add_segment(std::span<VertexSplit> records, const HeightEncoding& heights) = 0;

  /// Writes T0, metadata, index and tables, syncs, renames onto the target, syncs the folder. To be
  /// called once. Moves as many bytes of pages as the front of the file is long.
  /// @param metadata_json  UTF-8 JSON; not looked at.
  /// @throws Error invalid_argument    facts or T0 that no reader would accept; the target exists
  /// by now
  ///               resource_exhausted  disk full
  ///               io_error            also when all is done but the folder could not be synced
  virtual void publish(const StoreFacts& facts, const CoarsestTin& t0,
                       const std::string& metadata_json) = 0;

 protected:
  StoreWriter() = default;
};

}  // namespace ptin
