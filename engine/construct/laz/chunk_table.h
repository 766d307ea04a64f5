// SPDX-License-Identifier: GPL-3.0-or-later
//
// The chunks of a LAZ file, read out of its table one after the other: memory does not grow with
// their number.
#pragma once

#include <cstdint>
#include <memory>

#include "engine/construct/laz/arithmetic_decoder.h"
#include "engine/construct/laz/byte_window.h"
#include "engine/construct/laz/integer_decoder.h"
#include "engine/construct/laz/layout.h"

namespace ptin::laz {

/// Points that are compressed by themselves.
struct Chunk {
  std::uint64_t first_record = 0, records = 0;  ///< records > 0
  std::uint64_t begin = 0, end = 0;             ///< Bytes of the file.
};

/// Walks over the chunks that the points of a file lie in.
///
/// The table: a version (0) and the number of chunks, 32 bits each, then for each chunk the number of
/// its points, where that varies, and of its bytes, coded as integers of which each predicts the next
/// (LASzip's open source, lasreadpoint.cpp). Eight bytes before the first chunk say where the table
/// begins; -1 there means that the eight bytes behind the table do: the last ones of the file, or
/// those before the records that lie behind the points.
class ChunkTable {
 public:
  /// @param source        Must outlive this, as `layout`.
  /// @param first_point   Where the points begin in the file, as the header says.
  /// @param points        Those of the header.
  /// @param records       Where the records behind the points begin; 0: there are none.
  /// @throws Error invalid_argument  there is no table, or it contradicts the file's size
  ChunkTable(const Source& source, const Layout& layout, std::uint64_t first_point,
             std::uint64_t points, std::uint64_t records);

  /// The next chunk; false behind the last one that has points of the header's number. A number
  /// that ends within a chunk cuts it, which whoever decodes the chunk sees by its bytes.
  /// @throws Error invalid_argument  the table is damaged, or has fewer points than the header says
  [[nodiscard]] bool next(Chunk& chunk);
  /// How many chunks the table has beyond the last one that next() gave.
  [[nodiscard]] std::uint64_t chunks_left() const noexcept { return chunks_; }

 private:
  [[nodiscard]] std::uint64_t place_behind(std::uint64_t records) const;
  void open_table(std::uint64_t begin);
  [[nodiscard]] Chunk read_entry();
  [[noreturn]] void refuse(const std::string& fault) const;

  const Source& source_;
  const Layout& layout_;
  std::uint64_t points_ = 0;               ///< Of the header.
  std::uint64_t points_given_ = 0;         ///< Of all chunks so far.
  std::uint64_t chunks_ = 0;               ///< That are still to come.
  std::uint64_t at_ = 0;                   ///< Where the next chunk begins.
  std::uint64_t chunks_end_ = 0;           ///< Where the table begins.
  std::uint32_t records_ = 0, bytes_ = 0;  ///< Of the chunk before.
  ArithmeticDecoder decoder_;
  std::unique_ptr<IntegerDecoder<32, 2>> numbers_;
};

}  // namespace ptin::laz
