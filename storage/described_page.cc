// SPDX-License-Identifier: GPL-3.0-or-later
#include "storage/described_page.h"

#include <algorithm>
#include <bit>
#include <limits>
#include <type_traits>

#include "engine/error.h"
#include "storage/box_lanes.h"
#include "storage/living_page.h"
#include "storage/record_page.h"
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
  RingSpan span;
  for (std::size_t i = 0; i < records(); ++i) {
    const VertexSplit& r = out.splits[before + i];
    if (!page.ring(i, place, r, out.corners, span) || !admits(r, span)) [[unlikely]] {
      out.resize(before);
      report(i);
    }
    out.ring_end.push_back(static_cast<std::uint32_t>(out.corners.size()));
  }
}

bool DescribedPage::admits(const VertexSplit& r, const RingSpan& span) const noexcept {
  const layout::NodeEntry& d = descriptor_;
  const std::uint32_t lo = ordered_height(d.star_height_lo, heights_.type);
  const std::uint32_t hi = ordered_height(d.star_height_hi, heights_.type);
  const std::uint32_t own = ordered_height(r.height, heights_.type);
  const bool is_void = (r.flags & VertexSplit::kVertexVoid) != 0;
  return d.star_min_x <= std::min<std::int64_t>(span.min_x, r.u.x) &&
         d.star_min_y <= std::min<std::int64_t>(span.min_y, r.u.y) &&
         std::max<std::int64_t>(span.max_x, r.u.x) <= d.star_max_x &&
         std::max<std::int64_t>(span.max_y, r.u.y) <= d.star_max_y &&
         (is_void || (lo <= own && own <= hi)) &&
         (span.low > span.high || (lo <= span.low && span.high <= hi)) &&
         d.death_min <= span.least_death;
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
  RingSpan span;
  for (std::uint32_t run = 0; run < records(); run += RecordPage::kRun) {
    const std::uint32_t count = std::min<std::uint32_t>(RecordPage::kRun, records() - run);
    for (std::uint64_t left = page.near_stars(run, count, filter, false); left != 0;
         left &= left - 1) {
      const std::uint32_t i = run + static_cast<std::uint32_t>(std::countr_zero(left));
      if (!page.may_live(i, place, level)) {
        continue;
      }
      const std::size_t first = out.corners.size();
      if (!page.head(i, r) || admitted(std::span(&r, 1)) == 0 ||
          !page.ring(i, place, r, out.corners, span) || !admits(r, span)) [[unlikely]] {
        out.corners.resize(first);
        out.resize(before);
        report(i);
      }
      out.splits.push_back(r);
      out.ring_end.push_back(static_cast<std::uint32_t>(out.corners.size()));
    }
  }
}

void DescribedPage::decode_living(std::span<const std::byte> bytes, const StarFilter& filter,
                                  LivingStars& out) const {
  const RecordPage page = open(bytes);
  const std::size_t before = out.stars.size();
  const std::uint32_t sound = LivingPage(page, descriptor_, heights_, filter).take(out);
  if (sound < records()) [[unlikely]] {
    out.keep(before);
    report(sound);
  }
}

void DescribedPage::decode_matching(std::span<const std::byte> bytes,
                                    const AttributePredicate& predicate,
                                    std::vector<VertexSplit>& out) const {
  if (heights_.type == HeightType::int32) {
    decode_within(bytes, Bounds<std::int32_t>(descriptor_), predicate, out);
  } else {
    decode_within(bytes, Bounds<float>(descriptor_), predicate, out);
  }
}

/// @param bounds  Those of the descriptor. A page of which all records are wanted is not asked for
///     its attributes record by record.
template <class Bounds>
void DescribedPage::decode_within(std::span<const std::byte> bytes, const Bounds& bounds,
                                  const AttributePredicate& predicate,
                                  std::vector<VertexSplit>& out) const {
  const RecordPage page = open(bytes);
  const GridBox reach = predicate.reach();
  const bool wants_all = predicate.holds_for_all(attributes_of(descriptor_, heights_),
                                                 short_value(descriptor_.error_min));
  const std::size_t before = out.size();
  RingPlace place;
  RecordPage::RecordRun run;
  for (std::uint32_t first = 0; first < records(); first += RecordPage::kRun) {
    page.read_run(first, std::min<std::uint32_t>(RecordPage::kRun, records() - first), run);
    for (std::uint32_t k = 0; k < run.count; ++k) {
      if (!wants_all) {
        const Attributes a = page.attributes(run, k);
        if (!meets(a.roi, reach) || !predicate.holds(a)) {
          continue;
        }
      }
      VertexSplit r;
      if (!page.split(run, k, place, r) || bounds.excludes(r)) [[unlikely]] {
        out.resize(before);
        report(first + k);
      }
      out.push_back(r);
    }
  }
}

}  // namespace ptin
