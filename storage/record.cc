// SPDX-License-Identifier: GPL-3.0-or-later
#include "storage/record.h"

#include <cstring>
#include <limits>

#include "engine/check.h"
#include "storage/layout.h"

namespace ptin {

namespace {

struct Offset {
  std::int32_t x, y;
};

// Coordinates lie in [0, 2^30], so differences fit.
Offset offset_from(GridPoint u, GridPoint p) { return {p.x - u.x, p.y - u.y}; }

// Stored offsets may be anything: the sum wraps instead of overflowing. Nothing wraps onto the
// grid, since u is on it: a sum beyond 2^31 - 1 becomes negative.
GridPoint moved(GridPoint u, std::int32_t dx, std::int32_t dy) {
  return {
      static_cast<std::int32_t>(static_cast<std::uint32_t>(u.x) + static_cast<std::uint32_t>(dx)),
      static_cast<std::int32_t>(static_cast<std::uint32_t>(u.y) + static_cast<std::uint32_t>(dy))};
}

bool fits_narrow(Offset o) {
  using Limits = std::numeric_limits<std::int16_t>;
  return o.x >= Limits::min() && o.x <= Limits::max() && o.y >= Limits::min() &&
         o.y <= Limits::max();
}

layout::RecordHead head_of(const VertexSplit& r) {
  return {r.roi.min_x,
          r.roi.min_y,
          r.roi.max_x,
          r.roi.max_y,
          r.height_lo,
          r.height_hi,
          layout::to_bits(r.error),
          layout::to_bits(r.deviation),
          r.u.x,
          r.u.y,
          r.height,
          r.rank,
          r.flags};
}

template <class Record>
void encode_as(const VertexSplit& r, std::byte* out) {
  using Reference = typename decltype(Record::reference)::value_type;
  Record record{};
  record.head = head_of(r);
  const Offset offsets[3] = {offset_from(r.u, r.w), offset_from(r.u, r.vl), offset_from(r.u, r.vr)};
  for (std::size_t i = 0; i < 3; ++i) {
    record.reference[2 * i] = static_cast<Reference>(offsets[i].x);
    record.reference[2 * i + 1] = static_cast<Reference>(offsets[i].y);
  }
  std::memcpy(out, &record, sizeof record);
}

// Conditions are joined by & throughout: damage is rare, so a branch for each would only cost.
bool is_sound(const GridBox& b) {
  return static_cast<int>(b.min_x >= 0) & static_cast<int>(b.min_y >= 0) &
         static_cast<int>(b.min_x <= b.max_x) & static_cast<int>(b.min_y <= b.max_y) &
         static_cast<int>(b.max_x <= kGridMax) & static_cast<int>(b.max_y <= kGridMax);
}

bool holds_point(const GridBox& b, GridPoint p) {
  return static_cast<int>(b.min_x <= p.x) & static_cast<int>(p.x <= b.max_x) &
         static_cast<int>(b.min_y <= p.y) & static_cast<int>(p.y <= b.max_y);
}

bool differ(GridPoint a, GridPoint b) { return ((a.x ^ b.x) | (a.y ^ b.y)) != 0; }

template <class Record>
bool decode_as(const std::byte* in, VertexSplit& r) {
  Record record;
  std::memcpy(&record, in, sizeof record);
  const layout::RecordHead& h = record.head;
  r.u = {h.x, h.y};
  r.w = moved(r.u, record.reference[0], record.reference[1]);
  r.vl = moved(r.u, record.reference[2], record.reference[3]);
  r.vr = moved(r.u, record.reference[4], record.reference[5]);
  r.height = h.height;
  r.roi = {h.min_x, h.min_y, h.max_x, h.max_y};
  r.height_lo = h.height_lo;
  r.height_hi = h.height_hi;
  r.error = layout::to_float(h.error);
  r.deviation = layout::to_float(h.deviation);
  r.rank = h.rank;
  r.flags = h.flags;
  int sound = is_sound(r.roi) & holds_point(r.roi, r.u) & holds_point(r.roi, r.w) &
              holds_point(r.roi, r.vl) & holds_point(r.roi, r.vr);
  // u is no neighbour of itself: so a page of zeros is no page of records.
  sound &= differ(r.u, r.w) & differ(r.u, r.vl) & differ(r.u, r.vr);
  sound &= static_cast<int>(h.error <= layout::kInfinityBits) &
           static_cast<int>(h.deviation <= layout::kInfinityBits);
  sound &= static_cast<int>((h.flags & ~VertexSplit::kAllFlags) == 0);
  if constexpr (std::is_same_v<Record, layout::NarrowRecord>) {
    sound &= static_cast<int>(record.spare == 0);
  }
  return sound != 0;
}

}  // namespace

RecordKind kind_of(const VertexSplit& r) noexcept {
  const bool narrow = fits_narrow(offset_from(r.u, r.w)) && fits_narrow(offset_from(r.u, r.vl)) &&
                      fits_narrow(offset_from(r.u, r.vr));
  return narrow ? RecordKind::kNarrow : RecordKind::kWide;
}

void encode_record(const VertexSplit& r, RecordKind kind, std::span<std::byte> out) noexcept {
  if (kind == RecordKind::kNarrow) {
    encode_as<layout::NarrowRecord>(r, out.data());
  } else {
    encode_as<layout::WideRecord>(r, out.data());
  }
}

bool decode_record(std::span<const std::byte> in, RecordKind kind, VertexSplit& r) noexcept {
  return kind == RecordKind::kNarrow ? decode_as<layout::NarrowRecord>(in.data(), r)
                                     : decode_as<layout::WideRecord>(in.data(), r);
}

}  // namespace ptin
