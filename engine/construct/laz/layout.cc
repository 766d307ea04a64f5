// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/laz/layout.h"

#include <algorithm>
#include <iterator>

#include "engine/construct/laz/las_value.h"
#include "engine/error.h"

namespace ptin::laz {

namespace {

constexpr std::size_t kHeadBytes = 34, kPartBytes = 6;
constexpr std::uint32_t kMostRecordBytes = 4096;  // Each extra byte has a model of 1 KiB.

/// The compressors of the record; 0 is none.
enum Compressor : std::uint16_t { kPointWise = 1, kPointWiseChunked = 2, kLayeredChunked = 3 };

/// What is known of a kind of part.
struct KnownItem {
  std::uint32_t bytes;  ///< 0: any number.
  Item item;
  std::uint16_t first_version, last_version;
  bool is_layered;
};
constexpr KnownItem kKnown[] = {
    {20, Item::kPoint10, 2, 2, false},     {8, Item::kGpsTime11, 2, 2, false},
    {6, Item::kRgb12, 2, 2, false},        {29, Item::kWavePacket13, 1, 1, false},
    {0, Item::kBytes, 2, 2, false},        {30, Item::kPoint14, 2, 4, true},
    {6, Item::kRgb14, 2, 4, true},         {8, Item::kRgbNir14, 2, 4, true},
    {29, Item::kWavePacket14, 2, 4, true}, {0, Item::kBytes14, 2, 4, true},
};

/// The place of a part in a point: that of kKnown.
std::ptrdiff_t order_of(Item item) {
  const auto* const found = std::find_if(std::begin(kKnown), std::end(kKnown),
                                         [&](const KnownItem& k) { return k.item == item; });
  return found - std::begin(kKnown);
}

[[noreturn]] void refuse_version(const std::string& what, const std::string& path) {
  throw Error(ErrorCode::unsupported_version,
              "the points are compressed by " + what +
                  ", which is not read; write the file again with a newer LASzip, or uncompressed",
              path);
}

[[noreturn]] void refuse_record(const std::string& fault, const std::string& path) {
  throw Error(ErrorCode::invalid_argument,
              "the record that says how the points are compressed " + fault +
                  "; the file is damaged, or its header says by mistake that it is compressed",
              path);
}

Layout::Part part_of(std::span<const unsigned char> bytes, bool is_layered,
                     const std::string& path) {
  const auto type = las_value<std::uint16_t>(bytes, 0);
  const auto size = las_value<std::uint16_t>(bytes, 2);
  const auto version = las_value<std::uint16_t>(bytes, 4);
  const std::ptrdiff_t known = order_of(static_cast<Item>(type));
  if (known == std::ssize(kKnown)) {
    refuse_version("parts of kind " + std::to_string(type), path);
  }
  const KnownItem& item = kKnown[known];
  if (version < item.first_version || version > item.last_version) {
    refuse_version(
        "version " + std::to_string(version) + " of parts of kind " + std::to_string(type), path);
  }
  if (item.is_layered != is_layered || size == 0 || (item.bytes != 0 && size != item.bytes)) {
    refuse_record("has a part of kind " + std::to_string(type) + " of " + std::to_string(size) +
                      " bytes, which its compressor has not",
                  path);
  }
  return {item.item, size};
}

/// The parts are in the order of the point's bytes, none comes twice, and they are the point.
void check_parts(const Layout& layout, int format, const std::string& path) {
  std::uint32_t bytes = 0;
  std::ptrdiff_t last = -1;
  for (const Layout::Part& part : layout.parts) {
    const std::ptrdiff_t order = order_of(part.item);
    if (order <= last) {
      refuse_record("has its parts in another order than points have them", path);
    }
    last = order;
    bytes += part.bytes;
  }
  const Item first = format < 6 ? Item::kPoint10 : Item::kPoint14;
  if (bytes != layout.record_bytes) {
    refuse_record("does not fit: its parts make " + std::to_string(bytes) +
                      " bytes of a point, and the header says " +
                      std::to_string(layout.record_bytes),
                  path);
  }
  if (layout.parts[0].item != first) {
    refuse_record("is not of points of format " + std::to_string(format), path);
  }
}

}  // namespace

std::uint32_t Layout::layers() const noexcept {
  std::uint32_t count = 0;
  for (const Part& part : parts) {
    switch (part.item) {
      case Item::kPoint14:
        count += 9;
        break;
      case Item::kRgbNir14:
        count += 2;
        break;
      case Item::kBytes14:
        count += part.bytes;
        break;
      default:
        count += 1;
        break;
    }
  }
  return count;
}

std::uint32_t Layout::given_bytes() const noexcept {
  const bool has_extra = gives_extra && !parts.empty() && parts.back().item == Item::kBytes;
  return static_cast<std::uint32_t>(kRecordBytes) + (has_extra ? parts.back().bytes : 0);
}

Layout read_layout(std::span<const unsigned char> record, int format, std::uint32_t record_bytes,
                   const std::string& path) {
  if (record.size() < kHeadBytes) {
    refuse_record(record.empty() ? "is not there" : "is cut", path);
  }
  const auto compressor = las_value<std::uint16_t>(record, 0);
  const auto coder = las_value<std::uint16_t>(record, 2);
  if (compressor == 0) {
    refuse_record("names no compressor", path);
  }
  if (compressor > kLayeredChunked || coder != 0) {
    refuse_version("compressor " + std::to_string(compressor) + ", coder " + std::to_string(coder),
                   path);
  }
  if (record_bytes > kMostRecordBytes) {
    throw Error(ErrorCode::invalid_argument,
                "compressed points of more than " + std::to_string(kMostRecordBytes) +
                    " bytes are not read; write the file uncompressed",
                path);
  }
  Layout layout;
  layout.is_layered = compressor == kLayeredChunked;
  layout.has_chunks = compressor != kPointWise;
  layout.record_bytes = record_bytes;
  layout.chunk_records = las_value<std::uint32_t>(record, 12);
  const auto parts = las_value<std::uint16_t>(record, 32);
  if (layout.chunk_records == 0) {
    refuse_record("says that a chunk has no points", path);
  }
  if (record.size() < kHeadBytes + parts * kPartBytes) {
    refuse_record("has not room for its " + std::to_string(parts) + " parts", path);
  }
  for (std::size_t i = 0; i < parts; ++i) {
    layout.parts.push_back(
        part_of(record.subspan(kHeadBytes + i * kPartBytes, kPartBytes), layout.is_layered, path));
  }
  check_parts(layout, format, path);
  return layout;
}

}  // namespace ptin::laz
