// SPDX-License-Identifier: GPL-3.0-or-later
//
// The points of a LAZ file, or of some of its chunks, in batches.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "engine/construct/laz/byte_window.h"
#include "engine/construct/laz/chunk_table.h"
#include "engine/construct/laz/layout.h"
#include "engine/construct/laz/record_decoder.h"

namespace ptin::laz {

/// What the header of a compressed file says of its points.
struct CompressedPoints {
  Source source;
  Layout layout;
  std::uint64_t first_point = 0;  ///< Byte offset.
  std::uint64_t points = 0;
  std::uint64_t records = 0;  ///< Byte offset of the records behind the points; 0: there are none.
};

/// Reads the chunks of which the first point is one of some records, and of these chunks all points.
/// Not thread-safe; several may read one file. Memory: some 100 KiB a scanner channel, up to 2 MiB
/// where attributes vary much, and for each extra byte 1.2 KiB (formats 0 to 5).
class CompressedRecords {
 public:
  /// @param begin, end  The records, [begin, end).
  /// @throws Error  as ChunkTable
  /// Cost: reads the table of chunks up to `end`.
  CompressedRecords(CompressedPoints points, std::uint64_t begin, std::uint64_t end);
  CompressedRecords(const CompressedRecords&) = delete;  // Its parts refer to its points.
  CompressedRecords& operator=(const CompressedRecords&) = delete;

  /// The records of the chunks that are read, [begin(), end()).
  [[nodiscard]] std::uint64_t begin() const noexcept { return begin_; }
  [[nodiscard]] std::uint64_t end() const noexcept { return end_; }
  /// How many chunks these are. The file has bytes for so many, whatever the header says of points.
  [[nodiscard]] std::uint64_t chunks() const noexcept { return chunks_; }
  /// Chunks behind the last point of the header; 0 where that point is not among those read.
  [[nodiscard]] std::uint64_t chunks_behind() const noexcept { return chunks_behind_; }

  /// The beginnings of the next points, Layout::given_bytes() each; some thousands, none behind the last.
  /// @param records  Overwritten.
  /// @throws Error  invalid_argument  a chunk is damaged; io_error
  void next(std::vector<unsigned char>& records);

 private:
  void find_chunks(std::uint64_t begin, std::uint64_t end);
  [[noreturn]] void refuse(const char* fault) const;

  CompressedPoints points_;
  std::optional<ChunkTable> table_;  ///< Behind the chunk that is being read.
  std::unique_ptr<RecordDecoder> decoder_;
  Chunk chunk_;
  std::uint64_t begin_ = 0, end_ = 0, chunks_ = 0, chunks_behind_ = 0;
  std::uint64_t read_ = 0;  ///< The next record.
};

}  // namespace ptin::laz
