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
#include "engine/error.h"

namespace ptin {
namespace {

using Bytes = std::vector<unsigned char>;

constexpr std::size_t kHeaderBytes[] = {227, 227, 227, 235, 375};  // by minor version
constexpr std::uint32_t kFormatBytes[] = {20, 28, 26, 34, 57, 63, 30, 36, 38, 59, 67};
constexpr std::uint64_t kMostRecords = 65536;  // variable length records that are looked at
constexpr std::uint64_t kMostCrsBytes = std::uint64_t{1} << 24;

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

void check_format(const LasFile& file, const LasHeader& h, int format) {
  if ((format & 0xc0) != 0) {
    refuse_las(file,
               "this is compressed (LAZ); unpack it first, with 'laszip -i IN.laz -o OUT.las' or "
               "'pdal translate IN.laz OUT.las'");
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

void check_points(const LasFile& file, const LasHeader& h, std::uint64_t header_bytes) {
  if (h.first_point < header_bytes || (h.points > 0 && h.first_point > file.bytes())) {
    refuse_las(file, "the points are said to begin at byte " + std::to_string(h.first_point) +
                         " of a file of " + std::to_string(file.bytes()) +
                         "; it is damaged or cut off");
  }
  if (h.points == 0) {
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

// ---------------------------------------------------------------------------------------------------
// The CRS.

struct CrsRecords {
  std::string wkt;
  Bytes keys, doubles, text;
};

/// Reads the content of a record if it declares the CRS: as WKT (2112), or as GeoTIFF keys (34735)
/// with their doubles (34736) and text (34737).
/// @param head       The header of the record.
/// @param at, bytes  Where its content lies in the file.
void take_record(const LasFile& file, std::span<const unsigned char> head, std::uint64_t at,
                 std::uint64_t bytes, CrsRecords& crs) {
  if (at > file.bytes() || bytes > file.bytes() - at) {
    refuse_las(file,
               "a record before or behind the points reaches beyond the end of the file; it is "
               "damaged or cut off");
  }
  const char* user = reinterpret_cast<const char*>(head.data()) + 2;
  if (std::string(user, strnlen(user, 16)) != "LASF_Projection" || bytes > kMostCrsBytes) {
    return;
  }
  Bytes content(bytes);
  file.read(at, content);
  switch (las_value<std::uint16_t>(head, 18)) {
    case 2112:
      crs.wkt.assign(content.begin(), std::find(content.begin(), content.end(), '\0'));
      break;
    case 34735:
      crs.keys = std::move(content);
      break;
    case 34736:
      crs.doubles = std::move(content);
      break;
    case 34737:
      crs.text = std::move(content);
      break;
    default:
      break;
  }
}

/// Walks `count` records from byte `at` on. Extended records have lengths of 64 bits.
void walk_records(const LasFile& file, std::uint64_t at, std::uint64_t count, bool extended,
                  CrsRecords& crs) {
  const std::size_t head_bytes = extended ? 60 : 54;
  Bytes head(head_bytes);
  for (std::uint64_t i = 0; i < std::min(count, kMostRecords); ++i) {
    if (at > file.bytes() || head_bytes > file.bytes() - at) {
      refuse_las(file, "the header says " + std::to_string(count) +
                           " records beside the points and " + std::to_string(i) +
                           " are there; the file is damaged or cut off");
    }
    file.read(at, head);
    at += head_bytes;
    const std::uint64_t bytes =
        extended ? las_value<std::uint64_t>(head, 20) : las_value<std::uint16_t>(head, 20);
    take_record(file, head, at, bytes, crs);
    at += bytes;
  }
}

/// A TIFF of one pixel that holds the GeoTIFF keys of a LAS file: GDAL opens it, and so tells what
/// the keys mean.
class KeyTiff {
 public:
  explicit KeyTiff(const CrsRecords& crs) {
    add(256, 3, 1, 1);
    add(257, 3, 1, 1);
    add(258, 3, 1, 8);
    add(259, 3, 1, 1);
    add(262, 3, 1, 1);
    add(273, 4, 1, 8);  // the pixel: a byte of padding in the header
    add(277, 3, 1, 1);
    add(278, 3, 1, 1);
    add(279, 4, 1, 1);
    add(34735, 3, crs.keys.size() / 2, crs.keys);
    if (!crs.doubles.empty()) {
      add(34736, 12, crs.doubles.size() / 8, crs.doubles);
    }
    if (!crs.text.empty()) {
      add(34737, 2, crs.text.size(), crs.text);
    }
  }

  [[nodiscard]] Bytes bytes() const {
    Bytes file = {'I', 'I', 42, 0, 16, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0};
    const std::size_t data_begin = 16 + 2 + entries_.size() * 12 + 4;
    put(file, entries_.size(), 2);
    Bytes data;
    for (const Entry& e : entries_) {
      put(file, e.tag, 2);
      put(file, e.type, 2);
      put(file, e.count, 4);
      if (e.data.size() <= 4) {
        Bytes value = e.data;
        value.resize(4);
        file.insert(file.end(), value.begin(), value.end());
      } else {
        data.resize((data.size() + 7) / 8 * 8);
        put(file, data_begin + data.size(), 4);
        data.insert(data.end(), e.data.begin(), e.data.end());
      }
    }
    put(file, 0, 4);
    file.insert(file.end(), data.begin(), data.end());
    return file;
  }

 private:
  struct Entry {
    std::uint64_t tag, type, count;
    Bytes data;
  };
  static void put(Bytes& to, std::uint64_t value, int bytes) {
    for (int i = 0; i < bytes; ++i) {
      to.push_back(static_cast<unsigned char>(value >> (8 * i)));
    }
  }
  void add(std::uint64_t tag, std::uint64_t type, std::uint64_t count, const Bytes& data) {
    entries_.push_back({tag, type, count, data});
  }
  void add(std::uint64_t tag, std::uint64_t type, std::uint64_t count, std::uint64_t value) {
    Bytes data;
    put(data, value, 4);
    entries_.push_back({tag, type, count, data});
  }
  std::vector<Entry> entries_;
};

std::string wkt_of_keys(const LasFile& file, const CrsRecords& crs) {
  if (crs.keys.size() < 8 ||
      crs.keys.size() < 8 + std::size_t{las_value<std::uint16_t>(crs.keys, 6)} * 8) {
    refuse_las(file, "its GeoTIFF keys are cut off; name the CRS with --a-srs instead");
  }
  Bytes tiff = KeyTiff(crs).bytes();
  const GdalSession session;
  static constexpr const char* kDriver[] = {"GTiff", nullptr};
  char name[64];
  std::snprintf(name, sizeof name, "/vsimem/ptin_las_keys_%p.tif", static_cast<void*>(&tiff));
  VSIFCloseL(VSIFileFromMemBuffer(name, tiff.data(), tiff.size(), FALSE));
  std::string wkt;
  {
    const GDALDatasetUniquePtr data(
        GDALDataset::Open(name, GDAL_OF_RASTER | GDAL_OF_READONLY, kDriver));
    wkt = data == nullptr ? "" : data->GetProjectionRef();
  }
  VSIUnlink(name);
  return wkt;
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
  check_format(file, h, bytes[104]);
  h.point_format = bytes[104];
  for (std::size_t i = 0; i < 3; ++i) {
    h.scale[i] = las_value<double>(bytes, 131 + 8 * i);
    h.offset[i] = las_value<double>(bytes, 155 + 8 * i);
  }
  check_lattice(file, h);
  check_points(file, h, header_bytes);
  return h;
}

std::string read_las_crs(const LasFile& file) {
  Bytes bytes(375);
  const auto there = static_cast<std::size_t>(std::min<std::uint64_t>(file.bytes(), bytes.size()));
  file.read(0, std::span(bytes).first(there));
  CrsRecords crs;
  walk_records(file, las_value<std::uint16_t>(bytes, 94), las_value<std::uint32_t>(bytes, 100),
               false, crs);
  if (bytes[25] >= 4) {
    walk_records(file, las_value<std::uint64_t>(bytes, 235), las_value<std::uint32_t>(bytes, 243),
                 true, crs);
  }
  const bool wkt_first = (las_value<std::uint16_t>(bytes, 6) & 0x10) != 0 || crs.keys.empty();
  return wkt_first && !crs.wkt.empty() ? crs.wkt : (crs.keys.empty() ? "" : wkt_of_keys(file, crs));
}

}  // namespace ptin
