// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/read/las_records.h"

#include <algorithm>
#include <span>
#include <string_view>
#include <vector>

#include "engine/construct/laz/las_value.h"

namespace ptin {

namespace {

constexpr std::uint64_t kMostRecords = 65536;  // that are looked at

}  // namespace

LasRecordPlace records_before_points(const LasFile& file, const LasHeader& header) {
  return {header.header_bytes, std::min(header.first_point, file.bytes()), header.records, false};
}

LasRecordPlace records_behind_points(const LasFile& file, const LasHeader& header) {
  return {header.first_extended, file.bytes(), header.extended_records, true};
}

std::uint64_t walk_records(const LasFile& file, const LasRecordPlace& place,
                           const std::function<void(const LasRecordHead& record)>& visit) {
  std::vector<unsigned char> head(place.extended ? 60 : 54);
  std::uint64_t at = place.begin;
  for (std::uint64_t i = 0; i < std::min(place.count, kMostRecords); ++i) {
    if (at > place.end || head.size() > place.end - at) {
      return i;
    }
    file.read(at, head);
    at += head.size();
    const std::uint64_t bytes =
        place.extended ? las_value<std::uint64_t>(head, 20) : las_value<std::uint16_t>(head, 20);
    if (bytes > place.end - at) {
      return i;
    }
    const std::string_view user(reinterpret_cast<const char*>(head.data()) + 2, 16);
    visit({std::string(user.substr(0, user.find('\0'))), las_value<std::uint16_t>(head, 18), at,
           bytes});
    at += bytes;
  }
  return place.count;
}

}  // namespace ptin
