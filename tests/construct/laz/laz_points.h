// SPDX-License-Identifier: GPL-3.0-or-later
//
// LAZ files in memory, read without the reader of LAS.
#pragma once

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <limits>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "engine/construct/laz/compressed_records.h"
#include "engine/construct/laz/las_value.h"

namespace ptin::oracle {

inline std::span<const unsigned char> las_bytes(const std::string& text) {
  return {reinterpret_cast<const unsigned char*>(text.data()), text.size()};
}

/// What the header of a file says, and its record "laszip encoded". REQUIRES: `file` outlives the
/// result, its header and records are whole.
/// @throws Error as laz::read_layout()
inline laz::CompressedPoints compressed_points_of(const std::string& file) {
  const auto bytes = las_bytes(file);
  laz::CompressedPoints points;
  points.source = {"made.laz", file.size(), [bytes](std::uint64_t at, std::span<unsigned char> to) {
                     if (at > bytes.size() || to.size() > bytes.size() - at) {
                       throw std::logic_error("bytes beyond the file were asked for");
                     }
                     std::copy_n(bytes.begin() + static_cast<std::ptrdiff_t>(at), to.size(),
                                 to.begin());
                   }};
  points.first_point = las_value<std::uint32_t>(bytes, 96);
  points.points =
      bytes[25] < 4 ? las_value<std::uint32_t>(bytes, 107) : las_value<std::uint64_t>(bytes, 247);
  std::size_t at = las_value<std::uint16_t>(bytes, 94);
  for (auto records = las_value<std::uint32_t>(bytes, 100); records > 0; --records) {
    const std::size_t content = las_value<std::uint16_t>(bytes, at + 20);
    const std::string_view user(file.data() + at + 2, 14);
    at += 54;
    if (user == laz::kLayoutUser) {
      points.layout = laz::read_layout(bytes.subspan(at, content), bytes[104] & 0x7f,
                                       las_value<std::uint16_t>(bytes, 105), points.source.path);
    }
    at += content;
  }
  return points;
}

/// The beginnings of the records of the chunks that begin in [begin, end).
/// @throws Error as laz::CompressedRecords; std::logic_error  bytes beyond the file were asked for
inline std::vector<unsigned char> records_of(
    const std::string& file, std::uint64_t begin = 0,
    std::uint64_t end = std::numeric_limits<std::uint64_t>::max()) {
  laz::CompressedRecords records(compressed_points_of(file), begin, end);
  std::vector<unsigned char> all, batch;
  for (records.next(batch); !batch.empty(); records.next(batch)) {
    all.insert(all.end(), batch.begin(), batch.end());
  }
  if (all.size() != (records.end() - records.begin()) * laz::kRecordBytes) {
    throw std::logic_error("not as many records as it says");
  }
  return all;
}

}  // namespace ptin::oracle
