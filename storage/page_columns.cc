// SPDX-License-Identifier: GPL-3.0-or-later
#include "storage/page_columns.h"

#include <algorithm>
#include <cstring>

#include "storage/box_lanes.h"
#include "storage/short_float.h"

namespace ptin {

namespace {

/// Bits of a number of units of an interval.
constexpr unsigned kMostUnitBits = std::bit_width(kMostIntervalUnits - 1);

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
  const unsigned width = width_[c];
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

void PageColumns::read_errors(const std::byte* page, std::size_t first,
                              std::span<std::uint64_t> out) const noexcept {
  const std::size_t end = place(page, error_runs_, (records() - 1) / layout::kErrorRun + 1);
  std::size_t at = place(page, error_runs_, first / layout::kErrorRun);
  std::fill(out.begin(), out.end(), kNoShort);
  const auto column = static_cast<std::size_t>(PageColumn::kError);
  const unsigned low_bits = width_[column];
  std::size_t low = begin_[column] + first * low_bits;
  std::size_t i = 0;
  while (i < out.size() && at < end) {
    // A load holds 57 places; those beyond the last one are no errors, whatever follows there.
    const std::size_t places = std::min<std::size_t>(kMostFieldBits, end - at);
    std::uint64_t word = read_bits(page, error_places_ * 8 + at, static_cast<unsigned>(places));
    for (; word != 0 && i < out.size(); word &= word - 1, ++i, low += low_bits) {
      const std::size_t place = at + static_cast<std::size_t>(std::countr_zero(word));
      const std::uint64_t below =
          (place - (first + i)) << low_bits | read_bits(page, low, low_bits);
      // A place before the record's number wraps around, and is beyond the first error like any other.
      out[i] = below <= header_.error ? header_.error - below : kNoShort;
    }
    at += places;
  }
}

ErrorsCode code_of_errors(std::uint32_t range, std::size_t records) noexcept {
  ErrorsCode best{0, records + range};
  for (unsigned low = 1; low <= kMostShortWidth; ++low) {
    const std::size_t places = records + (range >> low);
    if (records * low + places < records * best.low_bits + best.place_bits) {
      best = {low, places};
    }
  }
  return best;
}

std::size_t error_place_bytes(std::size_t records, std::size_t place_bits) noexcept {
  // The place of each run, and behind the last one the number of all places.
  const std::size_t runs = (records + layout::kErrorRun - 1) / layout::kErrorRun + 1;
  return runs * sizeof(std::uint16_t) + bytes_of_bits(place_bits);
}

std::array<std::uint32_t, kPageColumns> bases_of(const layout::PageHeader& h) noexcept {
  return {
      h.x,           h.y,           h.height,     0,      0, 0, 0, 0, 0, 0, 0, h.rank, 0, h.degree,
      h.offset_bits, h.height_bits, h.death_bits, h.shift};
}

std::array<std::uint8_t, kPageColumns> widths_of(const layout::PageHeader& h) noexcept {
  std::array<std::uint8_t, kPageColumns> width{};
  std::copy(h.width.begin(), h.width.end(), width.begin());
  width[static_cast<std::size_t>(PageColumn::kShift)] = h.shift_width;
  return width;
}

std::size_t column_bytes(const std::array<std::uint8_t, kPageColumns>& width,
                         std::size_t records) noexcept {
  std::size_t bytes = (records + layout::kRingRun - 1) / layout::kRingRun * sizeof(std::uint16_t);
  for (const std::uint8_t w : width) {
    bytes += bytes_of_bits(records * w);
  }
  return bytes;
}

bool PageColumns::read(std::span<const std::byte> page, const PageForm& form) noexcept {
  std::memcpy(&header_, page.data(), sizeof header_);
  const layout::PageHeader& header = header_;
  width_ = widths_of(header);
  descends_ = !form.is_plain();
  const bool widths_fit =
      std::equal(width_.begin(), width_.end(), kMostColumnBits.begin(),
                 [](std::uint8_t width, std::uint8_t most) { return width <= most; });
  const bool form_fits =
      form.is_plain() ? header.shift == 0 && header.shift_width == 0 && header.flags == 0
                      : (header.flags & ~layout::kLocalPage) == 0 &&
                            header.shift + (1U << std::min<unsigned>(header.shift_width, 6)) <=
                                kMostShift + 1 &&
                            width(PageColumn::kBelow) <= kMostUnitBits &&
                            width(PageColumn::kAbove) <= kMostUnitBits &&
                            header.error <= kShortInfinity && (!is_local() || form.has_floor);
  if (header.records == 0 || header.records > page.size() / layout::kLeastRecordBytes ||
      !widths_fit || header.void_bits > 1 || header.no_height_bits > 1 || !form_fits) {
    return false;
  }
  base_ = bases_of(header);
  std::size_t at = sizeof header;
  for (std::size_t c = 0; c < kPageColumns; ++c) {
    begin_[c] = static_cast<std::uint32_t>(at * 8);
    at += bytes_of_bits(std::size_t{header.records} * width_[c]);
  }
  runs_ = at;
  rings_ = sizeof header + column_bytes(width_, header.records);
  common_bits_ = 0U + header.void_bits + header.no_height_bits;
  return (!descends_ || read_errors_frame(page)) &&
         rings_ + header.ring_bytes + layout::kPageTailBytes <= page.size();
}

/// Finds the places of errors, which lie between those of runs and the rings.
bool PageColumns::read_errors_frame(std::span<const std::byte> page) noexcept {
  error_runs_ = rings_;
  error_places_ = error_runs_ + error_place_bytes(header_.records, 0);
  if (error_places_ > page.size()) {
    return false;
  }
  const std::size_t places =
      place(page.data(), error_runs_, (header_.records - 1U) / layout::kErrorRun + 1);
  rings_ = error_places_ + bytes_of_bits(places);
  return true;
}

}  // namespace ptin
