// SPDX-License-Identifier: GPL-3.0-or-later
//
// LAS files made for tests, byte by byte from the specification.
#pragma once

#include <array>
#include <cstdint>
#include <cstring>
#include <string>
#include <vector>

namespace ptin {

struct LasPoint {
  std::int32_t x = 0, y = 0, z = 0;
  int cls = 2;
  bool withheld = false;
  int number = 1, returns = 1;  ///< The how manyth echo of its pulse, and how many that has.
};

struct LasRecord {
  std::uint16_t id = 0;
  std::string content;
  bool extended = false;  ///< Behind the points (1.4).
  std::string user = "LASF_Projection";
};

/// A LAS file to be. Fields are what the header says; change them to make a damaged one.
struct LasFileMaker {
  int major = 1, minor = 2, format = 0;
  int extra_bytes = 0;
  std::array<double, 3> scale{0.01, 0.01, 0.01}, offset{};
  bool wkt_bit = false;
  std::vector<LasRecord> records;
  std::vector<LasPoint> points;

  [[nodiscard]] std::string bytes() const {
    static constexpr int kHeader[] = {227, 227, 227, 235, 375};
    static constexpr int kFormat[] = {20, 28, 26, 34, 57, 63, 30, 36, 38, 59, 67};
    const int header_bytes = kHeader[minor];
    const int record_bytes = kFormat[format] + extra_bytes;
    std::string file(static_cast<std::size_t>(header_bytes), '\0');
    std::string tail;
    std::uint32_t before = 0, behind = 0;
    for (const LasRecord& r : records) {
      (r.extended ? tail : file) += record_head(r) + r.content;
      ++(r.extended ? behind : before);
    }
    const auto first = static_cast<std::uint32_t>(file.size());
    for (const LasPoint& p : points) {
      file += point(p, record_bytes);
    }
    std::memcpy(file.data(), "LASF", 4);
    put<std::uint16_t>(file, 6, wkt_bit ? 16 : 0);
    file[24] = static_cast<char>(major);
    file[25] = static_cast<char>(minor);
    put<std::uint16_t>(file, 94, static_cast<std::uint16_t>(header_bytes));
    put<std::uint32_t>(file, 96, first);
    put<std::uint32_t>(file, 100, before);
    file[104] = static_cast<char>(format);
    put<std::uint16_t>(file, 105, static_cast<std::uint16_t>(record_bytes));
    put<std::uint32_t>(file, 107, minor < 4 ? static_cast<std::uint32_t>(points.size()) : 0);
    for (std::size_t i = 0; i < 3; ++i) {
      put<double>(file, 131 + 8 * i, scale[i]);
      put<double>(file, 155 + 8 * i, offset[i]);
    }
    if (minor == 4) {
      put<std::uint64_t>(file, 235, file.size());
      put<std::uint32_t>(file, 243, behind);
      put<std::uint64_t>(file, 247, points.size());
    }
    return file + tail;
  }

 private:
  template <class T>
  static void put(std::string& to, std::size_t at, T value) {
    std::memcpy(to.data() + at, &value, sizeof value);
  }
  static std::string record_head(const LasRecord& r) {
    std::string head(r.extended ? 60 : 54, '\0');
    std::memcpy(head.data() + 2, r.user.data(), r.user.size());
    put<std::uint16_t>(head, 18, r.id);
    if (r.extended) {
      put<std::uint64_t>(head, 20, r.content.size());
    } else {
      put<std::uint16_t>(head, 20, static_cast<std::uint16_t>(r.content.size()));
    }
    return head;
  }
  [[nodiscard]] std::string point(const LasPoint& p, int bytes) const {
    std::string record(static_cast<std::size_t>(bytes), '\x5a');
    put(record, 0, p.x);
    put(record, 4, p.y);
    put(record, 8, p.z);
    if (format < 6) {
      record[14] = static_cast<char>(p.number | p.returns << 3 | 0xc0);
      record[15] = static_cast<char>(p.cls | (p.withheld ? 0x80 : 0) | 0x40);
    } else {
      record[14] = static_cast<char>(p.number | p.returns << 4);
      record[15] = static_cast<char>(p.withheld ? 0x0c : 0x08);
      record[16] = static_cast<char>(p.cls);
    }
    return record;
  }
};

}  // namespace ptin
