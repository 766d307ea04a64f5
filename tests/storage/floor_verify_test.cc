// SPDX-License-Identifier: GPL-3.0-or-later
//
// The heights of a raster held against themselves and the header: each fault is made in a sound file, with
// all checksums right, and is told of.
#include <bit>
#include <functional>
#include <limits>
#include <random>

#include <gtest/gtest.h>

#include "engine/error.h"
#include "engine/mesh/raster_cell.h"
#include "storage/file/read_only_file.h"
#include "storage/verify.h"
#include "storage/verify_floor.h"
#include "tests/storage/store_fixture.h"
#include "tests/support/stored_floor.h"

namespace ptin::test {
namespace {

using layout::SectionKind;

/// Samples of a raster, as tiles have them.
struct Samples {
  std::uint32_t width, height;
  std::vector<OrderedHeight> heights;
  std::vector<std::uint8_t> is_void;
  std::vector<std::size_t> lone;  ///< Void ones that have heights.
};

Samples made(std::uint32_t width, std::uint32_t height, std::uint32_t most) {
  std::mt19937 random(1);
  Samples s{width, height, {}, {}, {}};
  for (std::size_t i = 0; i < std::size_t{width} * height; ++i) {
    s.heights.push_back(static_cast<OrderedHeight>(0x80000000U + random() % most));
    s.is_void.push_back(random() % 20 == 0 ? 1 : 0);
    if (s.is_void.back() != 0 && random() % 3 == 0) s.lone.push_back(i);
  }
  return s;
}

FloorTile tile_of(const Samples& s, const FloorShape& shape, HilbertCell at) {
  FloorTile tile;
  tile.width = shape.samples_of(at.x, shape.width);
  tile.height = shape.samples_of(at.y, shape.height);
  for (std::uint32_t y = 0; y < tile.height; ++y) {
    for (std::uint32_t x = 0; x < tile.width; ++x) {
      const std::size_t i =
          std::size_t{shape.first_of(at.y) + y} * s.width + shape.first_of(at.x) + x;
      if (std::ranges::binary_search(s.lone, i)) {
        tile.lone.push_back({static_cast<std::uint16_t>(tile.heights.size()), s.heights[i]});
      }
      tile.heights.push_back(s.heights[i]);
      tile.is_void.push_back(s.is_void[i]);
    }
  }
  return tile;
}

StoredFloor floor_of(const Samples& s, std::uint32_t side_log2) {
  StoredFloor floor;
  floor.facts.shape = {side_log2, s.width, s.height};
  for (std::uint32_t row = 0; row < floor.facts.shape.rows(); ++row) {
    for (std::uint32_t column = 0; column < floor.facts.shape.columns(); ++column) {
      floor.tiles.emplace(FloorShape::key(column, row),
                          tile_of(s, floor.facts.shape, {column, row}));
    }
  }
  return floor;
}

/// A store over the samples' bounds, with what its header says of them.
StoreContent content_of(const Samples& s, HeightType type) {
  StoreContent c = flat_rectangle(static_cast<std::int32_t>(s.width) - 1,
                                  static_cast<std::int32_t>(s.height) - 1, type);
  c.facts.source_samples = 0;
  double low = std::numeric_limits<double>::max(), high = -low;
  for (std::size_t i = 0; i < s.heights.size(); ++i) {
    if (s.is_void[i] != 0 && !std::ranges::binary_search(s.lone, i)) continue;
    const double h = c.facts.heights.height(height_of_ordered(s.heights[i], type));
    low = std::min(low, h);
    high = std::max(high, h);
    ++c.facts.source_samples;
  }
  c.facts.min_height = low;
  c.facts.max_height = high;
  return c;
}

class FloorVerify : public ::testing::Test {
 protected:
  /// Writes a sound file.
  void write(const Samples& s, std::uint32_t side_log2, HeightType type = HeightType::int32) {
    const StoreContent content = content_of(s, type);
    floor_ = floor_of(s, side_log2);
    const auto writer = StoreWriter::create(path_, {.overwrite = true});
    writer->add_floor(floor_.facts, [&](FloorWriter& to) {
      for (const auto& [key, tile] : floor_.tiles) EXPECT_TRUE(to.add(key, tile));
      return true;
    });
    writer->publish(content.facts, content.t0, content.metadata);
    sound_ = read_file(path_);
  }

  /// The faults of a file, as if it had as many records as there are samples but for T0's.
  std::vector<std::string> faults_of(const Bytes& bytes, std::uint64_t more_records = 0) {
    write_file(path_, bytes);
    const ReadOnlyFile file(path_);
    StoreFront front = read_front(file);
    const FloorShape& shape = floor_.facts.shape;
    front.header.record_count = std::uint64_t{shape.width} * shape.height - 4 + more_records;
    std::vector<std::string> faults;
    verify_floor(
        file, front,
        [&](const std::string& what, const std::string& where) {
          faults.push_back(where + ": " + what);
        },
        [] {});
    return faults;
  }
  void expect_told(const std::string& what, const Bytes& bytes) {
    const std::vector<std::string> faults = faults_of(bytes);
    const bool is_told = std::ranges::any_of(
        faults, [&](const std::string& f) { return f.find(what) != std::string::npos; });
    EXPECT_TRUE(is_told) << what << "; told: " << (faults.empty() ? "nothing" : faults[0]);
  }
  void expect_told_of_sections(const std::string& what,
                               const std::function<void(FloorSections&)>& change) {
    FloorSections sections = floor_sections_of(sound_);
    change(sections);
    expect_told(what, with_floor(sound_, sections));
  }
  void expect_told_of_tiles(const std::string& what,
                            const std::function<void(StoredFloor&)>& change) {
    StoredFloor floor = floor_;
    change(floor);
    expect_told(what, with_floor(sound_, sections_of(floor)));
  }
  /// @param change  Of a root that is sealed then.
  void expect_root_refused(const std::string& what,
                           const std::function<void(layout::FloorNode&)>& change) {
    expect_told_of_sections(what, [&](FloorSections& s) { change(s.root); });
    EXPECT_THROW(static_cast<void>(StoreFile::open(path_)->floor()), Error) << what;
  }
  /// @param ask  Of the heights of a file, whose tiles are asked for.
  void expect_refused(const std::string& what, const FloorSections& sections,
                      const std::function<void(const Floor&)>& ask) {
    write_file(path_, with_floor(sound_, sections));
    try {
      ask(*StoreFile::open(path_)->floor());
      ADD_FAILURE() << what;
    } catch (const Error& e) {
      EXPECT_EQ(e.code(), ErrorCode::corruption);
      EXPECT_NE(e.message().find(what), std::string::npos) << e.message();
    }
  }
  static void visit_all(const Floor& floor) {
    Floor::Recent recent;
    IoCounters counters;
    floor.visit([](const Floor::Bounds&) { return true; },
                [](const Floor::TileAt&, const FloorTile&) { return true; }, recent, counters);
  }
  /// A page of these tiles and no others.
  static Bytes page_of(const std::map<std::uint64_t, FloorTile>& tiles) {
    Bytes page;
    FloorWriter writer([&](std::span<const std::byte> p) { page.assign(p.begin(), p.end()); });
    for (const auto& [key, tile] : tiles) EXPECT_TRUE(writer.add(key, tile));
    writer.finish();
    return page;
  }

  TestFolder folder_{TestFolder::Size::kSmall};
  std::string path_ = folder_.file("a.ptin");
  Bytes sound_;
  StoredFloor floor_;
};

TEST_F(FloorVerify, FindsNothingInSoundFiles) {
  const std::pair<std::uint32_t, std::uint32_t> sizes[] = {{1, 1}, {1, 90},  {90, 1},
                                                           {2, 2}, {17, 17}, {130, 100}};
  for (const auto& [width, height] : sizes) {
    for (const std::uint32_t side_log2 : {4U, 5U}) {
      for (const HeightType type : {HeightType::int32, HeightType::float32}) {
        write(made(width, height, 1000), side_log2, type);
        EXPECT_EQ(faults_of(sound_), std::vector<std::string>()) << width << " x " << height;
      }
    }
  }
  write(made(380, 380, UINT32_MAX / 4), 4);
  EXPECT_FALSE(floor_sections_of(sound_).nodes.empty());
  EXPECT_EQ(faults_of(sound_), std::vector<std::string>());
}

TEST_F(FloorVerify, IsPartOfVerifyingAFile) {
  Samples s = made(20, 12, 1000);
  s.is_void.assign(s.heights.size(), 0);
  s.lone.clear();
  StoreContent content = content_of(s, HeightType::int32);
  content.t0 = {};
  for (std::int32_t y = 0; y < 12; ++y) {
    for (std::int32_t x = 0; x < 20; ++x) {
      const std::size_t i = content.t0.vertices.size();
      content.t0.vertices.push_back(
          {{x, y}, height_of_ordered(s.heights[i], HeightType::int32), 1});
      if (x == 19 || y == 11) continue;
      const auto v = static_cast<std::uint32_t>(i);
      content.t0.triangles.push_back({{v, v + 1, v + 21}, 0});
      content.t0.triangles.push_back({{v, v + 21, v + 20}, 0});
    }
  }
  const StoredFloor floor = floor_of(s, 4);
  const auto writer = StoreWriter::create(path_, {});
  writer->add_floor(floor.facts, [&](FloorWriter& to) {
    for (const auto& [key, tile] : floor.tiles) EXPECT_TRUE(to.add(key, tile));
    return true;
  });
  writer->publish(content.facts, content.t0, content.metadata);
  const VerifyReport report = verify_store(path_);
  EXPECT_TRUE(report.is_sound()) << report.faults[0].what;
  Bytes damaged = read_file(path_);
  damaged[section_of(damaged, SectionKind::kFloorPages).offset + 30] ^= std::byte{1};
  write_file(path_, damaged);
  EXPECT_FALSE(verify_store(path_).is_sound());
}

TEST_F(FloorVerify, FindsEachDamagedNodeAndPage) {
  write(made(380, 380, UINT32_MAX / 4), 4);
  const auto root = section_of(sound_, SectionKind::kFloorRoot);
  const auto nodes = section_of(sound_, SectionKind::kFloorNodes);
  const auto pages = section_of(sound_, SectionKind::kFloorPages);
  const auto expect_damaged = [&](const std::string& what, std::uint64_t at) {
    Bytes bytes = sound_;
    bytes[at] ^= std::byte{1};
    expect_told(what, bytes);
  };
  expect_damaged("height root\": the root above the heights does not match", root.offset + 200);
  expect_damaged("height node 0 of level 1: the node does not match", nodes.offset + 200);
  expect_damaged("page of heights 7: the page does not match", pages.offset + 7 * 4096 + 200);
}

TEST_F(FloorVerify, ComparesEntriesWithWhatTheyDescribe) {
  write(made(380, 380, UINT32_MAX / 4), 4);
  const auto expect_entry_told = [&](std::size_t level, const std::string& what,
                                     const std::function<void(layout::FloorEntry&)>& change) {
    expect_told_of_sections(what, [&](FloorSections& s) { change(s.node(level, 0).entry[1]); });
  };
  for (const std::size_t level : {0U, 1U}) {
    expect_entry_told(level, "not the union", [](auto& e) { e.least -= 1; });
    expect_entry_told(level, "not the union", [](auto& e) { e.greatest += 1; });
    expect_entry_told(level, "not in order", [](auto& e) { e.first = 0; });
  }
  expect_entry_told(0, "not the union", [](auto& e) { e.first += 1; });
  expect_entry_told(1, "comes twice", [](auto& e) { e.first += 1; });
  expect_told_of_sections("another number of entries",
                          [](FloorSections& s) { s.node(1, 0).entries -= 1; });
  expect_told_of_sections("another number of entries",
                          [](FloorSections& s) { s.root.entries += 1; });
  const auto expect_zero = [&](const std::function<void(layout::FloorNode&)>& change) {
    expect_told_of_sections("are not zero",
                            [&](FloorSections& s) { change(s.node(1, s.tree().nodes(1) - 1)); });
  };
  expect_zero([](auto& n) { n.entry[167].checksum = 1; });
  expect_zero([](auto& n) { n.width = 1; });
  expect_zero([](auto& n) { n.coding = 1; });
  expect_zero([](auto& n) { n.reserved[19] = 1; });
  expect_told_of_sections("are not zero", [](FloorSections& s) { s.root.entry[167].first = 1; });
}

TEST_F(FloorVerify, RefusesRootsThatNoProgramWrites) {
  write(made(130, 100, 1000), 5);
  expect_root_refused("coded in a way", [](auto& r) { r.coding = 2; });
  expect_root_refused("tiles that no program makes", [](auto& r) { r.side_log2 = 3; });
  expect_root_refused("tiles that no program makes", [](auto& r) { r.side_log2 = 7; });
  expect_root_refused("of another raster", [](auto& r) { r.width += 1; });
  expect_root_refused("of another raster", [](auto& r) { r.height = 0; });
  expect_root_refused("of another raster", [](auto& r) { r.width = r.height = UINT32_MAX; });
  for (const double step : {-1.0, -0.0, 0.1, 1e30, double(INFINITY), double(NAN)}) {
    expect_root_refused("a step", [=](auto& r) { r.step = layout::to_bits(step); });
  }
  expect_root_refused("a type that", [](auto& r) { r.source_type = 9; });
  expect_root_refused("flags or bytes", [](auto& r) { r.flags = 4; });
  expect_root_refused("cannot be of its type", [](auto& r) { r.flags = 1; });
  expect_root_refused("lacks the first tile", [](auto& r) { r.entry[0].first = 1; });
  expect_root_refused("flags or bytes", [](auto& r) { r.nodata = 1; });
  expect_root_refused("flags or bytes", [](auto& r) {
    r.flags = 2;
    r.nodata = layout::to_bits(double(NAN)) + 1;
  });
  expect_root_refused("flags or bytes", [](auto& r) { r.reserved[0] = 1; });
  for (const std::uint64_t pages : {std::uint64_t{0}, std::uint64_t{21}, UINT64_MAX}) {
    expect_root_refused("more pages than tiles", [=](auto& r) { r.pages = pages; });
  }
  expect_root_refused("not the length", [](auto& r) { r.pages += 1; });
  expect_root_refused("another number of entries", [](auto& r) { r.entries += 1; });
  expect_told_of_sections("not as many as", [](FloorSections& s) { s.nodes.resize(1); });
  write(made(130, 100, 1000), 5, HeightType::float32);
  expect_root_refused("a step", [](auto& r) { r.step = layout::to_bits(1e30); });
  expect_root_refused("cannot be of its type", [](auto& r) {
    r.flags = 1;
    r.source_type = 4;
  });
}

TEST_F(FloorVerify, AReaderTakesNodesForThoseOfTheirParentsKeysAlone) {
  write(made(380, 380, UINT32_MAX / 4), 4);
  const std::string what = "not those of its parent's keys";
  FloorSections sections = floor_sections_of(sound_);
  sections.node(1, 1).entry[0].first -= 1;
  expect_refused(what, sections, visit_all);
  sections = floor_sections_of(sound_);
  layout::FloorNode& first = sections.node(1, 0);
  first.entry[first.entries - 1].first = sections.node(1, 1).entry[0].first;
  expect_refused(what, sections, visit_all);
}

TEST_F(FloorVerify, AReaderMissesTilesThatAreNotThere) {
  for (const auto& [width, height] : {std::pair{130U, 100U}, {20U, 300U}, {300U, 20U}}) {
    write(made(width, height, 1000), 4);
    const std::vector<std::uint64_t> keys = [&] {
      std::vector<std::uint64_t> all;
      for (const auto& [key, tile] : floor_.tiles) all.push_back(key);
      return all;
    }();
    for (const std::size_t i : {std::size_t{1}, keys.size() / 2, keys.size() - 1}) {
      StoredFloor floor = floor_;
      floor.tiles.erase(keys[i]);
      const FloorSections sections = sections_of(floor);
      expect_refused("lacks a tile of the raster", sections, visit_all);
      expect_refused("is on no page", sections, [&](const Floor& read) {
        Floor::Recent recent;
        IoCounters counters;
        FloorTile tile;
        const HilbertCell at = hilbert_cell(keys[i]);
        read.read(at.x, at.y, recent, tile, counters);
      });
    }
    write_file(path_, sound_);
    visit_all(*StoreFile::open(path_)->floor());
  }
}

TEST_F(FloorVerify, AReaderFindsTilesThatLieElsewhere) {
  write(made(130, 100, 1000), 5);
  FloorSections sections = floor_sections_of(sound_);
  sections.root.entry[1].first -= 1;
  expect_refused("tiles of the next one", sections, visit_all);
  StoredFloor floor = floor_;
  floor.tiles.emplace(FloorShape::key(6, 0), floor.tiles.begin()->second);
  expect_refused("beside the raster", sections_of(floor), visit_all);
}

TEST_F(FloorVerify, HoldsTheSourceAgainstTheHeights) {
  write(made(40, 40, 1000), 5);
  const auto with_source = [&](SourceNumber source, std::optional<double> nodata) {
    StoredFloor floor = floor_;
    floor.facts.is_exact = true;
    floor.facts.source = source;
    floor.facts.nodata = nodata;
    return with_floor(sound_, sections_of(floor));
  };
  const FloorTile& tile = floor_.tiles.begin()->second;
  const auto at = std::ranges::find(tile.is_void, 0) - tile.is_void.begin();
  const auto code =
      static_cast<std::int32_t>(tile.heights[static_cast<std::size_t>(at)] ^ 0x80000000U);
  ASSERT_FALSE(tile.lone.empty());
  const auto lone = static_cast<std::int32_t>(tile.lone[0].height ^ 0x80000000U);
  for (const SourceNumber source : {SourceNumber::kInt16, SourceNumber::kUInt16}) {
    EXPECT_EQ(faults_of(with_source(source, 5000.0)), std::vector<std::string>());
    expect_told("a height is the nodata value", with_source(source, code));
    expect_told("a height is the nodata value", with_source(source, lone));
    expect_told("without a nodata value has none", with_source(source, std::nullopt));
  }
  expect_told("no number of its type", with_source(SourceNumber::kUInt8, 5000.0));
  expect_told("no number of its type", with_source(SourceNumber::kUInt32, 5000.0));  // in quarters
  EXPECT_EQ(faults_of(with_source(SourceNumber::kFloat64, std::nullopt)),
            std::vector<std::string>());
  expect_told("a height is the nodata value", with_source(SourceNumber::kFloat64, 0.25 * code));
}

TEST_F(FloorVerify, FindsPagesThatNoWriterPacks) {
  write(made(130, 100, 1000), 5);
  ASSERT_GT(floor_sections_of(sound_).tree().pages(), 2U);
  const auto expect_page_told = [&](const std::string& what,
                                    const std::function<void(std::span<std::byte>)>& change) {
    expect_told_of_sections(what, [&](FloorSections& s) { change(s.page(1)); });
  };
  const auto set = [](std::span<std::byte> page, std::size_t at, auto value) {
    std::memcpy(page.data() + at, &value, sizeof value);
  };
  expect_page_told("more tiles than fit", [&](auto p) { set(p, 0, std::uint16_t{0}); });
  expect_page_told("more tiles than fit", [&](auto p) { set(p, 0, std::uint16_t{600}); });
  expect_page_told("more tiles than fit", [&](auto p) { set(p, 2, std::uint16_t{4097}); });
  expect_page_told("not end where", [&](auto p) { set(p, 2, std::uint16_t{4000}); });
  expect_page_told("more than 32 bits", [&](auto p) { set(p, 8, UINT32_MAX); });
  expect_page_told("not in order", [&](auto p) { set(p, 16, std::uint16_t{1}); });
  expect_page_told("not in order", [&](auto p) { set(p, 18, std::uint16_t{0}); });
  const std::string not_packed = "page of heights 1: the page does not hold its tiles as they are";
  expect_page_told(not_packed, [&](auto p) { set(p, 12, std::uint32_t{1}); });
  expect_page_told(not_packed, [&](auto p) { p[4095] = std::byte{1}; });
  expect_page_told(not_packed, [&](auto p) { p[20] ^= std::byte{1}; });
  expect_page_told(not_packed, [&](auto p) { p[22] ^= std::byte{1}; });
  expect_page_told(not_packed, [&](auto p) { set(p, 8, std::uint32_t{0x00FFFFFF}); });
  // A page with one tile less, which goes to a page of its own.
  expect_told_of_sections("page of heights 0: the page has room", [&](FloorSections& s) {
    auto end = floor_.tiles.begin();
    while (end->first < s.root.entry[1].first) ++end;
    const auto last = std::prev(end);
    const auto heights = bounds_of(last->second);
    const Bytes first = page_of({floor_.tiles.begin(), last}), second = page_of({last, end});
    std::ranges::copy(first, s.page(0).begin());
    s.pages.insert(s.pages.begin() + 4096, second.begin(), second.end());
    std::shift_right(s.root.entry.begin() + 1, s.root.entry.end(), 1);
    s.root.entry[1] = {last->first, heights.least, heights.greatest, 0};
    ++s.root.entries;
    ++s.root.pages;
  });
}

TEST_F(FloorVerify, FindsTilesThatNoWriterPacks) {
  // A single tile of two samples: 16 bytes, an entry, and the tile: the place of its bits is known.
  write({2, 1, {0x80000007U, 0x80000009U}, {0, 0}, {}}, 4);
  const auto expect_bits_told = [&](const std::string& what, const std::vector<int>& bytes) {
    expect_told_of_sections(what, [&](FloorSections& s) {
      auto page = s.page(0);
      std::fill(page.begin() + 24, page.end(), std::byte{0});
      std::ranges::transform(bytes, page.begin() + 24, [](int b) { return std::byte(b); });
      const auto end = static_cast<std::uint16_t>(24 + bytes.size());
      std::memcpy(page.data() + 2, &end, 2);
      std::memcpy(page.data() + 18, &end, 2);
    });
  };
  // No voids (2 bits), 80000007, width 3, residuals 0 and 4 (zigzag of 2): 46 bits.
  const std::vector<int> sound = {0x1C, 0, 0, 0, 0x0E, 0x20};
  {
    FloorSections s = floor_sections_of(sound_);
    ASSERT_TRUE(std::ranges::equal(s.page(0).subspan(24, 6), sound, {},
                                   [](std::byte b) { return static_cast<int>(b); }));
  }
  expect_bits_told("ends too early", {0x1C, 0, 0, 0});
  expect_bits_told("ends too early", {0x1C, 0, 0, 0, 0x0E});
  expect_bits_told("not its own", {0x1C, 0, 0, 0, 0x0E, 0x20, 0});
  expect_bits_told("not its own", {0x1C, 0, 0, 0, 0x0E, 0xA0});
  expect_bits_told("first height twice", {0x1C, 0, 0, 0, 0x0E, 0x21});
  expect_bits_told("as they are to be packed", {0x1C, 0, 0, 0, 0x12, 0x40});  // width 4
  expect_bits_told("more than 32 bits",
                   {0x1C, 0, 0, 0, 0xFE, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0});
  // Runs: of none, where there are no voids; then one beyond the tile.
  expect_bits_told("as they are to be packed", {0x03, 0x80, 0x03, 0, 0, 0xC0, 0x01, 0x04, 0});
  expect_bits_told("leaves its tile", {0x07, 0x80, 0x01, 0});
  // All void, and one lone sample: at place 0, then twice, then beside the tile.
  expect_bits_told("not in order", {0x05, 0, 2 << 4 | 0, 0, 0, 0, 0, 0, 0});
}

TEST_F(FloorVerify, FindsTilesThatAreNotThere) {
  write(made(130, 100, 1000), 5);
  expect_told_of_tiles("1 tiles of heights are missing",
                       [](StoredFloor& f) { f.tiles.erase(std::next(f.tiles.begin(), 5)); });
  expect_told_of_tiles("lies beside the raster", [](StoredFloor& f) {
    f.tiles.emplace(FloorShape::key(6, 0), f.tiles.begin()->second);
  });
  // The last page's tiles begin where those of the one before do.
  expect_told_of_sections("comes twice", [](FloorSections& s) {
    const std::uint64_t last = s.tree().pages() - 1;
    s.root.entry[last].first = s.root.entry[last - 1].first + 1;
  });
}

TEST_F(FloorVerify, FindsHeightsThatAreNotThoseOfTheHeader) {
  Samples s = made(40, 40, 1000);
  write(s, 5);
  const auto expect_header_told = [&](const std::string& what,
                                      const std::function<void(layout::FileHeader&)>& change) {
    Bytes bytes = sound_;
    layout::FileHeader header = header_of(bytes);
    change(header);
    set_header(bytes, header);
    seal(bytes);
    expect_told(what, bytes);
  };
  expect_header_told("least and largest", [](auto& h) { h.min_height = layout::to_bits(0.0); });
  expect_header_told("least and largest", [](auto& h) { h.max_height = layout::to_bits(1e4); });
  expect_header_told("samples, and", [](auto& h) { ++h.source_samples; });
  EXPECT_EQ(faults_of(sound_, 1).size(), 1U) << "as many vertices as samples";
  const auto expect_number_told = [&](OrderedHeight number) {
    expect_told_of_tiles("no program writes", [=](StoredFloor& f) {
      FloorTile& tile = f.tiles.begin()->second;
      tile.is_void[3] = 0;
      std::erase_if(tile.lone, [](const FloorTile::Lone& l) { return l.place == 3; });
      tile.heights[3] = number;
    });
  };
  write(s, 5, HeightType::float32);
  expect_number_told(0x7FFFFFFF);  // -0
  expect_number_told(0xFF800000);  // infinity
  expect_number_told(0);           // NaN
  expect_told_of_tiles("no program writes", [](StoredFloor& f) {
    FloorTile& tile = f.tiles.begin()->second;
    ASSERT_FALSE(tile.lone.empty());
    tile.lone[0].height = 0x7FFFFFFF;
  });
}

TEST_F(FloorVerify, OfNumbersWithOneHeightOneIsWritten) {
  const FloorNumbers numbers(HeightEncoding(), 0.01);
  const OrderedHeight k = 0x80000000U + 2000000000U;
  EXPECT_TRUE(numbers.is_written(numbers.ordered(numbers.bits(k))));
  EXPECT_EQ(numbers.bits(k), numbers.bits(k + 1)) << "floats are farther apart there";
  EXPECT_NE(numbers.is_written(k), numbers.is_written(k + 1) && numbers.is_written(k));
  EXPECT_TRUE(numbers.is_written(0x80000000U + 12345));
}

TEST_F(FloorVerify, AReaderHandsOutNoHeightThatIsNoNumber) {
  write(made(40, 40, 1000), 5, HeightType::float32);
  for (const bool is_lone : {false, true}) {
    StoredFloor floor = floor_;
    FloorTile& tile = floor.tiles.begin()->second;
    if (is_lone) {
      tile.lone.at(0).height = 0;
    } else {
      tile.heights[static_cast<std::size_t>(std::ranges::find(tile.is_void, 0) -
                                            tile.is_void.begin())] = UINT32_MAX;
    }
    write_file(path_, with_floor(sound_, sections_of(floor)));
    const auto store = StoreFile::open(path_);
    Floor::Recent recent;
    IoCounters counters;
    EXPECT_THROW(store->floor()->read(0, 0, recent, tile, counters), Error);
  }
}

TEST_F(FloorVerify, SectionsAreRefusedAtTheOpening) {
  write(made(130, 100, 1000), 5);
  const auto expect_refused = [&](const std::string& what,
                                  const std::function<void(Bytes&)>& change) {
    Bytes bytes = sound_;
    change(bytes);
    seal(bytes);
    write_file(path_, bytes);
    try {
      static_cast<void>(StoreFile::open(path_));
      ADD_FAILURE() << what;
    } catch (const Error& e) {
      EXPECT_EQ(e.code(), ErrorCode::corruption);
      EXPECT_NE(e.message().find(what), std::string::npos) << e.message();
    }
  };
  const auto with_section = [](SectionKind kind,
                               const std::function<void(layout::SectionEntry&)>& change) {
    return [=](Bytes& bytes) {
      auto sections = sections_of(bytes);
      for (layout::SectionEntry& s : sections) {
        if (s.kind == static_cast<std::uint32_t>(kind)) change(s);
      }
      set_sections(bytes, sections);
    };
  };
  for (const SectionKind kind :
       {SectionKind::kFloorRoot, SectionKind::kFloorNodes, SectionKind::kFloorPages}) {
    expect_refused("one section is missing", with_section(kind, [](auto& s) { s.kind = 99; }));
  }
  expect_refused("samples out", [](Bytes& bytes) {
    layout::FileHeader header = header_of(bytes);
    header.base_error = layout::to_bits(0.5);
    set_header(bytes, header);
  });
  expect_refused("number of nodes",
                 with_section(SectionKind::kFloorRoot, [](auto& s) { s.bytes -= 8; }));
  expect_refused("number of pages", [](Bytes& bytes) {
    bytes.resize(bytes.size() - 8);
    auto sections = sections_of(bytes);
    sections.back().bytes -= 8;
    set_sections(bytes, sections);
    layout::FileHeader header = header_of(bytes);
    header.file_bytes = bytes.size();
    set_header(bytes, header);
  });
  expect_refused("multiple of 4096", [](Bytes& bytes) {
    auto sections = sections_of(bytes);
    bytes.insert(bytes.begin() + static_cast<std::ptrdiff_t>(sections.back().offset), 8,
                 std::byte{0});
    sections.back().offset += 8;
    set_sections(bytes, sections);
    layout::FileHeader header = header_of(bytes);
    header.file_bytes = bytes.size();
    set_header(bytes, header);
  });
}

}  // namespace
}  // namespace ptin::test
