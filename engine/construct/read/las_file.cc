// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/read/las_file.h"

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <map>
#include <utility>
#include <vector>

#include <gdal_priv.h>

#include "engine/construct/grid/gdal_session.h"
#include "engine/construct/laz/las_value.h"
#include "engine/error.h"

namespace ptin {
namespace {

using Bytes = std::vector<unsigned char>;

constexpr std::size_t kHeaderBytes[] = {227, 227, 227, 235, 375};  // by minor version
constexpr int kCompressedBit = 0x80;                               // of the point format
constexpr int kEarlyBit = 0x40;  // likewise: by experimental programs
constexpr std::uint32_t kFormatBytes[] = {20, 28, 26, 34, 57, 63, 30, 36, 38, 59, 67};

[[noreturn]] void refuse_las(const LasFile& file, const std::string& sentence) {
  throw Error(ErrorCode::invalid_argument, sentence, file.path());
}

void check_version(const LasFile& file, int major, int minor) {
  if (major == 1 && minor <= 4) {
    return;
  }
  const std::string version = std::to_string(major) + "." + std::to_string(minor);
  if (major == 1) {
    throw Error(ErrorCode::unsupported_version,
                "this is LAS " + version + "; versions 1.0 to 1.4 are read", file.path());
  }
  refuse_las(file,
             "the header says LAS " + version + ", which does not exist; the file is damaged");
}

void check_format(const LasFile& file, const LasHeader& h) {
  const int format = h.point_format;
  if (h.is_compressed && (format & kEarlyBit) != 0) {
    refuse_las(file,
               "bits 7 and 6 of its point format are set, as experiments before LASzip 1.0 marked "
               "compressed points; these are not read; get the file as LAS, or as LAZ of a later "
               "program");
  }
  if (format > 10) {
    refuse_las(file, "the header names point format " + std::to_string(format) +
                         "; LAS has formats 0 to 10; the file is damaged");
  }
  if (h.record_bytes < kFormatBytes[format]) {
    refuse_las(file, "points of format " + std::to_string(format) + " take at least " +
                         std::to_string(kFormatBytes[format]) + " bytes, and the header says " +
                         std::to_string(h.record_bytes) + "; the file is damaged");
  }
}

void check_lattice(const LasFile& file, const LasHeader& h) {
  for (std::size_t i = 0; i < 3; ++i) {
    // Beyond 10^15 no digit after the point is left in a double.
    const double reach = std::abs(h.offset[i]) + h.scale[i] * 2147483648.0;
    if (!(h.scale[i] > 0) || !(reach < 1e15)) {
      refuse_las(
          file,
          "scale factors must be above 0, and coordinates below 10^15; the header is damaged");
    }
  }
}

/// Of compressed points it is known where they begin; how many there are, their chunks say.
void check_points(const LasFile& file, const LasHeader& h) {
  if (h.first_point < h.header_bytes || (h.points > 0 && h.first_point > file.bytes())) {
    refuse_las(file, "the points are said to begin at byte " + std::to_string(h.first_point) +
                         " of a file of " + std::to_string(file.bytes()) +
                         "; it is damaged or cut off");
  }
  if (h.points == 0 || h.is_compressed) {
    return;
  }
  const std::uint64_t there = (file.bytes() - h.first_point) / h.record_bytes;
  if (there < h.points) {
    refuse_las(file, "the header says " + std::to_string(h.points) + " points and there are " +
                         std::to_string(there) + "; the file is damaged or cut off");
  }
}

std::uint64_t point_count(const Bytes& header, int minor) {
  const auto legacy = las_value<std::uint32_t>(header, 107);
  if (minor < 4) {
    return legacy;
  }
  const auto count = las_value<std::uint64_t>(header, 247);
  return count == 0 ? legacy : count;
}

}  // namespace

LasFile::LasFile(std::string path) : path_(std::move(path)) {
  const GdalSession session;
  errno = 0;
  handle_ = VSIFOpenL(path_.c_str(), "rb");
  if (handle_ == nullptr) {
    VSIStatBufL status;
    if (VSIStatL(path_.c_str(), &status) != 0) {
      throw Error(ErrorCode::not_found, "there is no such file of points", path_);
    }
    throw errno != 0 ? system_error(errno, "cannot open", path_)
                     : Error(ErrorCode::io_error, session.explain("cannot open"), path_);
  }
  VSIFSeekL(handle_, 0, SEEK_END);
  bytes_ = VSIFTellL(handle_);
}

LasFile::~LasFile() {
  const GdalSession session;
  VSIFCloseL(handle_);
}

void LasFile::read(std::uint64_t offset, std::span<unsigned char> into) const {
  const GdalSession session;
  errno = 0;
  if (VSIFSeekL(handle_, offset, SEEK_SET) != 0 ||
      VSIFReadL(into.data(), 1, into.size(), handle_) != into.size()) {
    throw errno != 0
        ? system_error(errno, "cannot read", path_)
        : Error(ErrorCode::io_error, session.explain("the file ends before its points do"), path_);
  }
}

std::uint32_t las_format_bytes(int format) noexcept { return kFormatBytes[format]; }

LasHeader read_las_header(const LasFile& file) {
  Bytes bytes(375);
  const auto there = static_cast<std::size_t>(std::min<std::uint64_t>(file.bytes(), bytes.size()));
  file.read(0, std::span(bytes).first(there));
  if (there < 4 || std::memcmp(bytes.data(), "LASF", 4) != 0) {
    refuse_las(file, "this is no LAS file: it does not begin with 'LASF'");
  }
  LasHeader h;
  if (there >= 26) {
    check_version(file, bytes[24], bytes[25]);
    h.minor_version = bytes[25];
  }
  const std::size_t needed = kHeaderBytes[h.minor_version];
  const auto header_bytes = las_value<std::uint16_t>(bytes, 94);
  if (there < needed || header_bytes < needed) {
    refuse_las(file, "the header is shorter than the " + std::to_string(needed) +
                         " bytes of its version; the file is damaged or cut off");
  }
  h.first_point = las_value<std::uint32_t>(bytes, 96);
  h.record_bytes = las_value<std::uint16_t>(bytes, 105);
  h.points = point_count(bytes, h.minor_version);
  h.header_bytes = header_bytes;
  h.records = las_value<std::uint32_t>(bytes, 100);
  h.legacy_points = las_value<std::uint32_t>(bytes, 107);
  const auto encoding = las_value<std::uint16_t>(bytes, 6);
  h.crs_is_wkt = (encoding & 0x10) != 0;
  h.returns_are_made_up = (encoding & 0x08) != 0;
  if (h.minor_version >= 3 && (encoding & 0x02) != 0) {
    h.first_waveform = las_value<std::uint64_t>(bytes, 227);
  }
  if (h.minor_version >= 4) {
    h.first_extended = las_value<std::uint64_t>(bytes, 235);
    h.extended_records = las_value<std::uint32_t>(bytes, 243);
  }
  h.is_compressed = (bytes[104] & kCompressedBit) != 0;
  h.point_format = h.is_compressed ? bytes[104] - kCompressedBit : bytes[104];
  check_format(file, h);
  for (std::size_t i = 0; i < 3; ++i) {
    h.scale[i] = las_value<double>(bytes, 131 + 8 * i);
    h.offset[i] = las_value<double>(bytes, 155 + 8 * i);
    h.high[i] = las_value<double>(bytes, 179 + 16 * i);
    h.low[i] = las_value<double>(bytes, 187 + 16 * i);
  }
  check_lattice(file, h);
  check_points(file, h);
  return h;
}

}  // namespace ptin
