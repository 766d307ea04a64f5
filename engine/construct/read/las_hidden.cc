// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/read/las_hidden.h"

#include <algorithm>
#include <map>
#include <string>
#include <string_view>

#include "engine/construct/laz/las_value.h"
#include "engine/construct/read/las_records.h"
#include "engine/error.h"

namespace ptin {

namespace {

using Bytes = std::vector<unsigned char>;

/// A description of extra bytes, of the LAS specification: its type is byte 2, its name 32 bytes from 4 on.
constexpr std::size_t kDescriptionBytes = 192;
/// Bytes of the types of extra bytes, from 1 on. Type 0 says in its options how many it has.
constexpr std::uint32_t kTypeBytes[] = {0, 1, 1, 2, 2, 4, 4, 8, 8, 4, 8};

std::uint32_t bytes_of(const unsigned char* description) {
  std::uint32_t type = description[2];
  if (type == 0) return description[3];
  // Pairs and triples of the ten types, as LAS had them until its revision 14.
  const std::uint32_t times = (type - 1) / 10 + 1;
  type = (type - 1) % 10 + 1;
  return times * kTypeBytes[type];
}

/// Where each extra byte that has a name begins.
std::map<std::string, std::uint32_t, std::less<>> places_of(const Bytes& descriptions) {
  std::map<std::string, std::uint32_t, std::less<>> places;
  std::uint32_t at = 0;
  for (std::size_t i = 0; i + kDescriptionBytes <= descriptions.size(); i += kDescriptionBytes) {
    const std::string_view name(reinterpret_cast<const char*>(&descriptions[i]) + 4, 32);
    places.emplace(name.substr(0, name.find('\0')), at);
    at += bytes_of(&descriptions[i]);
  }
  return places;
}

}  // namespace

std::optional<HiddenLas14> hidden_las14(const LasFile& file, const LasHeader& header) {
  const int format = header.point_format;
  if (header.minor_version >= 4 || format == 0 || format == 2 || format > 5) return std::nullopt;
  bool is_declared = false;
  Bytes descriptions;
  walk_records(file, records_before_points(file, header), [&](const LasRecordHead& record) {
    is_declared = is_declared || (record.user == "lascompatible" && record.id == 22204);
    if (record.user == "LASF_Spec" && record.id == 4) {
      descriptions.resize(record.bytes);
      file.read(record.at, descriptions);
    }
  });
  if (!is_declared) return std::nullopt;
  const auto places = places_of(descriptions);
  const std::uint32_t extra = header.record_bytes - las_format_bytes(format);
  const auto place = [&](std::string_view name) {
    const auto found = places.find(name);
    if (found == places.end() || found->second >= extra) {
      throw Error(
          ErrorCode::invalid_argument,
          "its points are of LAS 1.4, written for older programs, and it does not say where \"" +
              std::string(name) + "\" is among their extra bytes; write the file again as LAS 1.4",
          file.path());
    }
    return found->second;
  };
  return HiddenLas14{place("LAS 1.4 extended returns"), place("LAS 1.4 classification"),
                     place("LAS 1.4 flags and channel")};
}

void show_las14(const HiddenLas14& hidden, std::uint64_t step, std::uint64_t extra,
                std::vector<unsigned char>& records) {
  for (std::uint64_t at = 0; at + step <= records.size(); at += step) {
    unsigned char* const p = &records[at];
    const unsigned char* const more = p + extra;
    const int number = (p[14] & 0x07) + (more[hidden.returns] >> 4);
    const int count = ((p[14] >> 3) & 0x07) + (more[hidden.returns] & 0x0f);
    const int cls = (p[15] & 0x1f) + more[hidden.cls];
    const int flags = p[15] >> 5 | (more[hidden.flags] & 0x01)
                                       << 3;  // synthetic, key point, withheld
    p[14] = static_cast<unsigned char>(std::min(number, 15) | std::min(count, 15) << 4);
    p[15] = static_cast<unsigned char>(flags);
    p[16] = static_cast<unsigned char>(cls & 0xff);
  }
}

}  // namespace ptin
