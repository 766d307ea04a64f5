// SPDX-License-Identifier: GPL-3.0-or-later
#include "storage/record.h"

#include <bit>
#include <cstddef>
#include <cstring>
#include <limits>
#include <type_traits>

#include "storage/box_lanes.h"
#include "storage/layout.h"

namespace ptin {

namespace {

struct Offset {
  std::int32_t x, y;
};

// Coordinates lie in [0, 2^30], so differences fit.
Offset offset_from(GridPoint u, GridPoint p) { return {p.x - u.x, p.y - u.y}; }

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

using lanes::Int4;

// The fields of a record in quadruples. Stored numbers may be anything, so u and an offset are
// added with wrap-around. No sum that wraps is taken for a position on the grid: u is found to be
// on it, so that a sum beyond 2^31 - 1 becomes negative.
struct Quadruples {
  Int4 roi;     // min x, min y, max x, max y
  Int4 values;  // height_lo, height_hi, error, deviation
  Int4 w_vl;    // positions
  Int4 vr_u;
  Int4 unequal;  // any bit set: w, vl or vr is u, or a spare field is not 0
};

Int4 added(Int4 a, Int4 b) {
  using Unsigned4 = std::uint32_t __attribute__((vector_size(16)));
  return std::bit_cast<Int4>(std::bit_cast<Unsigned4>(a) + std::bit_cast<Unsigned4>(b));
}

Quadruples quadruples_of(const layout::NarrowRecord& r) {
  const Int4 u = lanes::lower_twice(lanes::load<Int4>(&r.head.x));
  const auto first = lanes::load<lanes::Short4>(r.reference.data());       // w, vl
  const auto second = lanes::load<lanes::Short4>(r.reference.data() + 4);  // vr, spare
  const auto pairs = lanes::load<Int4>(r.reference.data());  // each reference as one number
  const Int4 spare{0, 0, 0, -1};
  return {lanes::load<Int4>(&r.head.min_x), lanes::load<Int4>(&r.head.height_lo),
          added(u, __builtin_convertvector(first, Int4)),
          added(u, __builtin_convertvector(second, Int4)), (pairs == 0) ^ spare};
}

Quadruples quadruples_of(const layout::WideRecord& r) {
  const Int4 u = lanes::lower_twice(lanes::load<Int4>(&r.head.x));
  const auto first = lanes::load<Int4>(r.reference.data());
  const Int4 second{r.reference[4], r.reference[5], 0, 0};
  const bool equal =
      (first[0] | first[1]) == 0 || (first[2] | first[3]) == 0 || (second[0] | second[1]) == 0;
  return {lanes::load<Int4>(&r.head.min_x), lanes::load<Int4>(&r.head.height_lo), added(u, first),
          added(u, second), Int4{equal ? -1 : 0, 0, 0, 0}};
}

bool is_sound(const Quadruples& q, std::uint16_t flags) {
  const Int4 lo = lanes::lower_twice(q.roi);
  const Int4 hi = lanes::upper_twice(q.roi);
  // Since u lies in it, the roi is not empty either.
  Int4 fault = (q.roi < 0) | (q.roi > kGridMax) | (q.w_vl < lo) | (q.w_vl > hi) | (q.vr_u < lo) |
               (q.vr_u > hi) | q.unequal;
  // Error and deviation are compared as bits: those of negative numbers and NaNs are below 0 or
  // above the bits of infinity.
  constexpr auto kInfinity = static_cast<std::int32_t>(layout::kInfinityBits);
  const Int4 least{INT32_MIN, INT32_MIN, 0, 0};
  const Int4 most{INT32_MAX, INT32_MAX, kInfinity, kInfinity};
  fault |= (q.values < least) | (q.values > most);
  return !lanes::any(fault) && (flags & ~VertexSplit::kAllFlags) == 0;
}

// The members of VertexSplit stand in the order of the quadruples, so that each is stored at once.
static_assert(std::is_trivially_copyable_v<VertexSplit> && sizeof(VertexSplit) == 72 &&
              offsetof(VertexSplit, u) == 0 && offsetof(VertexSplit, w) == 8 &&
              offsetof(VertexSplit, vl) == 16 && offsetof(VertexSplit, vr) == 24 &&
              offsetof(VertexSplit, height) == 32 && offsetof(VertexSplit, roi) == 36 &&
              offsetof(VertexSplit, height_lo) == 52 && offsetof(VertexSplit, deviation) == 64 &&
              offsetof(VertexSplit, rank) == 68 && offsetof(VertexSplit, flags) == 70);

template <class Record>
inline bool decode_as(const std::byte* in, VertexSplit& r) {
  Record record;
  std::memcpy(&record, in, sizeof record);
  const Quadruples q = quadruples_of(record);
  auto* out = reinterpret_cast<std::byte*>(&r);
  std::memcpy(out, &record.head.x, 8);
  std::memcpy(out + 8, &q.w_vl, 16);
  std::memcpy(out + 24, &q.vr_u, 8);
  std::memcpy(out + 32, &record.head.height, 4);
  std::memcpy(out + 36, &q.roi, 16);
  std::memcpy(out + 52, &q.values, 16);
  std::memcpy(out + 68, &record.head.rank, 4);
  return is_sound(q, record.head.flags);
}

template <class Record>
std::size_t decode_all_as(const std::byte* in, std::span<VertexSplit> out) {
  for (std::size_t i = 0; i < out.size(); ++i) {
    if (!decode_as<Record>(in + i * sizeof(Record), out[i])) [[unlikely]] {
      return i;
    }
  }
  return out.size();
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

std::size_t decode_records(std::span<const std::byte> in, RecordKind kind,
                           std::span<VertexSplit> out) noexcept {
  return kind == RecordKind::kNarrow ? decode_all_as<layout::NarrowRecord>(in.data(), out)
                                     : decode_all_as<layout::WideRecord>(in.data(), out);
}

}  // namespace ptin
