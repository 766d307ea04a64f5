// SPDX-License-Identifier: GPL-3.0-or-later
//
// Any bytes as a page of records and stars: what is decoded is sound, is the same whatever is asked
// first, and comes back when it is packed again. Input: type of heights (1: float32) and format (2: of
// format 2), then the page.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <functional>
#include <numeric>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "engine/error.h"
#include "engine/geometry/orient.h"
#include "engine/query/living/living_page.h"
#include "storage/page_packer.h"
#include "storage/pending_split.h"
#include "storage/record_page.h"
#include "tests/fuzz/fuzz_target.h"
#include "tests/support/kept_interval.h"
#include "tests/support/widest_entry.h"

namespace {

using namespace ptin;
using fuzz::require;

constexpr std::uint32_t kPageBytes = 4096;

class Everything final : public AttributePredicate {
 public:
  [[nodiscard]] bool holds(const Attributes&) const noexcept override { return true; }
};

void check(const VertexSplit& r, std::span<const RingCorner> ring, const HeightEncoding& heights) {
  require(on_grid(r.u) && on_grid(r.w) && on_grid(r.vl) && on_grid(r.vr) && !is_empty(r.roi));
  require(contains(r.roi, r.u) && contains(r.roi, r.w) && contains(r.roi, r.vl) &&
          contains(r.roi, r.vr));
  require(r.error >= 0.0F && r.deviation >= 0.0F && ring.size() >= 3 &&
          ring.size() <= layout::kMostDegree && is_star(r, ring, heights));
}

// Asks the page for each record and ring by itself, also for those that are not sound.
void ask_from_the_end(const RecordPage& page, const StarredRecords& records) {
  std::vector<RingCorner> ring;
  RingSpan span;
  RunRings rings;
  for (PageRun run(page); run.next();) {
    run.take_all();
    page.find_rings(run, rings);
    for (std::uint32_t k = run.count(); k-- > 0;) {
      const std::size_t i = run.first() + k;
      VertexSplit r;
      ring.clear();
      const bool is_sound = page.head(run, k, r) && page.ring(run, k, rings, r, ring, span);
      const bool is_split = page.split(run, k, rings, r);
      static_cast<void>(run.attributes(k));
      if (!records.empty()) {
        require(is_sound && is_split && r == records.splits[i] &&
                std::ranges::equal(ring, records.ring(i)));
      }
    }
  }
}

// Takes out what lives at a level below all others and at 0: triangles on the grid.
void ask_for_living(const RecordPage& page) {
  for (const double level : {-1.0, 0.0}) {
    LivingFilter filter;
    filter.level = level;
    LivingStars living;
    try {
      take_living(page, filter, living);
    } catch (const Error& e) {
      require(e.code() == ErrorCode::corruption && living.corners.size() == 0);
    }
    const LivingCorner* c = living.corners.data();
    for (std::size_t i = 0; i < living.stars.size(); ++i) {
      const LivingStar& star = living.stars.data()[i];
      for (; c != living.corners.data() + star.corner_end; ++c) {
        require((c->flags & LivingCorner::kLives) == 0 ||
                (on_grid(star.u) && on_grid(c[0].position) && on_grid(c[1].position) &&
                 orient(star.u, c[0].position, c[1].position) > 0));
      }
    }
  }
}

/// The records in the order in which a page has them, each with its number here.
std::vector<std::size_t> order_on_page(const StarredRecords& records, const PageForm& form) {
  std::vector<std::size_t> order(records.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  if (!form.is_plain()) {
    std::ranges::stable_sort(order, std::ranges::greater(),
                             [&](std::size_t i) { return records.splits[i].error; });
  }
  return order;
}

void pack_again(const StarredRecords& records, const HeightEncoding& heights,
                const PageForm& form) {
  PagePacker packer(kPageBytes, heights, form);
  for (std::size_t i = 0; i < records.size(); ++i) {
    if (!packer.add(records.splits[i], records.ring(i))) {
      return;  // A page that is fuller than a packer's, which leaves a byte a run of rings.
    }
  }
  layout::NodeEntry entry;
  const std::span<const std::byte> packed = packer.finish(entry);
  StarredRecords back;
  const std::string path = "fuzz";
  RecordPage(path, PageId{0}, entry, heights, form, packed, nullptr).decode(back);
  const auto no_minus_zero = [&](HeightBits h) {
    return heights.type == HeightType::float32 && h == 0x80000000 ? 0U : h;
  };
  const std::vector<std::size_t> order = order_on_page(records, form);
  require(back.size() == records.size());
  for (std::size_t i = 0; i < records.size(); ++i) {
    VertexSplit r = records.splits[order[i]];
    if (!form.is_plain()) test::keep_interval(r, heights.type);
    r.height = no_minus_zero(r.height);
    r.height_lo = no_minus_zero(r.height_lo);
    r.height_hi = no_minus_zero(r.height_hi);
    require(back.splits[i] == r);
    require(std::ranges::equal(back.ring(i), records.ring(order[i]),
                               [&](const RingCorner& packed_again, RingCorner c) {
                                 c.height = no_minus_zero(c.height);
                                 return packed_again == c;
                               }));
  }
}

}  // namespace

PTIN_FUZZ_TARGET(record_page, data, size) {
  if (size < 1 + sizeof(layout::PageHeader)) {
    return 0;
  }
  const HeightEncoding heights{data[0] % 2 == 0 ? HeightType::int32 : HeightType::float32, 1.0,
                               0.0};
  const PageForm form{.major_version = (data[0] & 2U) != 0 ? std::uint16_t{2} : std::uint16_t{3}};
  std::vector<std::byte> page(kPageBytes);
  std::memcpy(page.data(), data + 1, std::min<std::size_t>(size - 1, page.size()));
  layout::PageHeader header;
  std::memcpy(&header, page.data(), sizeof header);
  const std::string path = "fuzz";
  std::optional<RecordPage> numbers;
  try {
    numbers.emplace(path, PageId{0}, test::widest_entry(heights.type, header.records), heights,
                    form, page, nullptr);
  } catch (const Error& e) {
    require(e.code() == ErrorCode::corruption);
    return 0;
  }
  StarredRecords records;
  std::vector<VertexSplit> splits;
  try {
    numbers->decode(records);
    require(records.size() == numbers->records());
    numbers->decode_matching(Everything(), splits);
    require(splits == records.splits);
    std::vector<PendingSplit> pending;
    numbers->decode_matching(Everything(), pending);
    require(std::ranges::equal(pending, splits, [](const PendingSplit& p, const VertexSplit& r) {
      const PendingSplit of_r = pending_of(r, PageId{0});
      return std::memcmp(&p, &of_r, sizeof p) == 0;
    }));
  } catch (const Error& e) {
    require(e.code() == ErrorCode::corruption && records.empty() && records.corners.empty());
  }
  ask_for_living(*numbers);
  for (std::size_t i = 0; i < records.size(); ++i) {
    check(records.splits[i], records.ring(i), heights);
  }
  ask_from_the_end(*numbers, records);
  if (!records.empty()) {
    pack_again(records, heights, form);
  }
  return 0;
}
