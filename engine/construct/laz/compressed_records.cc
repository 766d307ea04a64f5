// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/laz/compressed_records.h"

#include <algorithm>
#include <string>
#include <utility>

#include "engine/error.h"

namespace ptin::laz {

namespace {

constexpr std::uint64_t kBatchRecords = 4096;

}  // namespace

CompressedRecords::CompressedRecords(CompressedPoints points, std::uint64_t begin,
                                     std::uint64_t end)
    : points_(std::move(points)) {
  find_chunks(begin, end);
  decoder_ = points_.layout.is_layered ? make_layered_decoder(points_.source, points_.layout)
                                       : make_point_wise_decoder(points_.source, points_.layout);
}

/// Looks for the first and the last chunk, and opens the table at the first one.
void CompressedRecords::find_chunks(std::uint64_t begin, std::uint64_t end) {
  const auto open = [&] {
    table_.emplace(points_.source, points_.layout, points_.first_point, points_.points,
                   points_.records);
  };
  open();
  Chunk chunk;
  std::uint64_t before = 0;  // chunks
  begin_ = end_ = points_.points;
  bool reaches_end = true;
  while (reaches_end && table_->next(chunk)) {
    if (chunk.first_record < begin) {
      ++before;
      continue;
    }
    begin_ = std::min(begin_, chunk.first_record);
    if (chunk.first_record >= end) {
      end_ = chunk.first_record;
      reaches_end = false;
      continue;
    }
    ++chunks_;
  }
  chunks_behind_ = reaches_end ? table_->chunks_left() : 0;
  read_ = begin_;
  open();
  for (; before > 0; --before) {
    static_cast<void>(table_->next(chunk));
  }
}

void CompressedRecords::refuse(const char* fault) const {
  const bool is_last = chunk_.first_record + chunk_.records == points_.points;
  throw Error(ErrorCode::invalid_argument,
              "the chunk of the points from " + std::to_string(chunk_.first_record) +
                  " on is damaged: " + fault +
                  (is_last ? ", or the header's number of points is wrong: " +
                                 std::to_string(points_.points)
                           : ""),
              points_.source.path);
}

void CompressedRecords::next(std::vector<unsigned char>& records) {
  records.clear();
  if (read_ >= end_) {
    return;
  }
  try {
    if (read_ == chunk_.first_record + chunk_.records || read_ == begin_) {
      static_cast<void>(table_->next(chunk_));
      decoder_->open(chunk_);
    }
    const std::uint64_t left = chunk_.first_record + chunk_.records - read_;
    const std::uint64_t count = std::min(left, kBatchRecords);
    records.resize(count * points_.layout.given_bytes());
    decoder_->read(records);
    read_ += count;
    if (count == left) {
      decoder_->close();
    }
  } catch (const DamagedBytes& damaged) {
    refuse(damaged.fault);
  }
}

}  // namespace ptin::laz
