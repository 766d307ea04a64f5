// SPDX-License-Identifier: GPL-3.0-or-later
#include "storage/record.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <limits>
#include <vector>

#include <gtest/gtest.h>
#include <rapidcheck.h>
#include <rapidcheck/gtest.h>

#include "storage/layout.h"

namespace ptin::test {
namespace {

using RecordBytes = std::array<std::byte, kWideRecordBytes>;

VertexSplit sample() {
  VertexSplit r;
  r.u = {1000, 2000};
  r.w = {1001, 2000};
  r.vl = {1000, 1999};
  r.vr = {999, 2001};
  r.height = 77;
  r.roi = {900, 1900, 1100, 2100};
  r.height_lo = 70;
  r.height_hi = 80;
  r.error = 1.5F;
  r.deviation = 2.5F;
  r.rank = 12;
  r.flags = VertexSplit::kLeftVoid;
  return r;
}

RecordBytes encoded(const VertexSplit& r, RecordKind kind) {
  RecordBytes bytes{};
  encode_record(r, kind, bytes);
  return bytes;
}

bool decodes(const RecordBytes& bytes, RecordKind kind) {
  VertexSplit r;
  return decode_record(std::span(bytes).first(record_bytes(kind)), kind, r);
}

rc::Gen<VertexSplit> any_record() {
  return rc::gen::exec([] {
    const auto coordinate = [] { return *rc::gen::inRange(0, kGridMax + 1); };
    VertexSplit r;
    const bool near = *rc::gen::arbitrary<bool>();
    r.u = {coordinate(), coordinate()};
    const auto neighbour = [&] {
      const auto shifted = [&](std::int32_t c) {
        return near ? std::clamp(c + *rc::gen::inRange(-32768, 32768), 0, kGridMax) : coordinate();
      };
      GridPoint p{shifted(r.u.x), shifted(r.u.y)};
      if (p == r.u) {
        p.x += p.x > 0 ? -1 : 1;
      }
      return p;
    };
    r.w = neighbour();
    r.vl = neighbour();
    r.vr = neighbour();
    r.roi = united(united(united(box_of(r.u), r.w), r.vl), r.vr);
    r.height = *rc::gen::arbitrary<std::uint32_t>();
    r.height_lo = *rc::gen::arbitrary<std::uint32_t>();
    r.height_hi = *rc::gen::arbitrary<std::uint32_t>();
    r.error = layout::to_float(*rc::gen::inRange<std::uint32_t>(0, layout::kInfinityBits + 1));
    r.deviation = layout::to_float(*rc::gen::inRange<std::uint32_t>(0, layout::kInfinityBits + 1));
    r.rank = *rc::gen::arbitrary<std::uint16_t>();
    r.flags = static_cast<std::uint16_t>(*rc::gen::inRange(0, VertexSplit::kAllFlags + 1));
    return r;
  });
}

RC_GTEST_PROP(Record, SurvivesItsEncoding, ()) {
  const VertexSplit r = *any_record();
  for (const RecordKind kind : {RecordKind::kNarrow, RecordKind::kWide}) {
    if (kind < kind_of(r)) {
      continue;
    }
    VertexSplit back;
    const RecordBytes bytes = encoded(r, kind);
    RC_ASSERT(decode_record(std::span(bytes).first(record_bytes(kind)), kind, back));
    RC_ASSERT(back == r);
  }
}

RC_GTEST_PROP(Record, DecodesSeveralAsOneByOne, ()) {
  std::vector<std::byte> bytes;
  std::vector<VertexSplit> expected;
  const auto count = *rc::gen::inRange<std::size_t>(0, 20);
  for (std::size_t i = 0; i < count; ++i) {
    const RecordBytes one = encoded(expected.emplace_back(*any_record()), RecordKind::kWide);
    bytes.insert(bytes.end(), one.begin(), one.end());
  }
  std::vector<VertexSplit> found(count);
  RC_ASSERT(decode_records(bytes, RecordKind::kWide, found) == count);
  RC_ASSERT(found == expected);
}

TEST(Record, IsNarrowExactlyWhenAllReferencesFitSixteenBits) {
  VertexSplit r = sample();
  r.u = {100000, 100000};
  r.w = {100000 + 32767, 100000};
  r.vl = {100000, 100000 - 32768};
  r.vr = {100001, 100001};
  EXPECT_EQ(kind_of(r), RecordKind::kNarrow);
  r.w.x += 1;
  EXPECT_EQ(kind_of(r), RecordKind::kWide);
  r.w.x -= 1;
  r.vl.y -= 1;
  EXPECT_EQ(kind_of(r), RecordKind::kWide);
  r.vl.y += 1;
  r.vr = {100000 - 32769, 100000};
  EXPECT_EQ(kind_of(r), RecordKind::kWide);
}

TEST(Record, StoresMinusZeroAsZero) {
  VertexSplit r = sample();
  r.error = -0.0F;
  r.deviation = -0.0F;
  EXPECT_EQ(encoded(r, RecordKind::kNarrow), [] {
    VertexSplit zero = sample();
    zero.error = 0.0F;
    zero.deviation = 0.0F;
    return encoded(zero, RecordKind::kNarrow);
  }());
}

TEST(Record, RefusesEveryFieldThatCannotBeWhatWasWritten) {
  struct Case {
    const char* name;
    void (*ruin)(VertexSplit&);
  };
  const Case cases[] = {
      {"roi left of the grid", [](VertexSplit& r) { r.roi.min_x = -1; }},
      {"roi below the grid", [](VertexSplit& r) { r.roi.min_y = -1; }},
      {"roi right of the grid", [](VertexSplit& r) { r.roi.max_x = kGridMax + 1; }},
      {"roi above the grid", [](VertexSplit& r) { r.roi.max_y = INT32_MAX; }},
      {"empty roi in x", [](VertexSplit& r) { r.roi.max_x = r.roi.min_x - 1; }},
      {"empty roi in y", [](VertexSplit& r) { r.roi.max_y = r.roi.min_y - 1; }},
      {"u outside of roi", [](VertexSplit& r) { r.roi.min_x = 1001; }},
      {"w outside of roi", [](VertexSplit& r) { r.w.x = 1101; }},
      {"vl outside of roi", [](VertexSplit& r) { r.vl.y = 1899; }},
      {"vr outside of roi", [](VertexSplit& r) { r.vr.y = 2101; }},
      {"w is u", [](VertexSplit& r) { r.w = r.u; }},
      {"vl is u", [](VertexSplit& r) { r.vl = r.u; }},
      {"vr is u", [](VertexSplit& r) { r.vr = r.u; }},
      {"unknown flag", [](VertexSplit& r) { r.flags = VertexSplit::kAllFlags + 1; }},
      {"negative error", [](VertexSplit& r) { r.error = -1.0F; }},
      {"error no number",
       [](VertexSplit& r) { r.error = std::numeric_limits<float>::quiet_NaN(); }},
      {"negative deviation", [](VertexSplit& r) { r.deviation = -1.0F; }},
      {"deviation no number",
       [](VertexSplit& r) { r.deviation = std::numeric_limits<float>::quiet_NaN(); }},
  };
  for (const RecordKind kind : {RecordKind::kNarrow, RecordKind::kWide}) {
    EXPECT_TRUE(decodes(encoded(sample(), kind), kind));
    for (const Case& c : cases) {
      VertexSplit r = sample();
      c.ruin(r);
      EXPECT_FALSE(decodes(encoded(r, kind), kind)) << c.name;
    }
  }
  RecordBytes spare = encoded(sample(), RecordKind::kNarrow);
  spare[63] = std::byte{1};
  EXPECT_FALSE(decodes(spare, RecordKind::kNarrow)) << "spare field";
  EXPECT_FALSE(decodes(RecordBytes{}, RecordKind::kNarrow)) << "zeros";
  EXPECT_FALSE(decodes(RecordBytes{}, RecordKind::kWide)) << "zeros";
}

TEST(Record, ReferencesThatRunOffTheNumbersAreRefused) {
  RecordBytes bytes = encoded(sample(), RecordKind::kWide);
  for (const std::int32_t offset : {INT32_MAX, INT32_MIN, INT32_MAX - 999}) {
    std::memcpy(bytes.data() + 48, &offset, sizeof offset);
    EXPECT_FALSE(decodes(bytes, RecordKind::kWide)) << offset;
  }
}

RC_GTEST_PROP(Record, AnyBytesThatDecodeEncodeToThemselves, ()) {
  const RecordKind kind = *rc::gen::element(RecordKind::kNarrow, RecordKind::kWide);
  RecordBytes bytes = encoded(sample(), kind);
  const auto at = *rc::gen::inRange<std::size_t>(0, record_bytes(kind));
  bytes[at] = static_cast<std::byte>(*rc::gen::arbitrary<std::uint8_t>());
  VertexSplit r;
  if (decode_record(std::span(bytes).first(record_bytes(kind)), kind, r)) {
    RC_ASSERT(encoded(r, kind) == bytes);
  }
}

}  // namespace
}  // namespace ptin::test
