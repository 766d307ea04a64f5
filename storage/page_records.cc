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
    least_ = Lanes<Code>{lane(e.height_lo), least_code(), lane(e.error_min), Code{0}};
    most_ = Lanes<Code>{most_code(), lane(e.height_hi), lane(e.error_max), lane(e.deviation_max)};
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
  const bool known =
      (descriptor.kind_and_count & ~(layout::kWidePage | (layout::kWidePage - 1))) == 0;
  if (!known || records() == 0 || records() > page_bytes / record_bytes(kind()) ||
      !is_sound(descriptor, heights)) [[unlikely]] {
    throw Error(ErrorCode::corruption,
                "the descriptor of the page holds values that no program wrote",
                path + ", page " + std::to_string(index_of(id)));
  }
}

void DescribedPage::report(std::size_t record) const {
  throw Error(ErrorCode::corruption,
              "record " + std::to_string(record) +
                  " holds values that no program wrote, or that its page's descriptor excludes",
              path_ + ", page " + std::to_string(index_of(id_)));
}

void DescribedPage::decode(std::span<const std::byte> bytes, std::vector<VertexSplit>& out) const {
  const std::size_t before = out.size();
  out.resize(before + records());
  const std::span<VertexSplit> decoded(out.data() + before, records());
  std::size_t sound = decode_records(bytes, kind(), decoded);
  sound = std::min(sound, admitted(decoded.first(sound)));
  if (sound < decoded.size()) [[unlikely]] {
    out.resize(before);
    report(sound);
  }
}

std::size_t DescribedPage::admitted(std::span<const VertexSplit> records) const noexcept {
  return heights_.type == HeightType::int32
             ? first_excluded(Bounds<std::int32_t>(descriptor_), records)
             : first_excluded(Bounds<float>(descriptor_), records);
}

void DescribedPage::decode_matching(std::span<const std::byte> bytes,
                                    const AttributePredicate& predicate,
                                    std::vector<VertexSplit>& out) const {
  const std::size_t step = record_bytes(kind());
  const std::size_t before = out.size();
  std::array<std::uint16_t, kMostRecords> near;  // NOLINT: written before it is read
  const std::size_t count = find_near(bytes, predicate.reach(), near);
  std::size_t matching = 0;  // Counted without branches, as in find_near().
  for (std::size_t k = 0; k < count; ++k) {
    layout::RecordHead head;
    std::memcpy(&head, bytes.data() + near[k] * step, sizeof head);
    const bool holds = predicate.holds(attributes_of(head, heights_));
    near[matching] = near[k];
    matching += holds ? 1 : 0;
  }
  out.resize(before + matching);
  const std::span<VertexSplit> decoded(out.data() + before, matching);
  std::size_t sound = 0;
  while (sound < matching &&
         decode_record(bytes.subspan(near[sound] * step, step), kind(), decoded[sound])) {
    ++sound;
  }
  sound = std::min(sound, admitted(decoded.first(sound)));
  if (sound < matching) [[unlikely]] {
    out.resize(before);
    report(near[sound]);
  }
}

/// Lists in `near` the records whose roi meets a box, and returns their number. Without branches,
/// since it cannot be predicted which records meet it: of the records on a point's pages, one in
/// three does.
std::size_t DescribedPage::find_near(std::span<const std::byte> bytes, const GridBox& box,
                                     std::span<std::uint16_t> near) const noexcept {
  const std::size_t step = record_bytes(kind());
  const Int4 ends{box.max_x, box.max_y, box.min_x, box.min_y};
  const Int4 minima{-1, -1, 0, 0};
  std::size_t count = 0;
  for (std::uint32_t i = 0; i < records(); ++i) {
    const auto roi = lanes::load<Int4>(bytes.data() + i * step);
    const Int4 outside = ((roi > ends) & minima) | ((roi < ends) & ~minima);
    near[count] = static_cast<std::uint16_t>(i);
    count += lanes::any(outside) ? 0 : 1;
  }
  return count;
}

}  // namespace ptin
