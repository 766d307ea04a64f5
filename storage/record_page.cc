// SPDX-License-Identifier: GPL-3.0-or-later
#include "storage/record_page.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <type_traits>

#include "engine/error.h"
#include "storage/bit_fields.h"
#include "storage/layout.h"
#include "storage/ring_check.h"

namespace ptin {

namespace {

using lanes::Int4;

/// The lanes of a box that hold its minima.
constexpr Int4 kMinima{-1, -1, 0, 0};

/// A vertex as a record has it.
void put(VertexKey& to, VertexKey key) noexcept { to = key; }
void put(GridPoint& to, VertexKey key) noexcept { to = point_of(key); }

[[noreturn]] void throw_corrupt(const std::string& what, const std::string& path, PageId id) {
  throw Error(ErrorCode::corruption, what, path + ", page " + std::to_string(index_of(id)));
}

}  // namespace

void check_descriptor(const std::string& path, PageId id, const layout::NodeEntry& descriptor,
                      const HeightEncoding& heights, std::size_t page_bytes) {
  if (descriptor.records == 0 || descriptor.records > page_bytes / layout::kLeastRecordBytes ||
      !is_sound(descriptor, heights)) [[unlikely]] {
    throw_corrupt("the descriptor of the page holds values that no program wrote", path, id);
  }
}

HeadBounds::HeadBounds(const layout::NodeEntry& d, HeightType type) noexcept
    : sides(lanes::load<Int4>(&d.min_x) ^ ~kMinima),
      low(ordered_height(d.height_lo, type)),
      high(ordered_height(d.height_hi, type)),
      error_min(d.error_min),
      error_max(d.error_max),
      deviation_max(d.deviation_max) {
  // -0 is 0, and lies before it among ordered heights.
  low -= type == HeightType::float32 && low == ordered_height(0, type) ? 1 : 0;
}

RecordPage::RecordPage(const std::string& path, PageId id, const layout::NodeEntry& descriptor,
                       const HeightEncoding& heights, const PageForm& form,
                       std::span<const std::byte> bytes, SampleHeights* floor)
    : path_(path),
      id_(id),
      descriptor_(descriptor),
      heights_(heights),
      bytes_(bytes),
      floor_(floor),
      bounds_(descriptor, heights.type) {
  check_descriptor(path, id, descriptor, heights, bytes.size());
  if (!columns_.read(bytes, form) || records() != descriptor.records) [[unlikely]] {
    throw_corrupt(
        "the page begins with numbers that no program wrote, or that its descriptor excludes", path,
        id);
  }
  if (columns_.is_local() && floor_ == nullptr) [[unlikely]] {
    throw_corrupt("the page leaves the heights of its vertices to samples that cannot be read",
                  path, id);
  }
}

void RecordPage::report(std::size_t record) const {
  throw_corrupt("record " + std::to_string(record) +
                    " holds values that no program wrote, or that its page's descriptor excludes",
                path_, id_);
}

void PageRun::take_all() {
  for (std::size_t c = 0; c < kPageColumns; ++c) {
    read_column(static_cast<PageColumn>(c));
  }
}

void PageRun::read_column(PageColumn column) {
  const auto c = static_cast<std::size_t>(column);
  const PageColumns& columns = page_.columns();
  const std::span<std::uint64_t> numbers = std::span(numbers_[c]).first(count_);
  if (column == PageColumn::kError && columns.has_descending_errors()) {
    columns.read_errors(page_.bytes(), first_, numbers);
  } else if (column == PageColumn::kHeight && columns.is_local()) {
    read_samples(all());
  } else {
    columns.read_run(page_.bytes(), column, first_, numbers);
  }
  taken_[c] = all();
}

/// The heights of u that a local page leaves to the raster.
void PageRun::read_samples(std::uint64_t records) {
  take_some(PageColumn::kX, records);
  take_some(PageColumn::kY, records);
  std::array<std::uint64_t, kMost>& heights =
      numbers_[static_cast<std::size_t>(PageColumn::kHeight)];
  for (; records != 0; records &= records - 1) {
    const auto k = static_cast<std::uint32_t>(std::countr_zero(records));
    heights[k] = page_.sample(static_cast<std::int64_t>(at(PageColumn::kX, k)),
                              static_cast<std::int64_t>(at(PageColumn::kY, k)));
  }
}

void PageRun::read(PageColumn column, std::uint64_t records) {
  const auto c = static_cast<std::size_t>(column);
  if (column == PageColumn::kHeight && page_.columns().is_local()) {
    read_samples(records);
    taken_[c] |= records;
    return;
  }
  if (column == PageColumn::kError && page_.columns().has_descending_errors()) {
    // Each follows from those before, so none is read behind the last one.
    const auto end = static_cast<std::size_t>(std::bit_width(records));
    page_.columns().read_errors(page_.bytes(), first_, std::span(numbers_[c]).first(end));
    taken_[c] |= ~std::uint64_t{0} >> (64 - end);
    return;
  }
  // A run of numbers is taken out four times faster than as many single ones.
  if (4 * static_cast<std::uint32_t>(std::popcount(records)) >= count_) {
    read_column(column);
    return;
  }
  taken_[c] |= records;
  for (; records != 0; records &= records - 1) {
    const auto k = static_cast<std::uint32_t>(std::countr_zero(records));
    numbers_[c][k] = page_.columns().at(page_.bytes(), column, first_ + k);
  }
}

/// Where a record lies. The roi is made and held against the descriptor as one vector: stored side by
/// side and loaded as a vector, it would wait for the stores.
[[gnu::always_inline]] inline RecordPage::OwnPlace RecordPage::own_place(
    const PageRun& run, std::uint32_t k) const noexcept {
  const auto whole = [&](PageColumn c) { return static_cast<std::int32_t>(run.at(c, k)); };
  OwnPlace place;
  place.key = run.at(PageColumn::kY, k) << 32 | static_cast<std::uint32_t>(whole(PageColumn::kX));
  place.u_twice = lanes::pair(place.key, place.key);
  place.roi = lanes::moved(place.u_twice,
                           Int4{whole(PageColumn::kWest), whole(PageColumn::kSouth),
                                whole(PageColumn::kEast), whole(PageColumn::kNorth)},
                           kMinima);
  // Maxima are turned over, so that all sides are compared one way. Where u lies on the grid a side
  // that wraps around ends up on the other side of u.
  const Int4 sides = place.roi ^ ~kMinima;
  place.outside = (bounds_.sides > sides) | (sides > (place.u_twice ^ ~kMinima));
  return place;
}

/// Everything of a record but what follows from its place and its ring. False where it, or u, is
/// none, or the descriptor does not admit it.
template <class Record>
[[gnu::always_inline]] inline bool RecordPage::head_of(const PageRun& run, std::uint32_t k,
                                                       Record& r) const noexcept {
  const auto at = [&](PageColumn c) { return static_cast<std::int64_t>(run.at(c, k)); };
  const std::int64_t x = at(PageColumn::kX), y = at(PageColumn::kY);
  const OrderedInterval interval = run.heights(k);
  const auto height = static_cast<std::int64_t>(interval.height);
  const auto low = static_cast<std::int64_t>(interval.low);
  const auto high = static_cast<std::int64_t>(interval.high);
  const std::int64_t rank = at(PageColumn::kRank);
  const std::int64_t error = run.error_bits(k), deviation = run.deviation_bits(k);
  const std::uint64_t flags = run.at(PageColumn::kFlags, k);
  const bool has_heights = (flags & kPageNoHeights) == 0;
  std::int64_t lowest = bounds_.low, highest = bounds_.high;
  if (!has_heights) [[unlikely]] {
    lowest = ordered_heights(heights_.type).least;
    highest = ordered_heights(heights_.type).most;
  }
  // Numbers of columns are not negative and below 2^34. So the sign of one of these differences, and
  // with it that of their bits together, is that of a number beyond its range.
  const std::int64_t beyond = (INT32_MAX - (x | y)) | (height - least_height()) | (low - lowest) |
                              (highest - high) | (error - bounds_.error_min) |
                              (bounds_.error_max - error) | (bounds_.deviation_max - deviation) |
                              (UINT16_MAX - rank);
  const auto bits = [&](std::int64_t ordered) {
    return height_of_ordered(static_cast<std::uint32_t>(ordered), heights_.type);
  };
  r.height = bits(height);
  r.error = short_value(static_cast<ShortBits>(error));
  r.rank = static_cast<std::uint16_t>(rank);
  r.flags = 0;
  if constexpr (std::is_same_v<Record, VertexSplit>) {
    r.deviation = short_value(static_cast<ShortBits>(deviation));
    r.height_lo = has_heights ? bits(low) : no_heights(heights_.type).lo;
    r.height_hi = has_heights ? bits(high) : no_heights(heights_.type).hi;
  }
  return (beyond >= 0) & (flags == 0 || take_flags(flags, r));
}

/// Takes over the flags of a record on a border or beside a void. False where they contradict one
/// another.
template <class Record>
bool RecordPage::take_flags(std::uint64_t flags, Record& r) noexcept {
  static_assert(VertexSplit::kNoLeft == kPageNoLeft << 2 &&
                VertexSplit::kNoRight == kPageNoRight << 2 &&
                VertexSplit::kVertexVoid == kPageVertexVoid << 2);
  constexpr std::uint64_t kBothSides = kPageNoLeft | kPageNoRight;
  const bool has_height = (flags & kPageVertexVoid) == 0;
  r.height = has_height ? r.height : 0;
  r.flags = static_cast<std::uint16_t>((flags & (kBothSides | kPageVertexVoid)) << 2);
  return (flags & kBothSides) != kBothSides && (!has_height || (flags & kPageNoHeights) == 0);
}

bool RecordPage::head(const PageRun& run, std::uint32_t k, VertexSplit& r) const noexcept {
  const OwnPlace place = own_place(run, k);
  const bool is_sound = head_of(run, k, r);
  put(r.u, place.key);
  lanes::store(&r.roi, place.roi);
  return is_sound & !lanes::any(place.outside);
}

RingShape RecordPage::shape_of(const PageRun& run, std::uint32_t k) const noexcept {
  const auto at = [&](PageColumn c) { return static_cast<unsigned>(run.at(c, k)); };
  const unsigned offset_bits = at(PageColumn::kOffsetBits);
  const unsigned height_bits = at(PageColumn::kHeightBits);
  const unsigned death_bits = at(PageColumn::kDeathBits);
  return {at(PageColumn::kDegree), offset_bits, height_bits, death_bits,
          2 * offset_bits + height_bits + death_bits + columns_.common_bits()};
}

// What is written does not overlap what is read (`__restrict`): records are looked at side by side.
void RecordPage::find_rings(const PageRun& run, RunRings& __restrict out) const noexcept {
  const auto at = [&](PageColumn c, std::uint32_t k) {
    return static_cast<std::int64_t>(run.at(c, k));
  };
  const std::int64_t common = columns_.common_bits();
  const std::uint32_t count = run.count();
  for (std::uint32_t k = 0; k < count; ++k) {
    const std::int64_t degree = at(PageColumn::kDegree, k);
    const std::int64_t offset = at(PageColumn::kOffsetBits, k);
    const std::int64_t height = at(PageColumn::kHeightBits, k);
    const std::int64_t death = at(PageColumn::kDeathBits, k);
    out.corner_bits[k] = 2 * offset + height + death + common;
    // As is_ring_shape(): the sign of one of these is that of a number beyond its range. Where an
    // offset has no bits, all corners are u.
    out.beyond[k] = (degree - kLeastDegree) | (layout::kMostDegree - degree) | (offset - 1) |
                    (kMostOffsetWidth - offset) | (kMostHeightWidth - height) |
                    (kMostShortWidth - death);
  }
  const auto rings_end = static_cast<std::int64_t>(columns_.rings_end());
  std::int64_t bit = 0;
  for (std::uint32_t k = 0; k < count; ++k) {
    if (k % layout::kRingRun == 0) {
      const std::size_t rings = (run.first() + k) / layout::kRingRun;
      bit = static_cast<std::int64_t>(columns_.run_begin(bytes_.data(), rings));
    }
    out.bit[k] = bit;
    bit += at(PageColumn::kDegree, k) * out.corner_bits[k];
    out.beyond[k] |= rings_end - bit;
  }
}

/// The bits of a page from `bit` on: 57 of them.
[[gnu::always_inline]] inline std::uint64_t RecordPage::bits_from(std::size_t bit) const noexcept {
  std::uint64_t bits;
  std::memcpy(&bits, bytes_.data() + bit / 8, sizeof bits);
  return bits >> (bit % 8);
}

/// Where two corners lie from u.
[[gnu::always_inline]] inline lanes::Int4 RecordPage::corner_offsets(
    unsigned width, std::size_t bit, std::size_t other_bit) const noexcept {
  constexpr lanes::Unsigned2 kLower{UINT32_MAX, UINT32_MAX};
  lanes::Unsigned2 x{bits_from(bit), bits_from(other_bit)};
  lanes::Unsigned2 y = x >> width;
  if (2 * width > kMostFieldBits) [[unlikely]] {
    y = lanes::Unsigned2{bits_from(bit + width), bits_from(other_bit + width)};
  }
  return lanes::with_sign(std::bit_cast<Int4>((x & kLower) | (y << 32)), width);
}

bool RecordPage::is_void(std::int64_t corner_bits, std::size_t bit) const noexcept {
  const std::size_t at = bit + static_cast<std::size_t>(corner_bits) - columns_.common_bits();
  return read_bits(bytes_.data(), at, columns_.header().void_bits) != 0;
}

/// Takes corner after corner apart. A corner takes up to 112 bits, nearly always fewer than 57: then
/// one load gets all of it.
template <class Visit>
void RecordPage::for_each_corner(const RingShape& shape, std::size_t bit,
                                 const Visit& visit) const {
  const layout::PageHeader& h = columns_.header();
  const auto fields = [&](const auto& take) {
    RelativeCorner c;
    c.x = with_sign(take(shape.offset_bits), shape.offset_bits);
    c.y = with_sign(take(shape.offset_bits), shape.offset_bits);
    c.height = with_sign(take(shape.height_bits), shape.height_bits);
    c.death = static_cast<std::uint32_t>(take(shape.death_bits));
    c.is_void = take(h.void_bits) != 0;
    c.has_height = take(h.no_height_bits) == 0;
    return c;
  };
  if (shape.corner_bits <= kMostFieldBits) [[likely]] {
    for (unsigned k = 0; k < shape.degree; ++k, bit += shape.corner_bits) {
      std::uint64_t bits = read_bits(bytes_.data(), bit, shape.corner_bits);
      visit(k, fields([&](unsigned width) {
              const std::uint64_t field = bits & ((std::uint64_t{1} << width) - 1);
              bits >>= width;
              return field;
            }));
    }
    return;
  }
  for (unsigned k = 0; k < shape.degree; ++k) {
    visit(k, fields([&](unsigned width) {
            const std::uint64_t field = read_bits(bytes_.data(), bit, width);
            bit += width;
            return field;
          }));
  }
}

/// The vertices of a split and the classes of its sides, from the ring of a record whose head is `r`.
template <class Record>
[[gnu::always_inline]] inline bool RecordPage::ends_of(const PageRun& run, std::uint32_t k,
                                                       const RunRings& rings, const OwnPlace& own,
                                                       Record& r) const noexcept {
  const std::int64_t corner_bits = rings.corner_bits[k];
  const auto first = static_cast<std::size_t>(rings.bit[k]);
  const std::size_t second = first + corner_bits;
  const std::size_t last = first + (run.at(PageColumn::kDegree, k) - 1) * corner_bits;
  std::size_t w_bit = first, vl_bit = second, vr_bit = last;
  if ((r.flags & VertexSplit::kNoLeft) != 0) [[unlikely]] {
    w_bit = last;
    vl_bit = first;
    vr_bit = last - corner_bits;
  }
  const auto width = static_cast<unsigned>(run.at(PageColumn::kOffsetBits, k));
  const Int4 w_vl = lanes::sum(own.u_twice, corner_offsets(width, w_bit, vl_bit));
  const Int4 vr = lanes::sum(own.u_twice, corner_offsets(width, vr_bit, vr_bit));
  const Int4 low = lanes::lower_twice(own.roi), high = lanes::upper_twice(own.roi);
  const Int4 outside = (w_vl < low) | (w_vl > high) | (vr < low) | (vr > high) | own.outside |
                       lanes::both(w_vl == own.u_twice) | lanes::both(vr == own.u_twice);
  const auto [w_key, vl_key] = std::bit_cast<std::array<VertexKey, 2>>(w_vl);
  put(r.u, own.key);
  put(r.w, w_key);
  put(r.vl, vl_key);
  put(r.vr, std::bit_cast<std::array<VertexKey, 2>>(vr)[0]);
  if (columns_.header().void_bits != 0) [[unlikely]] {
    const bool left_void = (r.flags & VertexSplit::kNoLeft) == 0 && is_void(corner_bits, first);
    const bool right_void = (r.flags & VertexSplit::kNoRight) == 0 && is_void(corner_bits, vr_bit);
    r.flags = static_cast<std::uint16_t>(unsigned{r.flags} |
                                         (left_void ? unsigned{VertexSplit::kLeftVoid} : 0U) |
                                         (right_void ? unsigned{VertexSplit::kRightVoid} : 0U));
  }
  return !lanes::any(outside);
}

/// One function without calls: a refinement decodes little else.
template <class Record>
[[gnu::always_inline]] inline bool RecordPage::split_of(const PageRun& run, std::uint32_t k,
                                                        const RunRings& rings,
                                                        Record& r) const noexcept {
  const OwnPlace own = own_place(run, k);
  lanes::store(&r.roi, own.roi);
  return head_of(run, k, r) && rings.is_sound(k) && ends_of(run, k, rings, own, r);
}

bool RecordPage::split(const PageRun& run, std::uint32_t k, const RunRings& rings,
                       VertexSplit& r) const noexcept {
  return split_of(run, k, rings, r);
}

namespace {

void widen(RingSpan& span, std::int64_t x, std::int64_t y) noexcept {
  span.min_x = std::min(span.min_x, x);
  span.max_x = std::max(span.max_x, x);
  span.min_y = std::min(span.min_y, y);
  span.max_y = std::max(span.max_y, y);
}

bool contains(const GridBox& box, const RingSpan& span) noexcept {
  return box.min_x <= span.min_x && span.max_x <= box.max_x && box.min_y <= span.min_y &&
         span.max_y <= box.max_y;
}

}  // namespace

bool RecordPage::ring(const PageRun& run, std::uint32_t k, const RunRings& rings,
                      const VertexSplit& r, std::vector<RingCorner>& out, RingSpan& span) const {
  if (!rings.is_sound(k)) {
    return false;
  }
  const RingShape shape = shape_of(run, k);
  const unsigned degree = shape.degree;
  const OrderedInterval own = run.heights(k);
  const auto height = static_cast<std::int64_t>(own.height);
  const std::uint32_t error = short_bits(r.error);
  const bool is_closed = has_closed_ring(r);
  const bool is_local = columns_.is_local();
  RingCheck check(r.has_height());
  const std::size_t first = out.size();
  out.resize(first + degree);
  RingCorner* const ring = out.data() + first;
  span = {};
  bool is_sound = true;
  for_each_corner(
      shape, static_cast<std::size_t>(rings.bit[k]), [&](unsigned n, const RelativeCorner& c) {
        check.add(c);
        widen(span, r.u.x + c.x, r.u.y + c.y);
        const std::int64_t ordered =
            is_local ? std::int64_t{sample(r.u.x + c.x, r.u.y + c.y)} : height + c.height;
        const std::uint32_t below = c.death < kFirstAboveBase ? error : c.death - kFirstAboveBase;
        // A death above 0 that is written as one at 0 would be there in two forms.
        is_sound &= (ordered >= least_height()) & (ordered <= UINT32_MAX) &
                    ((c.death < kFirstAboveBase) | (below < error));
        const auto known = static_cast<std::uint32_t>(ordered);
        span.low = c.has_height ? std::min(span.low, known) : span.low;
        span.high = c.has_height ? std::max(span.high, known) : span.high;
        const bool is_triangle = is_closed || n + 1 < degree;
        is_sound &= is_triangle | (c.death == 0);
        const std::uint32_t death = c.death == 0 ? 0 : error - below + 1;  // as death_bits()
        span.least_death = is_triangle ? std::min(span.least_death, death) : span.least_death;
        ring[n] = {
            {static_cast<std::int32_t>(r.u.x + c.x), static_cast<std::int32_t>(r.u.y + c.y)},
            c.has_height ? height_of_ordered(known, heights_.type) : 0,
            c.death == 0 ? kLivesOn : short_value(static_cast<ShortBits>(error - below)),
            static_cast<std::uint8_t>((c.is_void ? unsigned{RingCorner::kVoid} : 0U) |
                                      (c.has_height ? 0U : unsigned{RingCorner::kNoHeight}))};
      });
  const bool has_heights = (run.at(PageColumn::kFlags, k) & kPageNoHeights) == 0;
  const bool is_within =
      span.low > span.high || (has_heights && own.low <= span.low && span.high <= own.high);
  return is_sound && is_within && contains(r.roi, span) &&
         (is_closed ? check.is_closed_ring() : check.is_open_ring());
}

bool RecordPage::admits(const VertexSplit& r, const RingSpan& span) const noexcept {
  const layout::NodeEntry& d = descriptor_;
  const std::uint32_t lo = ordered_height(d.star_height_lo, heights_.type);
  const std::uint32_t hi = ordered_height(d.star_height_hi, heights_.type);
  const std::uint32_t own = ordered_height(r.height, heights_.type);
  return d.star_min_x <= std::min<std::int64_t>(span.min_x, r.u.x) &&
         d.star_min_y <= std::min<std::int64_t>(span.min_y, r.u.y) &&
         std::max<std::int64_t>(span.max_x, r.u.x) <= d.star_max_x &&
         std::max<std::int64_t>(span.max_y, r.u.y) <= d.star_max_y &&
         (!r.has_height() || (lo <= own && own <= hi)) &&
         (span.low > span.high || (lo <= span.low && span.high <= hi)) &&
         d.death_min <= span.least_death;
}

/// Room for `count` more records. Each is written in its place, since to append it would copy it.
template <class Record>
Record* grow(std::vector<Record>& out, std::size_t count) {
  const std::size_t before = out.size();
  if (out.capacity() < before + count) {
    out.reserve(std::max(before + count, 2 * before));
  }
  out.resize(before + count);
  return out.data() + before;
}

/// @param predicate  Null: all records are wanted. Those of a page of which all are, are not asked
///                   for their attributes one by one.
template <class Record>
void RecordPage::decode_wanted(const AttributePredicate* predicate,
                               std::vector<Record>& out) const {
  const bool wants_all =
      predicate == nullptr || predicate->holds_for_all(attributes_of(descriptor_, heights_),
                                                       short_value(descriptor_.error_min));
  const GridBox reach = wants_all ? GridBox{} : predicate->reach();
  const std::size_t before = out.size();
  Record* next = grow(out, records());
  RunRings rings;
  for (PageRun run(*this); run.next();) {
    run.take_all();
    find_rings(run, rings);
    for (std::uint32_t k = 0; k < run.count(); ++k) {
      if (!wants_all) {
        const Attributes a = run.attributes(k);
        if (!meets(a.roi, reach) || !predicate->holds(a)) {
          continue;
        }
      }
      if (!split_of(run, k, rings, *next)) [[unlikely]] {
        out.resize(before);
        report(run.first() + k);
      }
      if constexpr (std::is_same_v<Record, PendingSplit>) {
        next->page = static_cast<std::uint32_t>(index_of(id_));
      }
      ++next;
    }
  }
  out.resize(static_cast<std::size_t>(next - out.data()));
}

void RecordPage::decode(std::vector<VertexSplit>& out) const { decode_wanted(nullptr, out); }

void RecordPage::decode_matching(const AttributePredicate& predicate,
                                 std::vector<VertexSplit>& out) const {
  decode_wanted(&predicate, out);
}

void RecordPage::decode_matching(const AttributePredicate& predicate,
                                 std::vector<PendingSplit>& out) const {
  decode_wanted(&predicate, out);
}

void RecordPage::decode(StarredRecords& out) const {
  const std::size_t before = out.size();
  decode(out.splits);
  RunRings rings;
  RingSpan span;
  for (PageRun run(*this); run.next();) {
    run.take_all();
    find_rings(run, rings);
    for (std::uint32_t k = 0; k < run.count(); ++k) {
      const VertexSplit& r = out.splits[before + run.first() + k];
      if (!ring(run, k, rings, r, out.corners, span) || !admits(r, span)) [[unlikely]] {
        out.resize(before);
        report(run.first() + k);
      }
      out.ring_end.push_back(static_cast<std::uint32_t>(out.corners.size()));
    }
  }
}

}  // namespace ptin
