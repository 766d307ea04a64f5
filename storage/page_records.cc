// SPDX-License-Identifier: GPL-3.0-or-later
#include "storage/page_records.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <limits>
#include <type_traits>

#include "engine/error.h"
#include "storage/box_lanes.h"
#include "storage/short_float.h"

namespace ptin {

namespace {

using lanes::Int4;

// The lanes of Int4 as numbers of the type in which heights are stored. Errors and deviations may
// be compared as either type: they are not negative, so their bits have the same order as their
// values.
template <class Code>
using Lanes = std::conditional_t<std::is_same_v<Code, float>, lanes::Float4, Int4>;

// The bounds that a page's descriptor sets for its records. `Code` is the type in which heights are
// stored.
template <class Code>
class Bounds {
 public:
  explicit Bounds(const layout::NodeEntry& e) : box_(lanes::load<Int4>(&e.min_x)) {
    const auto lane = [](auto bits) { return std::bit_cast<Code>(bits); };
    const auto bound = [&](ShortBits bits) { return lane(layout::to_bits(short_value(bits))); };
    least_ = Lanes<Code>{lane(e.height_lo), least_code(), bound(e.error_min), Code{0}};
    most_ = Lanes<Code>{most_code(), lane(e.height_hi), bound(e.error_max), bound(e.deviation_max)};
  }

  [[nodiscard]] bool excludes(const VertexSplit& r) const {
    const auto roi = lanes::load<Int4>(&r.roi.min_x);
    const Int4 minima{-1, -1, 0, 0};
    const Int4 outside = ((roi < box_) & minima) | ((roi > box_) & ~minima);
    const auto values = lanes::load<Lanes<Code>>(&r.height_lo);
    // Both comparisons are false for a NaN, so that a NaN is not within the bounds.
    const Int4 within = (values >= least_) & (values <= most_);
    // An empty interval of heights (lo > hi) lies in every interval.
    const std::int32_t is_empty = values[0] > values[1] ? -1 : 0;
    const Int4 excused{is_empty, is_empty, 0, 0};
    const auto height = std::bit_cast<Code>(r.height);
    const bool is_nan = !(height == height);  // NOLINT(misc-redundant-expression)
    return lanes::any(outside | ~(within | excused)) || is_nan;
  }

 private:
  static constexpr Code least_code() {
    using Limits = std::numeric_limits<Code>;
    return Limits::has_infinity ? -Limits::infinity() : Limits::lowest();
  }
  static constexpr Code most_code() {
    using Limits = std::numeric_limits<Code>;
    return Limits::has_infinity ? Limits::infinity() : Limits::max();
  }

  Int4 box_;
  Lanes<Code> least_, most_;
};

template <class Code>
std::size_t first_excluded(const Bounds<Code>& bounds, std::span<const VertexSplit> records) {
  for (std::size_t i = 0; i < records.size(); ++i) {
    if (bounds.excludes(records[i])) [[unlikely]] {
      return i;
    }
  }
  return records.size();
}

}  // namespace

RecordPage::RecordPage(std::span<const std::byte> bytes, const HeightEncoding& heights) noexcept
    : bytes_(bytes), heights_(heights) {
  layout::PageHeader header;
  if (bytes.size() >= layout::kMinPageBytes) {
    std::memcpy(&header, bytes.data(), sizeof header);
    is_sound_ = columns_.read(header, bytes.size());
  }
}

GridBox RecordPage::roi(std::size_t i) const noexcept {
  // Columns hold at most 32 bits, so sums fit 64. What leaves the grid is cut down to 32 bits, and
  // lies off the grid still, or is found to be no roi of u.
  const auto at = [&](PageColumn c) { return static_cast<std::int64_t>(number(c, i)); };
  const std::int64_t x = at(PageColumn::kX);
  const std::int64_t y = at(PageColumn::kY);
  const auto whole = [](std::int64_t v) {
    return static_cast<std::int32_t>(std::clamp<std::int64_t>(v, INT32_MIN, INT32_MAX));
  };
  return {whole(x - at(PageColumn::kWest)), whole(y - at(PageColumn::kSouth)),
          whole(x + at(PageColumn::kEast)), whole(y + at(PageColumn::kNorth))};
}

/// Looks at the roi only where u is no farther from the box than any roi of the page reaches.
std::uint32_t RecordPage::next_near(std::uint32_t i, const GridBox& box) const noexcept {
  const auto reach = [&](PageColumn c) {
    return static_cast<std::int64_t>(
        (std::uint64_t{1} << columns_.header().width[static_cast<std::size_t>(c)]) - 1);
  };
  const std::int64_t low_x = box.min_x - reach(PageColumn::kEast);
  const std::int64_t high_x = box.max_x + reach(PageColumn::kWest);
  const std::int64_t low_y = box.min_y - reach(PageColumn::kNorth);
  const std::int64_t high_y = box.max_y + reach(PageColumn::kSouth);
  for (; i < records(); ++i) {
    const auto x = static_cast<std::int64_t>(number(PageColumn::kX, i));
    if (x < low_x || x > high_x) {
      continue;
    }
    const auto y = static_cast<std::int64_t>(number(PageColumn::kY, i));
    if (y >= low_y && y <= high_y && meets(roi(i), box)) {
      return i;
    }
  }
  return i;
}

/// Column by column: a number takes a load and a shift then, and nothing is looked up between.
void RecordPage::attributes(std::uint32_t first, std::uint32_t count,
                            AttributeRun& out) const noexcept {
  std::array<std::array<std::uint64_t, kRun>, kPageColumns> all;  // NOLINT: written before read
  const auto read = [&](PageColumn c) {
    std::array<std::uint64_t, kRun>& numbers = all[static_cast<std::size_t>(c)];
    columns_.read_run(bytes_.data(), c, first, std::span(numbers).first(count));
  };
  for (const PageColumn c :
       {PageColumn::kX, PageColumn::kY, PageColumn::kHeight, PageColumn::kWest, PageColumn::kSouth,
        PageColumn::kEast, PageColumn::kNorth, PageColumn::kBelow, PageColumn::kAbove,
        PageColumn::kError, PageColumn::kDeviation, PageColumn::kFlags}) {
    read(c);
  }
  const auto code = [&](std::uint64_t ordered) {
    return heights_.code(height_of_ordered(static_cast<std::uint32_t>(ordered), heights_.type));
  };
  const auto bound = [](std::uint64_t stored, ShortBits base) {
    return static_cast<double>(short_value(static_cast<ShortBits>(short_of_stored(stored, base))));
  };
  const layout::PageHeader& h = columns_.header();
  for (std::uint32_t k = 0; k < count; ++k) {
    const auto at = [&](PageColumn c) { return all[static_cast<std::size_t>(c)][k]; };
    const auto whole = [](std::uint64_t v) {
      return static_cast<std::int32_t>(static_cast<std::uint32_t>(v));
    };
    Attributes& a = out[k];
    a.roi = {whole(at(PageColumn::kX) - at(PageColumn::kWest)),
             whole(at(PageColumn::kY) - at(PageColumn::kSouth)),
             whole(at(PageColumn::kX) + at(PageColumn::kEast)),
             whole(at(PageColumn::kY) + at(PageColumn::kNorth))};
    const std::uint64_t height = at(PageColumn::kHeight);
    a.heights = (at(PageColumn::kFlags) & kPageNoHeights) != 0
                    ? Interval{}
                    : Interval{code(height - at(PageColumn::kBelow)),
                               code(height + at(PageColumn::kAbove))};
    a.error = bound(at(PageColumn::kError), h.error);
    a.deviation = bound(at(PageColumn::kDeviation), h.deviation);
  }
}

bool RecordPage::head(std::size_t i, VertexSplit& r) const noexcept {
  const std::uint64_t x = number(PageColumn::kX, i);
  const std::uint64_t y = number(PageColumn::kY, i);
  const std::uint64_t flags = number(PageColumn::kFlags, i);
  const std::uint64_t rank = number(PageColumn::kRank, i);
  const std::uint32_t error = error_bits(i);
  const std::uint32_t deviation =
      short_of_stored(number(PageColumn::kDeviation, i), columns_.header().deviation);
  const std::uint64_t height = number(PageColumn::kHeight, i);
  const std::uint64_t low = height - number(PageColumn::kBelow, i);  // may wrap around
  const std::uint64_t high = height + number(PageColumn::kAbove, i);
  r.roi = roi(i);
  const bool has_height = (flags & kPageVertexVoid) == 0;
  const bool has_heights = (flags & kPageNoHeights) == 0;
  const std::uint64_t border = flags & (kPageNoLeft | kPageNoRight);
  if (x > kGridMax || y > kGridMax || r.roi.min_x < 0 || r.roi.min_y < 0 ||
      r.roi.max_x > kGridMax || r.roi.max_y > kGridMax || height > UINT32_MAX || low > UINT32_MAX ||
      high > UINT32_MAX || error > kShortInfinity || deviation > kShortInfinity ||
      rank > UINT16_MAX || (has_height && !has_heights) || border == (kPageNoLeft | kPageNoRight)) {
    return false;
  }
  r.u = {static_cast<std::int32_t>(x), static_cast<std::int32_t>(y)};
  const auto bits = [&](std::uint64_t ordered) {
    return height_of_ordered(static_cast<std::uint32_t>(ordered), heights_.type);
  };
  r.height = has_height ? bits(height) : 0;
  r.height_lo = bits(low);
  r.height_hi = bits(high);
  if (!has_heights) {
    r.height_lo = no_heights(heights_.type).lo;
    r.height_hi = no_heights(heights_.type).hi;
  }
  r.error = short_value(static_cast<ShortBits>(error));
  r.deviation = short_value(static_cast<ShortBits>(deviation));
  r.rank = static_cast<std::uint16_t>(rank);
  const auto flag = [&](PageFlag from, VertexSplit::Flag to) {
    return (flags & from) != 0 ? unsigned{to} : 0U;
  };
  r.flags = static_cast<std::uint16_t>(flag(kPageNoLeft, VertexSplit::kNoLeft) |
                                       flag(kPageNoRight, VertexSplit::kNoRight) |
                                       flag(kPageVertexVoid, VertexSplit::kVertexVoid));
  return true;
}

RecordPage::RingShape RecordPage::shape_of(std::size_t i) const noexcept {
  const auto degree = static_cast<unsigned>(number(PageColumn::kDegree, i));
  const auto offset_bits = static_cast<unsigned>(number(PageColumn::kOffsetBits, i));
  const auto height_bits = static_cast<unsigned>(number(PageColumn::kHeightBits, i));
  const auto death_bits = static_cast<unsigned>(number(PageColumn::kDeathBits, i));
  return {degree, offset_bits, height_bits, death_bits,
          2 * offset_bits + height_bits + death_bits + columns_.common_bits()};
}

/// Finds the ring of record i: from `place`, where that is in the same run and not behind it, else
/// from the begin of the run. False when the ring cannot be one, or would not lie where rings lie.
bool RecordPage::find(std::size_t i, const RingShape& shape, RingPlace& place) const noexcept {
  const std::size_t run = i / layout::kRingRun;
  if (place.record > i || place.record < run * layout::kRingRun) {
    place.record = run * layout::kRingRun;
    place.bit = columns_.run_begin(bytes_.data(), run);
  }
  for (; place.record < i; ++place.record) {
    place.bit += shape_of(place.record).bits();
  }
  return shape.degree >= 3 && shape.degree <= layout::kMostDegree && shape.offset_bits <= 32 &&
         shape.height_bits <= 33 && shape.death_bits <= 15 &&
         place.bit + shape.bits() <= columns_.rings_end();
}

GridPoint RecordPage::corner_position(GridPoint u, const RingShape& shape,
                                      std::size_t bit) const noexcept {
  const std::int64_t x =
      u.x + with_sign(read_bits(bytes_.data(), bit, shape.offset_bits), shape.offset_bits);
  const std::int64_t y =
      u.y + with_sign(read_bits(bytes_.data(), bit + shape.offset_bits, shape.offset_bits),
                      shape.offset_bits);
  return {static_cast<std::int32_t>(x), static_cast<std::int32_t>(y)};  // 2^30 + 2^31 at most
}

bool RecordPage::is_void(const RingShape& shape, std::size_t bit) const noexcept {
  const layout::PageHeader& h = columns_.header();
  const std::size_t at = bit + 2 * shape.offset_bits + shape.height_bits + shape.death_bits;
  return read_bits(bytes_.data(), at, h.void_bits) != 0;
}

/// Takes the corner at a bit apart. A corner takes up to 112 bits, nearly always fewer than 57: then
/// one load gets all of it.
RecordPage::StoredCorner RecordPage::stored_corner(const RingShape& shape,
                                                   std::size_t bit) const noexcept {
  const layout::PageHeader& h = columns_.header();
  StoredCorner c;
  if (shape.corner_bits <= kMostFieldBits) [[likely]] {
    std::uint64_t bits = read_bits(bytes_.data(), bit, shape.corner_bits);
    const auto take = [&](unsigned width) {
      const std::uint64_t field = bits & ((std::uint64_t{1} << width) - 1);
      bits >>= width;
      return field;
    };
    c.x = with_sign(take(shape.offset_bits), shape.offset_bits);
    c.y = with_sign(take(shape.offset_bits), shape.offset_bits);
    c.height = with_sign(take(shape.height_bits), shape.height_bits);
    c.death = static_cast<std::uint32_t>(take(shape.death_bits));
    c.is_void = take(h.void_bits) != 0;
    c.has_height = bits == 0;
    return c;
  }
  const auto take = [&](unsigned width) {
    const std::uint64_t field = read_bits(bytes_.data(), bit, width);
    bit += width;
    return field;
  };
  c.x = with_sign(take(shape.offset_bits), shape.offset_bits);
  c.y = with_sign(take(shape.offset_bits), shape.offset_bits);
  c.height = with_sign(take(shape.height_bits), shape.height_bits);
  c.death = static_cast<std::uint32_t>(take(shape.death_bits));
  c.is_void = take(h.void_bits) != 0;
  c.has_height = take(h.no_height_bits) == 0;
  return c;
}

/// Makes a corner of what is stored. False when it cannot be one, but for its place.
bool RecordPage::make_corner(const StoredCorner& stored, const VertexSplit& r, std::uint32_t height,
                             ShortBits error, RingCorner& c) const noexcept {
  const std::int64_t ordered = height + stored.height;
  const std::uint32_t below =
      stored.death < kFirstAboveBase ? error : stored.death - kFirstAboveBase;
  // A death above 0 that is written as one at 0 would be there in two forms.
  const bool is_sound =
      ordered >= 0 && ordered <= UINT32_MAX && (stored.death < kFirstAboveBase || below < error);
  // 2^30 + 2^31 at most: what leaves the grid becomes negative, and lies off it still.
  c.position = {static_cast<std::int32_t>(r.u.x + stored.x),
                static_cast<std::int32_t>(r.u.y + stored.y)};
  c.height =
      stored.has_height ? height_of_ordered(static_cast<std::uint32_t>(ordered), heights_.type) : 0;
  c.death = stored.death == 0 ? kLivesOn : short_value(static_cast<ShortBits>(error - below));
  c.flags = static_cast<std::uint8_t>((stored.is_void ? unsigned{RingCorner::kVoid} : 0U) |
                                      (stored.has_height ? 0U : unsigned{RingCorner::kNoHeight}));
  return is_sound;
}

bool RecordPage::split(std::size_t i, RingPlace& place, VertexSplit& r) const noexcept {
  const RingShape shape = shape_of(i);
  if (!head(i, r) || !find(i, shape, place)) {
    return false;
  }
  const bool no_left = (r.flags & VertexSplit::kNoLeft) != 0;
  const bool no_right = (r.flags & VertexSplit::kNoRight) != 0;
  const std::size_t last = shape.degree - 1;
  const auto bit_of = [&](std::size_t k) { return place.bit + k * shape.corner_bits; };
  r.w = corner_position(r.u, shape, bit_of(no_left ? last : 0));
  r.vl = corner_position(r.u, shape, bit_of(no_left ? 0 : 1));
  r.vr = corner_position(r.u, shape, bit_of(no_left ? last - 1 : last));
  const bool left_void = !no_left && is_void(shape, bit_of(0));
  const bool right_void = !no_right && is_void(shape, bit_of(no_left ? last - 1 : last));
  r.flags = static_cast<std::uint16_t>(unsigned{r.flags} |
                                       (left_void ? unsigned{VertexSplit::kLeftVoid} : 0U) |
                                       (right_void ? unsigned{VertexSplit::kRightVoid} : 0U));
  return contains(r.roi, r.w) && contains(r.roi, r.vl) && contains(r.roi, r.vr) && r.w != r.u &&
         r.vl != r.u && r.vr != r.u;
}

bool RecordPage::ring(std::size_t i, RingPlace& place, const VertexSplit& r,
                      std::vector<RingCorner>& out) const {
  const RingShape shape = shape_of(i);
  if (!find(i, shape, place)) {
    return false;
  }
  const auto height = static_cast<std::uint32_t>(number(PageColumn::kHeight, i));
  const ShortBits error = short_bits(r.error);
  const std::size_t first = out.size();
  out.resize(first + shape.degree);
  const std::span<RingCorner> ring(out.data() + first, shape.degree);
  bool is_sound = true;
  for (std::size_t k = 0; k < ring.size(); ++k) {
    RingCorner& c = ring[k];
    is_sound &=
        make_corner(stored_corner(shape, place.bit + k * shape.corner_bits), r, height, error, c);
  }
  return is_sound && is_star(r, ring, heights_);
}

DescribedPage::DescribedPage(const std::string& path, PageId id,
                             const layout::NodeEntry& descriptor, const HeightEncoding& heights,
                             std::uint32_t page_bytes)
    : path_(path), id_(id), descriptor_(descriptor), heights_(heights), page_bytes_(page_bytes) {
  if (records() == 0 || records() > page_bytes / layout::kLeastRecordBytes ||
      !is_sound(descriptor, heights)) [[unlikely]] {
    throw Error(ErrorCode::corruption,
                "the descriptor of the page holds values that no program wrote",
                path + ", page " + std::to_string(index_of(id)));
  }
}

RecordPage DescribedPage::open(std::span<const std::byte> bytes) const {
  RecordPage page(bytes, heights_);
  if (!page.is_sound() || page.records() != records()) [[unlikely]] {
    throw Error(ErrorCode::corruption,
                "the page begins with numbers that no program wrote, or that its descriptor "
                "excludes",
                path_ + ", page " + std::to_string(index_of(id_)));
  }
  return page;
}

void DescribedPage::report(std::size_t record) const {
  throw Error(ErrorCode::corruption,
              "record " + std::to_string(record) +
                  " holds values that no program wrote, or that its page's descriptor excludes",
              path_ + ", page " + std::to_string(index_of(id_)));
}

void DescribedPage::decode(std::span<const std::byte> bytes, std::vector<VertexSplit>& out) const {
  const RecordPage page = open(bytes);
  const std::size_t before = out.size();
  out.resize(before + records());
  const std::span<VertexSplit> decoded(out.data() + before, records());
  RingPlace place;
  std::size_t sound = 0;
  while (sound < decoded.size() && page.split(sound, place, decoded[sound])) {
    ++sound;
  }
  sound = std::min(sound, admitted(decoded.first(sound)));
  if (sound < decoded.size()) [[unlikely]] {
    out.resize(before);
    report(sound);
  }
}

void DescribedPage::decode(std::span<const std::byte> bytes, StarredRecords& out) const {
  const std::size_t before = out.size();
  decode(bytes, out.splits);
  const RecordPage page = open(bytes);
  RingPlace place;
  for (std::size_t i = 0; i < records(); ++i) {
    const std::size_t begin = out.corners.size();
    const VertexSplit& r = out.splits[before + i];
    if (!page.ring(i, place, r, out.corners) || !admits(r, std::span(out.corners).subspan(begin)))
        [[unlikely]] {
      out.resize(before);
      report(i);
    }
    out.ring_end.push_back(static_cast<std::uint32_t>(out.corners.size()));
  }
}

bool DescribedPage::admits(const VertexSplit& r, std::span<const RingCorner> ring) const noexcept {
  const layout::NodeEntry& d = descriptor_;
  const GridBox box{d.star_min_x, d.star_min_y, d.star_max_x, d.star_max_y};
  const HeightType type = heights_.type;
  const std::uint32_t lo = ordered_height(d.star_height_lo, type);
  const std::uint32_t hi = ordered_height(d.star_height_hi, type);
  const auto is_within = [&](HeightBits height) {
    const std::uint32_t ordered = ordered_height(height, type);
    return lo <= ordered && ordered <= hi;
  };
  const float least =
      d.death_min == 0 ? kLivesOn : short_value(static_cast<ShortBits>(d.death_min - 1));
  bool fits =
      contains(box, r.u) && ((r.flags & VertexSplit::kVertexVoid) != 0 || is_within(r.height));
  for (const RingCorner& c : ring) {
    fits &= contains(box, c.position) &&
            ((c.flags & RingCorner::kNoHeight) != 0 || is_within(c.height));
  }
  const std::size_t triangles = ring.size() - (has_closed_ring(r) ? 0 : 1);
  for (const RingCorner& c : ring.first(triangles)) {
    fits &= c.death >= least;
  }
  return fits;
}

std::size_t DescribedPage::admitted(std::span<const VertexSplit> records) const noexcept {
  return heights_.type == HeightType::int32
             ? first_excluded(Bounds<std::int32_t>(descriptor_), records)
             : first_excluded(Bounds<float>(descriptor_), records);
}

void DescribedPage::decode_stars(std::span<const std::byte> bytes, const StarFilter& filter,
                                 StarredRecords& out) const {
  const RecordPage page = open(bytes);
  const std::size_t before = out.size();
  const std::int32_t level = level_bits(filter.level);
  RingPlace place;
  VertexSplit r;
  for (std::uint32_t i = page.next_near(0, filter.box); i < records();
       i = page.next_near(i + 1, filter.box)) {
    if (static_cast<std::int64_t>(page.error_bits(i)) <= level) {
      continue;
    }
    const bool is_sound = page.head(i, r);
    if (is_sound && !meets(attributes_of(r, heights_).heights, filter.heights)) {
      continue;
    }
    const std::size_t first = out.corners.size();
    if (!is_sound || admitted(std::span(&r, 1)) == 0 || !page.ring(i, place, r, out.corners) ||
        !admits(r, std::span(out.corners).subspan(first))) [[unlikely]] {
      out.corners.resize(first);
      out.resize(before);
      report(i);
    }
    out.splits.push_back(r);
    out.ring_end.push_back(static_cast<std::uint32_t>(out.corners.size()));
  }
}

void DescribedPage::decode_matching(std::span<const std::byte> bytes,
                                    const AttributePredicate& predicate,
                                    std::vector<VertexSplit>& out) const {
  const RecordPage page = open(bytes);
  const GridBox reach = predicate.reach();
  const std::size_t before = out.size();
  RingPlace place;
  RecordPage::AttributeRun run;
  for (std::uint32_t first = 0; first < records(); first += RecordPage::kRun) {
    const std::uint32_t count = std::min<std::uint32_t>(RecordPage::kRun, records() - first);
    page.attributes(first, count, run);
    for (std::uint32_t k = 0; k < count; ++k) {
      const Attributes& a = run[k];
      if (!meets(a.roi, reach) || !predicate.holds(a)) {
        continue;
      }
      VertexSplit r;
      if (!page.split(first + k, place, r) || admitted(std::span(&r, 1)) == 0) [[unlikely]] {
        out.resize(before);
        report(first + k);
      }
      out.push_back(r);
    }
  }
}

}  // namespace ptin
