// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/raster/tiff_keys.h"

#include <algorithm>
#include <cstdint>
#include <utility>
#include <vector>

#include <cpl_vsi.h>

#include "engine/construct/grid/gdal_session.h"
#include "engine/handle.h"

namespace ptin {

namespace {

using TiffBytes = std::vector<unsigned char>;

constexpr std::uint64_t kMostBytes = std::uint64_t{1} << 24;
constexpr std::uint64_t kMostTags = 4096;

/// Reads a TIFF of either byte order.
class TiffReader {
 public:
  explicit TiffReader(const std::string& path) : file_(VSIFOpenL(path.c_str(), "rb")) {
    const TiffBytes head = file_ ? read(0, 16) : TiffBytes();
    if (head.size() < 16 || head[0] != head[1] || (head[0] != 'I' && head[0] != 'M')) {
      return;
    }
    is_turned_ = head[0] == 'M';
    const std::uint64_t version = value(head, 2, 2);
    is_big_ = version == 43;
    if (version == 42 || version == 43) {
      directory_ = is_big_ ? value(head, 8, 8) : value(head, 4, 4);
    }
  }

  /// The numbers of a tag, or its text, in the byte order of this machine; empty where it is not there.
  [[nodiscard]] TiffBytes content(std::uint16_t tag) const {
    if (directory_ == 0) {
      return {};
    }
    const std::size_t count_bytes = is_big_ ? 8 : 2, entry_bytes = is_big_ ? 20 : 12;
    const std::uint64_t tags = value(read(directory_, count_bytes), 0, count_bytes);
    if (tags > kMostTags) {
      return {};
    }
    const TiffBytes entries = read(directory_ + count_bytes, tags * entry_bytes);
    for (std::size_t at = 0; at + entry_bytes <= entries.size(); at += entry_bytes) {
      if (value(entries, at, 2) == tag) {
        return content_at(entries, at);
      }
    }
    return {};
  }

 private:
  [[nodiscard]] TiffBytes content_at(const TiffBytes& entries, std::size_t at) const {
    constexpr std::uint64_t kDouble = 12, kShort = 3;
    const std::size_t word = is_big_ ? 8 : 4;
    const std::uint64_t type = value(entries, at + 2, 2);
    const std::size_t each = type == kDouble ? 8 : (type == kShort ? 2 : 1);
    const std::uint64_t count = value(entries, at + 4, word);
    if (count > kMostBytes) {  // before it is multiplied, which may overflow
      return {};
    }
    const std::uint64_t bytes = count * each;
    const std::size_t begin = at + 4 + word;
    TiffBytes content;
    if (bytes > word) {
      content = read(value(entries, begin, word), bytes);
    } else {
      const auto first = entries.begin() + static_cast<std::ptrdiff_t>(begin);
      content.assign(first, first + static_cast<std::ptrdiff_t>(bytes));
    }
    for (std::size_t i = 0; is_turned_ && i + each <= content.size(); i += each) {
      std::reverse(content.data() + i, content.data() + i + each);
    }
    return content;
  }

  /// Bytes of the file; none where they are not all there.
  [[nodiscard]] TiffBytes read(std::uint64_t offset, std::uint64_t bytes) const {
    if (bytes > kMostBytes || VSIFSeekL(file_.get(), offset, SEEK_SET) != 0) {
      return {};
    }
    TiffBytes into(bytes);
    return VSIFReadL(into.data(), 1, bytes, file_.get()) == bytes ? into : TiffBytes();
  }

  [[nodiscard]] std::uint64_t value(const TiffBytes& from, std::size_t at,
                                    std::size_t bytes) const {
    std::uint64_t number = 0;
    for (std::size_t i = 0; at + bytes <= from.size() && i < bytes; ++i) {
      const std::size_t place = is_turned_ ? i : bytes - 1 - i;  // the greatest byte first
      number = number << 8 | from[at + place];
    }
    return number;
  }

  Handle<VSILFILE, &VSIFCloseL> file_;
  std::uint64_t directory_ = 0;  ///< Where the first directory is; 0 where there is none.
  bool is_big_ = false;          ///< BigTIFF: offsets of 64 bits.
  bool is_turned_ = false;       ///< The greatest byte of a number comes first.
};

}  // namespace

GeoTiffKeys keys_of_tiff(const std::string& path) {
  const GdalSession session;
  const TiffReader tiff(path);
  GeoTiffKeys keys;
  if (keys.directory = tiff.content(34735); !keys.directory.empty()) {
    keys.doubles = tiff.content(34736);
    keys.text = tiff.content(34737);
  }
  return keys;
}

}  // namespace ptin
