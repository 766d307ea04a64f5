// SPDX-License-Identifier: GPL-3.0-or-later
//
// Any bytes as a page of records: what is decoded is sound, and encodes to the same bytes again.
// Input: kind, type of heights, number of records, then the page.
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <string>
#include <vector>

#include "engine/error.h"
#include "storage/page_records.h"
#include "storage/record.h"
#include "tests/fuzz/fuzz_target.h"

namespace {

using namespace ptin;

void require(bool condition) {
  if (!condition) {
    std::abort();
  }
}

// Everything that a record can hold.
layout::NodeEntry widest(HeightType type, std::uint32_t kind_and_count) {
  layout::NodeEntry e{};
  e.max_x = kGridMax;
  e.max_y = kGridMax;
  e.height_lo = type == HeightType::int32 ? 0x80000000U : 0xFF800000U;
  e.height_hi = type == HeightType::int32 ? 0x7FFFFFFFU : 0x7F800000U;
  e.error_max = layout::kInfinityBits;
  e.deviation_max = layout::kInfinityBits;
  e.kind_and_count = kind_and_count;
  return e;
}

class Everything final : public AttributePredicate {
 public:
  [[nodiscard]] bool holds(const Attributes&) const noexcept override { return true; }
};

void check(const VertexSplit& r, RecordKind kind, std::span<const std::byte> in) {
  require(on_grid(r.u) && on_grid(r.w) && on_grid(r.vl) && on_grid(r.vr) && !is_empty(r.roi));
  require(contains(r.roi, r.u) && contains(r.roi, r.w) && contains(r.roi, r.vl) &&
          contains(r.roi, r.vr));
  require(r.error >= 0.0F && r.deviation >= 0.0F && kind_of(r) <= kind);
  std::vector<std::byte> again(in.size());
  encode_record(r, kind, again);
  require(std::memcmp(again.data(), in.data(), in.size()) == 0);
}

}  // namespace

PTIN_FUZZ_TARGET(record_page, data, size) {
  if (size < 3) {
    return 0;
  }
  const RecordKind kind = data[0] % 2 == 0 ? RecordKind::kNarrow : RecordKind::kWide;
  const HeightEncoding heights{data[1] % 2 == 0 ? HeightType::int32 : HeightType::float32, 1.0,
                               0.0};
  const std::uint32_t count = data[2];
  std::vector<std::byte> page(4096);
  std::memcpy(page.data(), data + 3, std::min<std::size_t>(size - 3, page.size()));
  const std::uint32_t wide = kind == RecordKind::kWide ? layout::kWidePage : 0;
  const std::string path = "fuzz";
  std::vector<VertexSplit> records, matching;
  try {
    const DescribedPage described(path, PageId{0}, widest(heights.type, wide | count), heights,
                                  4096);
    described.decode(page, records);
    require(records.size() == count);
    for (std::size_t i = 0; i < records.size(); ++i) {
      check(records[i], kind, std::span(page).subspan(i * record_bytes(kind), record_bytes(kind)));
    }
    described.decode_matching(page, Everything(), matching);
    require(matching == records);
  } catch (const Error& e) {
    require(e.code() == ErrorCode::corruption && records.empty());
  }
  return 0;
}
