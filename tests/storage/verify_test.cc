// SPDX-License-Identifier: GPL-3.0-or-later
#include "storage/verify.h"

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <functional>
#include <random>
#include <span>

#include <gtest/gtest.h>
#include <sys/resource.h>

#include "engine/error.h"
#include "storage/index_shape.h"
#include "storage/page_packer.h"
#include "tests/storage/store_fixture.h"

namespace ptin::test {
namespace {

using layout::SectionKind;

class Verify : public testing::Test {
 protected:
  void write(const StoreContent& content) { write_store(path_, content, {.overwrite = true}); }

  // Changes the sound file's bytes, seals it, and gives the faults.
  VerifyReport after(const std::function<void(Bytes&)>& change, const VerifyOptions& options = {}) {
    Bytes bytes = read_file(path_);
    change(bytes);
    seal(bytes);
    write_file(folder_.file("b.ptin"), bytes);
    return verify_store(folder_.file("b.ptin"), options);
  }

  static bool tells(const VerifyReport& report, const std::string& what) {
    for (const VerifyFault& f : report.faults) {
      if (f.what.find(what) != std::string::npos) {
        return true;
      }
    }
    return false;
  }

  TestFolder folder_{TestFolder::Size::kSmall};
  std::string path_ = folder_.file("a.ptin");
};

std::uint64_t leaf_entry(const Bytes& file, std::uint64_t page) {
  const IndexShape shape = shape_of(file, header_of(file));
  const auto [leaf, entry] = shape.leaf_entry(page);
  return section_of(file, SectionKind::kIndex).offset +
         shape.position(0, leaf) * layout::kNodeBytes + 16 + entry * sizeof(layout::NodeEntry);
}

std::uint64_t page_offset(const Bytes& file, std::uint64_t page) {
  const auto h = header_of(file);
  return PageSlots{h.page_count, h.first_page, section_of(file, SectionKind::kPages).offset,
                   h.page_bytes}
      .offset_of(PageId{page});
}

TEST_F(Verify, FindsNothingInASoundStore) {
  for (const HeightType type : {HeightType::float32, HeightType::int32}) {
    for (const std::size_t records : {0U, 1U, 100U, 9000U}) {
      write(random_content({.segments = 2, .records = records, .type = type}));
      const VerifyReport report = verify_store(path_);
      EXPECT_TRUE(report.is_sound()) << report.faults[0].what << " " << report.faults[0].where;
      EXPECT_EQ(report.records, 2 * records);
      EXPECT_EQ(report.pages, StoreFile::open(path_)->pages().page_count());
      EXPECT_EQ(report.index_nodes, StoreFile::open(path_)->index_shape().total_nodes());
    }
  }
}

TEST_F(Verify, NamesTheDamagedPageAndGoesOn) {
  write(random_content({.segments = 1, .records = 2000}));
  Bytes bytes = read_file(path_);
  bytes[page_offset(bytes, 3) + 100] ^= std::byte{1};
  bytes[page_offset(bytes, 9) + 100] ^= std::byte{1};
  write_file(path_, bytes);
  const VerifyReport report = verify_store(path_);
  ASSERT_EQ(report.faults.size(), 2U);
  EXPECT_EQ(report.faults[0].where, "page 3");
  EXPECT_EQ(report.faults[1].where, "page 9");
}

TEST_F(Verify, NamesTheDamagedNode) {
  write(random_content({.segments = 2, .records = 6000}));
  Bytes bytes = read_file(path_);
  bytes[leaf_entry(bytes, 90)] ^= std::byte{1};
  write_file(path_, bytes);
  const VerifyReport report = verify_store(path_);
  ASSERT_EQ(report.faults.size(), 1U);
  EXPECT_EQ(report.faults[0].where, "index level 0, node 1");
}

TEST_F(Verify, StopsAtTheLargestNumberOfFaults) {
  write(random_content({.segments = 1, .records = 2000}));
  Bytes bytes = read_file(path_);
  for (std::uint64_t page = 0; page < 20; ++page) {
    bytes[page_offset(bytes, page) + 100] ^= std::byte{1};
  }
  write_file(path_, bytes);
  VerifyOptions options;
  options.max_faults = 5;
  const VerifyReport report = verify_store(path_, options);
  EXPECT_EQ(report.faults.size(), 5U);
  EXPECT_TRUE(report.stopped_early);
}

TEST_F(Verify, ComparesEachDescriptorWithItsRecords) {
  write(random_content({.segments = 1, .records = 12000, .side = 1 << 16}));
  const auto expect_told = [&](const char* name,
                               const std::function<void(layout::NodeEntry&)>& change) {
    const VerifyReport report = after([&](Bytes& bytes) {
      const std::uint64_t at = leaf_entry(bytes, 100);
      auto entry = object_at<layout::NodeEntry>(bytes, at);
      change(entry);
      set_object(bytes, at, entry);
    });
    EXPECT_FALSE(report.is_sound()) << name;
  };
  expect_told("larger box", [](auto& e) { e.max_x += 1; });
  expect_told("smaller box", [](auto& e) { e.min_y += 1; });
  expect_told("off the grid", [](auto& e) { e.min_x = -1; });
  expect_told("height", [](auto& e) { e.height_lo ^= 1; });
  expect_told("height no number", [](auto& e) { e.height_hi = 0x7FC00000; });
  expect_told("minus zero", [](auto& e) { e.height_lo = 0x80000000; });
  expect_told("larger box of stars", [](auto& e) { e.star_min_x -= 1; });
  expect_told("smaller box of stars", [](auto& e) { e.star_max_y -= 1; });
  expect_told("stars off the grid", [](auto& e) { e.star_max_x = kGridMax + 1; });
  expect_told("stars out of the box", [](auto& e) { e.star_min_y = e.min_y - 1; });
  expect_told("no stars", [](auto& e) { std::swap(e.star_min_y, e.star_max_y); });
  expect_told("stars' height", [](auto& e) { e.star_height_hi += 1; });
  expect_told("stars' height", [](auto& e) { e.star_height_lo += 1; });
  expect_told("stars' height no number", [](auto& e) { e.star_height_lo = 0x7FC00000; });
  expect_told("error", [](auto& e) { e.error_max -= 1; });
  expect_told("error no number", [](auto& e) { e.error_max = 0x7FC0; });
  expect_told("error order", [](auto& e) { e.error_min = e.error_max + 1; });
  expect_told("least error", [](auto& e) { e.error_min ^= 1; });
  expect_told("deviation", [](auto& e) { e.deviation_max -= 1; });
  expect_told("deviation no number", [](auto& e) { e.deviation_max = 0x7F81; });
  expect_told("death", [](auto& e) { e.death_min ^= 1; });
  expect_told("death no number", [](auto& e) { e.death_min = 0x7F82; });
  expect_told("reserved", [](auto& e) { e.reserved = 1; });
  expect_told("no record", [](auto& e) { e.records = 0; });
  expect_told("too many records", [](auto& e) { e.records = 513; });
  expect_told("endless records", [](auto& e) { e.records = UINT32_MAX; });
  expect_told("fewer records", [](auto& e) { e.records -= 1; });
}

TEST_F(Verify, ComparesInnerEntriesWithWhatIsBelow) {
  write(random_content({.segments = 1, .records = 12000}));
  const auto root_entry = [](const Bytes& b) {
    return section_of(b, SectionKind::kIndex).offset + 16;
  };
  EXPECT_TRUE(tells(after([&](Bytes& b) {
                      auto e = object_at<layout::NodeEntry>(b, root_entry(b));
                      e.max_x -= 1;
                      set_object(b, root_entry(b), e);
                    }),
                    "union"));
  EXPECT_TRUE(tells(after([&](Bytes& b) {
                      auto e = object_at<layout::NodeEntry>(b, root_entry(b));
                      e.records = 1;
                      set_object(b, root_entry(b), e);
                    }),
                    "values that no program wrote"));
  const auto root = [](const Bytes& b) { return section_of(b, SectionKind::kIndex).offset; };
  for (const std::size_t field : {0U, 4U, 8U}) {
    EXPECT_TRUE(
        tells(after([&](Bytes& b) { b[root(b) + field] ^= std::byte{1}; }), "another place"))
        << field;
  }
  EXPECT_TRUE(tells(after([&](Bytes& b) { b[root(b) + 4095] = std::byte{1}; }), "unused entries"));
}

TEST_F(Verify, FindsPagesThatCannotBe) {
  write(random_content({.segments = 1, .records = 100}));
  EXPECT_TRUE(tells(after([](Bytes& b) { b[page_offset(b, 0) + 47] = std::byte{1}; }),
                    "begins with numbers"))
      << "reserved";
  EXPECT_TRUE(tells(after([](Bytes& b) {
                      const std::uint64_t last = header_of(b).page_count - 1;
                      b[page_offset(b, last) + 4095] = std::byte{1};
                    }),
                    "as they are to be packed"));
}

// Every bit of a page, with all checksums made right: what is not found is a page of other records
// that a writer packs so.
TEST_F(Verify, FindsEachFlippedBitOfAPageThatIsNoPageOfOtherRecords) {
  write(random_content({.segments = 1, .records = 3, .side = 1000}));
  const Bytes sound = read_file(path_);
  const std::uint64_t begin = page_offset(sound, 0);
  const HeightEncoding heights;
  std::size_t other_records = 0;
  std::size_t used = 4096;  // The bytes from `used` on are zero.
  for (; sound[begin + used - 1] == std::byte{0}; --used) {
  }
  for (std::size_t bit = 0; bit < std::size_t{4096} * 8; bit += bit / 8 < used ? 1 : 61) {
    const VerifyReport report =
        after([&](Bytes& b) { b[begin + bit / 8] ^= static_cast<std::byte>(1U << bit % 8); });
    if (report.is_sound()) {
      const auto store = StoreFile::open(folder_.file("b.ptin"));
      const StarredRecords records = read_all_starred(*store);
      PagePacker packer(4096, heights, {});
      for (std::size_t i = 0; i < records.size(); ++i) {
        ASSERT_TRUE(packer.add(records.splits[i], records.ring(i)));
      }
      layout::NodeEntry entry;
      const Bytes file = read_file(folder_.file("b.ptin"));
      ASSERT_TRUE(std::ranges::equal(packer.finish(entry), std::span(file).subspan(begin, 4096)));
      ASSERT_FALSE(
          bit / 8 < offsetof(layout::PageHeader, x) ||
          (bit / 8 >= offsetof(layout::PageHeader, width) && bit / 8 < sizeof(layout::PageHeader)))
          << "a count or a width";
      ++other_records;
    }
  }
  EXPECT_GT(other_records, 0U);
  EXPECT_LT(other_records, used * 8 / 2);
}

TEST_F(Verify, FindsGapsThatAreNotZero) {
  write(random_content({.segments = 1, .records = 100}));
  EXPECT_TRUE(tells(
      after([](Bytes& b) { b[section_of(b, SectionKind::kIndex).offset - 1] = std::byte{1}; }),
      "unused bytes"));
}

long peak_kib() {
  rusage usage{};
  ::getrusage(RUSAGE_SELF, &usage);
  return usage.ru_maxrss;
}

TEST_F(Verify, LooksAtALargeSectionOfALaterVersionWithLittleMemory) {
  constexpr std::uint64_t kBytes = std::uint64_t{256} << 20;
  write(random_content({.segments = 1, .records = 100}));
  Bytes front = with_room_for_a_section(read_file(path_), kBytes);
  const std::uint64_t end = front.size() + kBytes;
  RunningChecksum zeros;
  for (const Bytes part(std::size_t{1} << 20); end - front.size() > zeros.bytes();) {
    zeros.add(part);
  }
  std::vector<layout::SectionEntry> sections = sections_of(front);
  sections.back().checksum = zeros.value();
  set_sections(front, sections);
  seal(front);
  write_file(path_, front);
  std::filesystem::resize_file(path_, end);  // zeros that take no room on the disk
  VerifyOptions options;
  options.memory_bytes = std::uint64_t{1} << 20;
  const long before = peak_kib();
  const VerifyReport report = verify_store(path_, options);
  EXPECT_TRUE(report.is_sound()) << report.faults[0].what;
  EXPECT_LT(peak_kib() - before, 32 << 10);
  std::fstream(path_, std::ios::binary | std::ios::in | std::ios::out)
      .seekp(static_cast<std::streamoff>(end - 1))
      .put('x');
  EXPECT_TRUE(tells(verify_store(path_, options), "does not match its checksum"));
}

TEST_F(Verify, FindsMetadataThatIsNotJson) {
  StoreContent content = flat_square(10);
  content.metadata = "{\"a\":";
  write(content);
  EXPECT_TRUE(tells(verify_store(path_), "not a JSON object"));
}

TEST_F(Verify, FindsTotalsThatDoNotAddUp) {
  write(random_content({.segments = 1, .records = 100}));
  EXPECT_TRUE(tells(after([](Bytes& b) {
                      auto h = header_of(b);
                      h.max_rank += 1;
                      set_header(b, h);
                    }),
                    "largest rank"));
  EXPECT_TRUE(tells(after([](Bytes& b) {
                      const std::uint64_t at = section_of(b, SectionKind::kErrorTable).offset;
                      b[at + 4] ^= std::byte{1};
                    }),
                    "the table is not"));
}

TEST_F(Verify, FindsHeightsOutOfTheHeader) {
  StoreContent content = random_content({.segments = 1, .records = 100});
  const auto told = [&](const std::function<void(StoreContent&)>& change) {
    StoreContent changed = content;
    change(changed);
    write(changed);
    return tells(verify_store(path_), "in the header");
  };
  EXPECT_FALSE(told([](auto&) {}));
  EXPECT_TRUE(told([](auto& c) { c.facts.max_height = 11.5; }));
  EXPECT_TRUE(told([](auto& c) { c.facts.min_height = 12.5; }));
}

TEST_F(Verify, FindsIntervalsOfHeightsOutOfTheHeader) {
  const auto told = [&](double low, double high) {
    StoreContent content =
        random_content({.segments = 1, .records = 100, .type = HeightType::int32});
    content.facts.min_height = low;
    content.facts.max_height = high;
    VertexSplit& r = content.segments[0].splits[42];
    r.height_lo = content.facts.heights.bits(-600.0);  // -50
    r.height_hi = content.facts.heights.bits(4600.0);  // 1250
    write(content);
    const VerifyReport report = verify_store(path_);
    EXPECT_LE(report.faults.size(), 1U) << report.faults[0].what << report.faults[1].what;
    for (const VerifyFault& fault : report.faults) {
      EXPECT_EQ(fault.where.substr(0, 5), "page ") << fault.where;
    }
    return tells(report, "reaches out of the least and largest");
  };
  EXPECT_FALSE(told(-50.0, 1250.0));
  // Pages keep such an interval in units of 512 steps of 0.25, and round it outward.
  EXPECT_TRUE(told(-50.0 + 128.0, 1250.0));
  EXPECT_TRUE(told(-50.0, 1250.0 - 128.0));
}

TEST_F(Verify, FindsHeightsOfTheHeaderThatNoSampleHas) {
  struct Facts {
    double low, high, base_error;
    std::uint64_t samples;
    bool free_of_voids;
  };
  const auto told = [&](const Facts& facts) {
    StoreContent content = flat_square(10);  // four vertices of height 12
    content.facts.min_height = facts.low;
    content.facts.max_height = facts.high;
    content.facts.base_error = facts.base_error;
    content.facts.source_samples = facts.samples;
    content.facts.free_of_voids = facts.free_of_voids;
    write(content);
    return tells(verify_store(path_), "farther from those of the vertices");
  };
  for (const bool free_of_voids : {true, false}) {
    EXPECT_FALSE(told({12, 12, 0, 4, free_of_voids}));
    EXPECT_TRUE(told({11, 12, 0, 4, free_of_voids}));
    EXPECT_TRUE(told({12, 13, 5, 4, free_of_voids}));
  }
  EXPECT_FALSE(told({11, 13, 1, 5, true})) << "a sample was left out";
  EXPECT_TRUE(told({11, 13, 0.9, 5, true}));
  EXPECT_TRUE(told({10.5, 12, 1, 5, true}));
  EXPECT_FALSE(told({1, 99, 0, 5, false})) << "a sample may have become void";
}

TEST_F(Verify, FindsARegionOfInfluenceThatReachesOutOfTheBounds) {
  constexpr std::int32_t kSide = 1000;
  const auto told = [&](const std::function<void(GridBox&)>& change) {
    StoreContent content = random_content({.segments = 1, .records = 100, .side = kSide});
    // Within the domain, and away from 0 so that there is room on the grid on every side.
    const auto move = [](GridPoint& p) { p = {p.x + 10, p.y + 10}; };
    for (CoarsestTin::V& v : content.t0.vertices) move(v.position);
    content.facts.bounds = {10, 10, kSide + 10, kSide + 10};
    for (RingCorner& c : content.segments[0].corners) move(c.position);
    for (VertexSplit& r : content.segments[0].splits) {
      for (GridPoint* p : {&r.u, &r.w, &r.vl, &r.vr}) move(*p);
      r.roi = {r.roi.min_x + 10, r.roi.min_y + 10, r.roi.max_x + 10, r.roi.max_y + 10};
    }
    change(content.segments[0].splits[42].roi);
    write(content);
    const VerifyReport report = verify_store(path_);
    EXPECT_LE(report.faults.size(), 1U);
    return tells(report, "reaches out of the bounds");
  };
  EXPECT_FALSE(told([](GridBox&) {}));
  EXPECT_FALSE(told([](GridBox& b) { b = {10, 10, kSide + 10, kSide + 10}; })) << "all of it";
  EXPECT_TRUE(told([](GridBox& b) { b.min_x = 9; }));
  EXPECT_TRUE(told([](GridBox& b) { b.min_y = 9; }));
  EXPECT_TRUE(told([](GridBox& b) { b.max_x = kSide + 11; }));
  EXPECT_TRUE(told([](GridBox& b) { b.max_y = kSide + 11; }));
}

TEST_F(Verify, FindsAVertexThatComesTwice) {
  // By one bit a position in the small square, by sorting parts in the large one.
  for (const std::int32_t side : {1000, 1 << 20}) {
    StoreContent content = random_content({.segments = 2, .records = 500, .side = side});
    const std::span<const RingCorner> ring = content.segments[0].ring(3);
    add_star(content.segments[1], content.segments[0].splits[3], {ring.begin(), ring.end()});
    write(content);
    VerifyOptions options;
    options.memory_bytes = side == 1000 ? std::uint64_t{1} << 20 : 1;
    EXPECT_TRUE(tells(verify_store(path_, options), "comes twice")) << side;
  }
}

TEST_F(Verify, ComparesKeysInSeveralPassesWhenMemoryIsShort) {
  write(random_content({.segments = 2, .records = 5000}));
  VerifyOptions options;
  options.memory_bytes = 1;
  std::uint64_t done = 0;
  const VerifyReport report = verify_store(
      path_, options, {}, [&](std::uint64_t d, std::uint64_t total) { done = d <= total ? d : 0; });
  EXPECT_TRUE(report.is_sound());
  EXPECT_GT(report.key_passes, 5U);
  EXPECT_EQ(report.records, 10000U);
}

TEST_F(Verify, FindsAVertexOfT0AmongTheRecords) {
  StoreContent content = random_content({.segments = 1, .records = 10, .side = 1000});
  content.segments[0] = {};
  VertexSplit r;
  r.height = content.facts.heights.bits(12.0);
  r.flags = VertexSplit::kNoRight;  // in the corner of the square
  add_star(content.segments[0], r, {{1, 0}, {1, 1}, {0, 1}}, content.facts.heights);
  write(content);
  EXPECT_TRUE(tells(verify_store(path_), "comes twice"));
}

TEST_F(Verify, FindsVoidsThatTheHeaderDenies) {
  const auto told = [&](const std::function<void(StoreContent&)>& change) {
    StoreContent content = flat_square(1000);
    content.facts.free_of_voids = true;
    VertexSplit r;
    r.u = {500, 500};
    r.height = content.facts.heights.bits(12.0);
    r.error = 1.0F;
    content.segments.resize(1);
    std::mt19937_64 random(1);
    add_star(content.segments[0], r, made_ring(r.u, content.facts.bounds, 6, 50, random),
             content.facts.heights);
    change(content);
    name_by_ring(content.segments[0].splits[0], content.segments[0].ring(0));
    write(content);
    return tells(verify_store(path_), "there are no voids");
  };
  EXPECT_FALSE(told([](auto&) {}));
  EXPECT_TRUE(told([](auto& c) { c.t0.triangles[0].is_void = 1; }));
  for (const std::size_t corner : {0U, 3U, 5U}) {
    EXPECT_TRUE(told([&](auto& c) { c.segments[0].corners[corner].flags = RingCorner::kVoid; }));
  }
}

TEST_F(Verify, FindsT0ThatDoesNotCoverItsDomain) {
  const auto told = [&](const std::function<void(StoreContent&)>& change, const std::string& what) {
    StoreContent content = flat_square(100);
    change(content);
    write(content);
    return tells(verify_store(path_), what);
  };
  EXPECT_TRUE(told([](auto& c) { std::swap(c.t0.triangles[0].v[0], c.t0.triangles[0].v[1]); },
                   "counter-clockwise"));
  EXPECT_TRUE(told([](auto& c) { c.t0.triangles.pop_back(); }, "stands in no triangle"));
  EXPECT_TRUE(told([](auto& c) { c.t0.triangles.push_back(c.t0.triangles[0]); }, "same edge"));
  EXPECT_TRUE(told([](auto& c) { c.t0.triangles.clear(); }, "no triangle"));
  EXPECT_TRUE(told([](auto& c) { c.facts.bounds.max_x += 1; }, "bounds of the header"));
  EXPECT_TRUE(told(
      [](auto& c) {
        // Not convex: a corner pulled in.
        c.t0.vertices[2].position = {40, 40};
        c.t0.triangles = {{{0, 1, 2}, 0}, {{0, 2, 3}, 0}};
      },
      "convex"));
  EXPECT_TRUE(told(
      [](auto& c) {
        // Two squares that do not touch.
        const HeightBits h = c.t0.vertices[0].height;
        c.t0.vertices = {{{0, 0}, h, 1},     {{9, 0}, h, 1},    {{0, 9}, h, 1},
                         {{100, 100}, h, 1}, {{90, 100}, h, 1}, {{100, 90}, h, 1}};
        c.t0.triangles = {{{0, 1, 2}, 0}, {{3, 4, 5}, 0}};
      },
      "border"));
}

TEST_F(Verify, FindsAT0ThatIsWoundTwice) {
  StoreContent content = flat_square(1000);
  const HeightBits h = content.t0.vertices[0].height;
  // A star of five around a vertex: all turns to the left, twice around, and the areas of its five
  // triangles add up to what its border has inside.
  content.t0.vertices = {{{500, 1000}, h, 1}, {{206, 95}, h, 1}, {{976, 655}, h, 1},
                         {{24, 655}, h, 1},   {{794, 95}, h, 1}, {{500, 500}, h, 1}};
  content.facts.bounds = {24, 95, 976, 1000};
  content.t0.triangles.clear();
  for (std::uint32_t i = 0; i < 5; ++i) {
    content.t0.triangles.push_back({{5, i, (i + 1) % 5}, 0});
  }
  write(content);
  EXPECT_TRUE(tells(verify_store(path_), "border"));
}

TEST_F(Verify, StopsWhenAsked) {
  write(random_content({}));
  std::stop_source source;
  source.request_stop();
  try {
    static_cast<void>(verify_store(path_, {}, source.get_token()));
    FAIL();
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ErrorCode::cancelled);
  }
}

}  // namespace
}  // namespace ptin::test
