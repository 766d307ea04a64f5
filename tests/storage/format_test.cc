// SPDX-License-Identifier: GPL-3.0-or-later
//
// The bytes of the format are fixed: the golden files are written as they were, are read as they were,
// as those of format 2 are, and one is the worked example of FORMAT.md.
#include <algorithm>
#include <filesystem>
#include <fstream>
#include <sstream>

#include <gtest/gtest.h>

#include "storage/error_table.h"
#include "storage/floor.h"
#include "storage/store_file.h"
#include "storage/verify.h"
#include "tests/storage/small_raster.h"
#include "tests/storage/two_records.h"

namespace ptin::test {
namespace {

namespace fs = std::filesystem;

// This file's folder, from where the golden file and FORMAT.md are found.
fs::path here() { return fs::path(__FILE__).parent_path(); }
std::string golden() { return (here() / "golden" / "two_records_v3.0.ptin").string(); }

// The same with a directory of one cell.
std::string golden_with_directory() {
  return (here() / "golden" / "with_directory_v3.0.ptin").string();
}
const StoreWriterOptions kWithDirectory{.overwrite = true, .directory = {.least_pages = 1}};

// A raster of four samples, with its heights.
std::string golden_with_floor() { return (here() / "golden" / "small_raster_v3.0.ptin").string(); }

// Bytes as FORMAT.md has them.
std::string hex_of(std::span<const std::byte> bytes) {
  std::string hex;
  for (const std::byte byte : bytes) {
    constexpr const char* kDigits = "0123456789abcdef";
    const auto b = static_cast<unsigned>(byte);
    hex += {kDigits[b / 16], kDigits[b % 16], ' '};
  }
  hex.pop_back();
  return hex;
}

void expect_in_document(const std::string& hex) {
  std::ifstream document(here() / ".." / ".." / "storage" / "FORMAT.md");
  std::stringstream all;
  all << document.rdbuf();
  EXPECT_NE(all.str().find("`" + hex + "`"), std::string::npos) << hex;
}

TEST(Format, WritesTheGoldenFilesByteForByte) {
  const TestFolder folder;
  write_store(folder.file("a.ptin"), two_records());
  EXPECT_EQ(read_file(folder.file("a.ptin")), read_file(golden()));
  write_store(folder.file("a.ptin"), two_records(), kWithDirectory);
  EXPECT_EQ(read_file(folder.file("a.ptin")), read_file(golden_with_directory()));
  write_small_raster(folder.file("a.ptin"));
  EXPECT_EQ(read_file(folder.file("a.ptin")), read_file(golden_with_floor()));
}

TEST(Format, ReadsTheGoldenFileWithADirectory) {
  ASSERT_TRUE(verify_store(golden_with_directory()).is_sound());
  const auto store = StoreFile::open(golden_with_directory());
  EXPECT_TRUE(are_same(read_all_starred(*store), two_records().segments[0]));
  std::vector<std::string> names;
  for (const SectionInfo& s : store->sections()) {
    names.push_back(s.name);
  }
  EXPECT_EQ(names, (std::vector<std::string>{"header", "section table", "segments", "metadata",
                                             "t0 vertices", "t0 triangles", "error table",
                                             "directory", "index", "directory nodes", "pages"}));
  // What FORMAT.md says of both sections.
  const Bytes file = read_file(golden_with_directory());
  const auto root = section_of(file, layout::SectionKind::kDirectory);
  const auto nodes = section_of(file, layout::SectionKind::kDirectoryNodes);
  for (const auto& section : {root, nodes}) {
    expect_in_document(hex_of(std::span(file).subspan(section.offset, section.bytes)));
  }
}

TEST(Format, ReadsTheGoldenFileWithHeights) {
  const VerifyReport report = verify_store(golden_with_floor());
  ASSERT_TRUE(report.is_sound()) << report.faults[0].what;
  const auto store = StoreFile::open(golden_with_floor());
  const Floor& floor = *store->floor();
  EXPECT_EQ(floor.facts().shape.width, 2U);
  EXPECT_EQ(floor.facts().shape.height, 2U);
  EXPECT_EQ(floor.facts().source, SourceNumber::kInt16);
  EXPECT_EQ(floor.facts().nodata, -9999.0);
  EXPECT_TRUE(floor.facts().is_exact);
  Floor::Recent recent;
  FloorTile tile;
  IoCounters counters;
  floor.read(0, 0, recent, tile, counters);
  EXPECT_EQ(tile.is_void, (std::vector<std::uint8_t>{0, 0, 0, 1}));
  EXPECT_EQ(floor.numbers().bits(tile.heights[2]), 6U);
  const Bytes file = read_file(golden_with_floor());
  // A reader that does not know the sections verifies each as a whole.
  for (const layout::SectionKind kind :
       {layout::SectionKind::kFloorRoot, layout::SectionKind::kFloorNodes,
        layout::SectionKind::kFloorPages}) {
    const auto section = section_of(file, kind);
    EXPECT_EQ(section.checksum,
              checksum_of(std::span(file).subspan(section.offset, section.bytes)));
  }
  const auto pages = section_of(file, layout::SectionKind::kFloorPages);
  expect_in_document(hex_of(std::span(file).subspan(pages.offset, 34)));
}

// Nothing writes format 2 any more; what was written stays readable, and sound.
TEST(Format, ReadsTheGoldenFilesOfFormat2) {
  for (const char* const name : {"two_records_v2.0.ptin", "two_records_v2.1.ptin"}) {
    const std::string path = (here() / "golden" / name).string();
    EXPECT_TRUE(verify_store(path).is_sound()) << name;
    const auto store = StoreFile::open(path);
    EXPECT_EQ(store->facts(), two_records().facts);
    EXPECT_TRUE(are_same(read_all_starred(*store), two_records().segments[0])) << name;
    EXPECT_EQ(store->sections().size(), std::string(name) == "two_records_v2.1.ptin" ? 10U : 8U);
  }
  const std::string raster = (here() / "golden" / "small_raster_v2.2.ptin").string();
  EXPECT_TRUE(verify_store(raster).is_sound());
  EXPECT_EQ(StoreFile::open(raster)->floor()->facts().source, SourceNumber::kInt16);
}

TEST(Format, ReadsTheGoldenFile) {
  ASSERT_TRUE(verify_store(golden()).is_sound());
  const StoreContent content = two_records();
  for (const PageAccess access : {PageAccess::kMapped, PageAccess::kPread}) {
    const auto store = StoreFile::open(golden(), access);
    EXPECT_EQ(store->facts(), content.facts);
    EXPECT_TRUE(are_same(read_all_starred(*store), content.segments[0]));
    EXPECT_EQ(store->max_rank(), 1);
    EXPECT_EQ(store->metadata_json(), "{}");
    ASSERT_EQ(store->t0().vertices.size(), 4U);
    EXPECT_EQ(store->t0().vertices[2].position, (GridPoint{8, 8}));
    ASSERT_EQ(store->t0().triangles.size(), 2U);
    EXPECT_EQ(store->t0().triangles[1].death, 4.0F);
    ASSERT_EQ(store->error_bins().size(), 3U);
    EXPECT_EQ(store->error_bins()[1].upper, 1.25F);
    EXPECT_EQ(store->error_bins()[2].max_deviation, 4.0F);
    std::vector<std::string> names;
    for (const SectionInfo& s : store->sections()) {
      names.push_back(s.name);
    }
    EXPECT_EQ(names, (std::vector<std::string>{"header", "section table", "segments", "metadata",
                                               "t0 vertices", "t0 triangles", "error table",
                                               "index", "pages"}));
  }
}

// Lines "00000100  01 00 ...": sixteen bytes at most. Lines of zeros are left out.
TEST(Format, TheWorkedExampleOfTheDocumentIsTheGoldenFile) {
  const Bytes file = read_file(golden());
  std::ifstream document(here() / ".." / ".." / "storage" / "FORMAT.md");
  ASSERT_TRUE(document);
  Bytes described(file.size());
  std::size_t lines = 0;
  for (std::string line; std::getline(document, line);) {
    const bool is_dump = line.size() > 11 && line.find_first_not_of("0123456789abcdef") == 8 &&
                         line.compare(8, 2, "  ") == 0;
    if (!is_dump) {
      continue;
    }
    ++lines;
    std::size_t at = std::stoul(line.substr(0, 8), nullptr, 16);
    std::istringstream bytes(line.substr(10, 48));
    for (unsigned value = 0; bytes >> std::hex >> value; ++at) {
      ASSERT_LT(at, described.size());
      described[at] = static_cast<std::byte>(value);
    }
  }
  EXPECT_GT(lines, 30U);
  const auto differ = std::mismatch(file.begin(), file.end(), described.begin());
  EXPECT_TRUE(differ.first == file.end()) << "at byte " << differ.first - file.begin();
}

TEST(ErrorTable, HasEightBinsAnOctave) {
  EXPECT_EQ(error_bin_upper(0.0F), 0.0F);
  EXPECT_EQ(error_bin_upper(1.0F), 1.0F);
  EXPECT_EQ(error_bin_upper(1.0001F), 1.125F);
  EXPECT_EQ(error_bin_upper(1.125F), 1.125F);
  EXPECT_EQ(error_bin_upper(1.9F), 2.0F);
  EXPECT_EQ(error_bin_upper(std::numeric_limits<float>::infinity()),
            std::numeric_limits<float>::infinity());
  EXPECT_GT(error_bin_upper(std::numeric_limits<float>::denorm_min()), 0.0F);
}

// Run with --gtest_also_run_disabled_tests after a change of the format on purpose: the golden
// file, and the seeds of the fuzz targets (tests/fuzz).
TEST(Format, DISABLED_WritesTheGoldenFileAndTheFuzzSeedsAgain) {
  fs::create_directories(fs::path(golden()).parent_path());
  write_store(golden(), two_records(), {.overwrite = true});
  write_store(golden_with_directory(), two_records(), kWithDirectory);
  write_small_raster(golden_with_floor());

  const fs::path corpus = here() / ".." / "fuzz" / "corpus";
  const auto seed = [&](const char* target, const char* name, Bytes head, const Bytes& bytes) {
    fs::create_directories(corpus / target);
    head.insert(head.end(), bytes.begin(), bytes.end());
    write_file((corpus / target / name).string(), head);
  };
  const Bytes file = read_file(golden());
  seed("store_open", "two_records", {std::byte{0}}, file);
  seed("store_open", "two_records_sealed", {std::byte{1}}, file);

  seed("store_open", "directory_sealed", {std::byte{1}}, read_file(golden_with_directory()));

  const Bytes raster = read_file(golden_with_floor());
  seed("store_open", "heights_sealed", {std::byte{1}}, raster);
  const auto heights_of = [](const Bytes& bytes) {
    const auto at = [&](layout::SectionKind kind) {
      return bytes.begin() + static_cast<std::ptrdiff_t>(section_of(bytes, kind).offset);
    };
    const auto root = at(layout::SectionKind::kFloorRoot);
    Bytes heights(root, root + layout::kNodeBytes);
    heights.insert(heights.end(), at(layout::SectionKind::kFloorNodes), bytes.end());
    return heights;
  };
  seed("floor", "small_raster", {std::byte{1}, std::byte{0}, std::byte{0}}, heights_of(raster));

  const TestFolder folder;
  for (const bool is_float : {false, true}) {
    write_rough_raster(folder.file("rough"), is_float);
    const Bytes rough = read_file(folder.file("rough"));
    const auto pages = section_of(rough, layout::SectionKind::kFloorPages);
    seed("floor", is_float ? "rough_float32" : "rough_int32",
         {is_float ? std::byte{0} : std::byte{1},
          static_cast<std::byte>(pages.bytes / layout::kFloorPageBytes - 1), std::byte{0}},
         heights_of(rough));
  }
  StoreContent none = two_records();
  none.segments.clear();
  write_store(folder.file("none"), none);
  seed("store_open", "no_records", {std::byte{1}}, read_file(folder.file("none")));
  seed("record_page", "two_records_int32", {std::byte{0}},
       Bytes(file.end() - 4096, file.end() - 4096 + 256));

  // A tree of two levels.
  const StoreContent many = random_content({.seed = 4, .segments = 1, .records = 5000});
  write_store(folder.file("many"), many);
  const auto store = StoreFile::open(folder.file("many"));
  const Bytes large = read_file(folder.file("many"));
  const auto index = section_of(large, layout::SectionKind::kIndex);
  const auto at = [&](std::uint64_t offset, std::uint64_t bytes) {
    return Bytes(large.begin() + static_cast<std::ptrdiff_t>(offset),
                 large.begin() + static_cast<std::ptrdiff_t>(offset + bytes));
  };
  const std::uint64_t pages = store->pages().page_count();
  seed("packed_rtree", "two_levels",
       {static_cast<std::byte>((pages - 1) & 0xFFU), static_cast<std::byte>((pages - 1) >> 8)},
       at(index.offset, std::min<std::uint64_t>(index.bytes, 12288)));
  seed("packed_rtree", "one_leaf", {std::byte{55}, std::byte{0}}, at(index.offset + 4096, 4096));
  std::vector<std::byte> page(4096);
  IoCounters counters;
  store->pages().read(PageId{7}, page, counters);
  seed("record_page", "float32", {std::byte{1}}, page);
}

}  // namespace
}  // namespace ptin::test
