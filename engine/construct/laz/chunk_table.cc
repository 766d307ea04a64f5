// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/laz/chunk_table.h"

#include <algorithm>
#include <array>
#include <string>

#include "engine/construct/laz/las_value.h"
#include "engine/error.h"

namespace ptin::laz {

ChunkTable::ChunkTable(const Source& source, const Layout& layout, std::uint64_t first_point,
                       std::uint64_t points, std::uint64_t records)
    : source_(source), layout_(layout), points_(points), at_(first_point), decoder_(source) {
  if (points == 0) {
    return;
  }
  if (!layout.has_chunks) {
    chunks_ = 1;
    chunks_end_ = source.bytes;
    return;
  }
  if (source.bytes < 8 || first_point > source.bytes - 8) {
    refuse("it has no table of chunks");
  }
  at_ = first_point + 8;
  std::array<unsigned char, 8> place{};
  source.read(first_point, place);
  const bool is_behind = las_value<std::int64_t>(place, 0) == -1;
  open_table(is_behind ? place_behind(records) : las_value<std::uint64_t>(place, 0));
}

/// Where the table begins, by the bytes behind it. Of two places that may have them, the one counts
/// that names a table before itself.
std::uint64_t ChunkTable::place_behind(std::uint64_t records) const {
  for (const std::uint64_t end : {source_.bytes, records}) {
    std::array<unsigned char, 8> place{};
    if (end > source_.bytes || end < at_ + 8 + place.size()) {
      continue;
    }
    source_.read(end - place.size(), place);
    const auto begin = las_value<std::uint64_t>(place, 0);
    if (begin >= at_ && begin <= end - 8 - place.size()) {
      return begin;
    }
  }
  refuse(
      "neither its end nor what lies before its extended records says where its table of chunks "
      "begins, as the file of a writer that cannot go back does");
}

void ChunkTable::refuse(const std::string& fault) const {
  throw Error(ErrorCode::invalid_argument,
              fault + "; the file is damaged, cut off, or was not written to its end",
              source_.path);
}

void ChunkTable::open_table(std::uint64_t begin) {
  if (begin < at_ || begin > source_.bytes || source_.bytes - begin < 8) {
    refuse("its table of chunks is said to begin at byte " + std::to_string(begin) + " of " +
           std::to_string(source_.bytes) + ", and belongs behind its points");
  }
  std::array<unsigned char, 8> head{};
  source_.read(begin, head);
  if (las_value<std::uint32_t>(head, 0) != 0) {
    refuse("its table of chunks is of a version that does not exist");
  }
  chunks_ = las_value<std::uint32_t>(head, 4);
  chunks_end_ = begin;
  if (chunks_ > (chunks_end_ - at_) / layout_.record_bytes) {
    refuse("its table counts more chunks than there are bytes for");
  }
  if (chunks_ == 0) {
    return;
  }
  numbers_ = std::make_unique<IntegerDecoder<32, 2>>();
  numbers_->begin();
  try {
    decoder_.open(begin + 8, source_.bytes);
  } catch (const DamagedBytes&) {
    refuse("its table of chunks is cut");
  }
}

/// The chunk that comes next, its points and bytes as the table says.
Chunk ChunkTable::read_entry() {
  Chunk chunk{points_given_, layout_.chunk_records, at_, chunks_end_};
  if (!layout_.has_chunks) {
    chunk.records = points_;
    return chunk;
  }
  try {
    if (layout_.chunk_records == Layout::kVaries) {
      records_ = static_cast<std::uint32_t>(
          numbers_->read(decoder_, static_cast<std::int32_t>(records_), 0));
      chunk.records = records_;
    }
    bytes_ =
        static_cast<std::uint32_t>(numbers_->read(decoder_, static_cast<std::int32_t>(bytes_), 1));
  } catch (const DamagedBytes&) {
    refuse("its table of chunks is damaged");
  }
  if (bytes_ > chunks_end_ - at_ || bytes_ < layout_.record_bytes || chunk.records == 0) {
    refuse("its table of chunks does not fit the bytes of its points");
  }
  chunk.end = at_ + bytes_;
  return chunk;
}

bool ChunkTable::next(Chunk& chunk) {
  if (points_given_ >= points_) {
    return false;
  }
  if (chunks_ == 0) {
    throw Error(ErrorCode::invalid_argument,
                "the header says " + std::to_string(points_) + " points and its chunks hold " +
                    std::to_string(points_given_) + "; the file is damaged or cut off",
                source_.path);
  }
  --chunks_;
  chunk = read_entry();
  chunk.records = std::min(chunk.records, points_ - points_given_);
  points_given_ += chunk.records;
  at_ = chunk.end;
  return true;
}

}  // namespace ptin::laz
