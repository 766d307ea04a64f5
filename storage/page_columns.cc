// SPDX-License-Identifier: GPL-3.0-or-later
#include "storage/page_columns.h"

#include <algorithm>
#include <cstring>

#include "storage/box_lanes.h"
#include "storage/short_float.h"

namespace ptin {

namespace {

constexpr std::size_t bytes_of_bits(std::size_t bits) { return (bits + 7) / 8; }

/// Takes numbers of a width apart, `kTogether` of them out of one load, and two by one operation.
template <unsigned kTogether>
void take_apart(const std::byte* page, std::size_t bit, unsigned width, std::uint64_t base,
                std::span<std::uint64_t> out) noexcept {
  using lanes::Unsigned2;
  static_assert(kTogether % 2 == 0);
  const std::uint64_t mask = (std::uint64_t{1} << width) - 1;
  const Unsigned2 bases{base, base}, masks{mask, mask};
  std::size_t i = 0;
  for (; i + kTogether <= out.size(); i += kTogether, bit += std::size_t{kTogether} * width) {
    const std::uint64_t word = read_bits(page, bit, kMostFieldBits);
    Unsigned2 pair{word, word >> width};
    for (unsigned k = 0; k < kTogether; k += 2, pair >>= 2 * width) {
      const Unsigned2 numbers = bases + (pair & masks);
      std::memcpy(&out[i + k], &numbers, sizeof numbers);
    }
  }
  for (; i < out.size(); ++i, bit += width) {
    out[i] = base + read_bits(page, bit, width);
  }
}

/// Takes numbers of a width apart one by one.
void take_singly(const std::byte* page, std::size_t bit, unsigned width, std::uint64_t base,
                 std::span<std::uint64_t> out) noexcept {
  for (std::uint64_t& number : out) {
    number = base + read_bits(page, bit, width);
    bit += width;
  }
}

}  // namespace

void PageColumns::read_run(const std::byte* page, PageColumn column, std::size_t first,
                           std::span<std::uint64_t> out) const noexcept {
  const auto c = static_cast<std::size_t>(column);
  const unsigned width = header_.width[c];
  const std::size_t bit = begin_[c] + first * width;
  if (width == 0) {
    std::fill(out.begin(), out.end(), base_[c]);
  } else if (width * 8 <= kMostFieldBits) {
    take_apart<8>(page, bit, width, base_[c], out);
  } else if (width * 4 <= kMostFieldBits) {
    take_apart<4>(page, bit, width, base_[c], out);
  } else if (width * 2 <= kMostFieldBits) {
    take_apart<2>(page, bit, width, base_[c], out);
  } else {
    take_singly(page, bit, width, base_[c], out);
  }
}

std::array<std::uint32_t, kPageColumns> bases_of(const layout::PageHeader& h) noexcept {
  return {h.x,      h.y,           h.height,      0,           0, 0, 0, 0, 0, 0, 0, h.rank, 0,
          h.degree, h.offset_bits, h.height_bits, h.death_bits};
}

std::size_t column_bytes(const std::array<std::uint8_t, kPageColumns>& width,
                         std::size_t records) noexcept {
  std::size_t bytes = (records + layout::kRingRun - 1) / layout::kRingRun * sizeof(std::uint16_t);
  for (const std::uint8_t w : width) {
    bytes += bytes_of_bits(records * w);
  }
  return bytes;
}

bool PageColumns::read(const layout::PageHeader& header, std::size_t page_bytes) noexcept {
  header_ = header;
  const bool widths_fit =
      std::equal(header.width.begin(), header.width.end(), kMostColumnBits.begin(),
                 [](std::uint8_t width, std::uint8_t most) { return width <= most; });
  if (header.records == 0 || header.records > page_bytes / layout::kLeastRecordBytes ||
      !widths_fit || header.void_bits > 1 || header.no_height_bits > 1 ||
      header.reserved != decltype(header.reserved){}) {
    return false;
  }
  base_ = bases_of(header);
  std::size_t at = sizeof header;
  for (std::size_t c = 0; c < kPageColumns; ++c) {
    begin_[c] = static_cast<std::uint32_t>(at * 8);
    at += bytes_of_bits(std::size_t{header.records} * header.width[c]);
  }
  runs_ = at;
  rings_ = sizeof header + column_bytes(header.width, header.records);
  common_bits_ = 0U + header.void_bits + header.no_height_bits;
  return rings_ + header.ring_bytes + layout::kPageTailBytes <= page_bytes;
}

}  // namespace ptin
