// SPDX-License-Identifier: GPL-3.0-or-later
//
// How the points of a LAZ file are compressed, as its record "laszip encoded" says (LASzip's open
// source, laszip.hpp, describes the record).
#pragma once

#include <cstdint>
#include <limits>
#include <span>
#include <string>
#include <vector>

namespace ptin::laz {

/// The number of the record among those of the user "laszip encoded".
inline constexpr std::uint16_t kLayoutRecord = 22204;
inline constexpr const char* kLayoutUser = "laszip encoded";

/// The beginning of a point, as an uncompressed file has it: coordinates, intensity (formats 6 to 10:
/// 0), numbers of returns, flags and class.
inline constexpr std::size_t kRecordBytes = 20;

/// A part of each point that is compressed by itself.
enum class Item : std::uint16_t {
  kBytes = 0,
  kPoint10 = 6,
  kGpsTime11 = 7,
  kRgb12 = 8,
  kWavePacket13 = 9,
  kPoint14 = 10,
  kRgb14 = 11,
  kRgbNir14 = 12,
  kWavePacket14 = 13,
  kBytes14 = 14,
};

/// A plain value.
struct Layout {
  static constexpr std::uint32_t kVaries = std::numeric_limits<std::uint32_t>::max();

  bool is_layered = false;  ///< Formats 6 to 10: each attribute of a chunk by itself.
  bool has_chunks = true;   ///< False: all points are one chunk, and there is no table of chunks.
  std::uint32_t chunk_records = kVaries;  ///< Points of each chunk but the last one, > 0.
  std::uint32_t record_bytes = 0;
  /// Whether extra bytes are handed out, too, behind the beginning of each point (formats 0 to 5).
  bool gives_extra = false;
  struct Part {
    Item item = Item::kBytes;
    std::uint32_t bytes = 0;
  };
  std::vector<Part> parts;  ///< In the order of their bytes.

  /// Bytes of a point that are handed out.
  [[nodiscard]] std::uint32_t given_bytes() const noexcept;
  /// Numbers of bytes that a layered chunk begins with.
  [[nodiscard]] std::uint32_t layers() const noexcept;
};

/// Reads the record, and checks that its parts make up the points of the header.
/// @param format  Of the points, 0 .. 10.
/// @param path    Names the file in errors.
/// @throws Error  unsupported_version  a compressor, or a version of it, that is not known
///                invalid_argument     the record contradicts itself or the header; points of more
///                                     than 4096 bytes
[[nodiscard]] Layout read_layout(std::span<const unsigned char> record, int format,
                                 std::uint32_t record_bytes, const std::string& path);

}  // namespace ptin::laz
