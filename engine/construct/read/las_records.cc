// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/read/las_records.h"

#include <algorithm>
#include <cstring>
#include <span>
#include <utility>

namespace ptin {

namespace {

using Bytes = std::vector<unsigned char>;

constexpr std::uint64_t kMostRecords = 65536;  // that are looked at
constexpr std::uint64_t kMostCrsBytes = std::uint64_t{1} << 24;

constexpr std::uint16_t kMathTransform = 2111, kWkt = 2112;
constexpr std::uint16_t kKeys = 34735, kDoubles = 34736, kText = 34737;

/// Where records lie, and what the header says of them.
struct RecordPlace {
  std::uint64_t begin = 0, end = 0;  ///< Bytes of the file.
  std::uint64_t count = 0;
  bool extended = false;  ///< Records have lengths of 64 bits.
};

std::string_view text_of(std::span<const unsigned char> bytes) {
  const std::string_view all(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  return all.substr(0, all.find('\0'));
}

void take_wkt(const Bytes& content, LasRecords& records) {
  const std::string_view text = text_of(content);
  if (text.find_first_not_of(" \t\r\n") != std::string_view::npos) {
    records.wkt.emplace_back(text);
  }
}

/// Reads the content of a record if it is about the CRS.
/// @param id  The number of the record among those of the projection.
void take_record(const LasFile& file, std::uint16_t id, std::uint64_t at, std::uint64_t bytes,
                 LasRecords& records) {
  records.has_math_transform = records.has_math_transform || id == kMathTransform;
  const bool is_wanted = id == kWkt || id == kKeys || id == kDoubles || id == kText;
  if (!is_wanted || bytes > kMostCrsBytes) {
    return;
  }
  Bytes content(bytes);
  file.read(at, content);
  switch (id) {
    case kWkt:
      take_wkt(content, records);
      break;
    case kKeys:
      records.keys.directory = std::move(content);
      break;
    case kDoubles:
      records.keys.doubles = std::move(content);
      break;
    default:
      records.keys.text = std::move(content);
      break;
  }
}

/// Walks records; returns how many there are before place.end.
/// @param of_liblas  Receives texts under the name of that library, of which others know nothing.
std::uint64_t walk(const LasFile& file, const RecordPlace& place, LasRecords& records,
                   LasRecords& of_liblas) {
  const std::uint64_t head_bytes = place.extended ? 60 : 54;
  Bytes head(head_bytes);
  std::uint64_t at = place.begin;
  for (std::uint64_t i = 0; i < std::min(place.count, kMostRecords); ++i) {
    if (at > place.end || head_bytes > place.end - at) {
      return i;
    }
    file.read(at, head);
    at += head_bytes;
    const std::uint64_t bytes =
        place.extended ? las_value<std::uint64_t>(head, 20) : las_value<std::uint16_t>(head, 20);
    if (bytes > place.end - at) {
      return i;
    }
    const std::string_view user = text_of(std::span(head).subspan(2, 16));
    const auto id = las_value<std::uint16_t>(head, 18);
    if (user == "LASF_Projection") {
      take_record(file, id, at, bytes, records);
    } else if (user == "liblas" && id == kWkt) {
      take_record(file, id, at, bytes, of_liblas);
    }
    at += bytes;
  }
  return place.count;
}

void walk_all(const LasFile& file, const RecordPlace& place, const char* where, LasRecords& records,
              LasRecords& of_liblas) {
  const std::uint64_t there = walk(file, place, records, of_liblas);
  if (there < place.count) {
    records.warnings.push_back({"las_records",
                                "the header counts " + std::to_string(place.count) + " records " +
                                    where + ", and " + std::to_string(there) +
                                    " are there; what the others may declare is not known",
                                ""});
  }
}

}  // namespace

LasRecords read_las_records(const LasFile& file, const LasHeader& header) {
  LasRecords records, of_liblas;
  const std::uint64_t points_begin = std::min(header.first_point, file.bytes());
  walk_all(file, {header.header_bytes, points_begin, header.records, false}, "before the points",
           records, of_liblas);
  if (header.extended_records > 0) {
    walk_all(file, {header.first_extended, file.bytes(), header.extended_records, true},
             "behind the points", records, of_liblas);
  }
  if (records.wkt.empty()) {
    records.wkt = std::move(of_liblas.wkt);
  }
  return records;
}

}  // namespace ptin
