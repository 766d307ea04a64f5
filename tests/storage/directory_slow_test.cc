// SPDX-License-Identifier: GPL-3.0-or-later
//
// The directory of a store of 10^9 vertices, over pages that are made up: 4.4 million with as many
// stars over one another as those of northengland have.
#include <algorithm>
#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "storage/directory_writer.h"
#include "storage/file/checksum.h"
#include "storage/file/ranged_file.h"
#include "storage/index_writer.h"
#include "storage/point_directory.h"
#include "tests/storage/noting_source.h"
#include "tests/storage/store_fixture.h"

namespace ptin::test {
namespace {

constexpr std::uint64_t kPages = 4'400'000;
constexpr std::int32_t kSide = 31623;

/// Pages of levels of detail, half as many of each as of the one below. A level's pages are squares
/// that cover the domain, with boxes of stars of twice their area: so two hold a place, of 22 levels
/// 44. In northengland, of 15 levels, 29 do, and of a quarter and a sixteenth of it 25 and 20. Pages
/// of the lowest five levels have triangles that live on: ten hold a place, as of all sizes of
/// northengland.
void made_pages(const PageVisitor& visit) {
  layout::NodeEntry d{};
  std::uint64_t page = 0;
  for (std::uint32_t level = 0; page < kPages; ++level) {
    const auto side =
        static_cast<std::uint64_t>(std::sqrt(static_cast<double>(kPages >> (level + 1)))) + 1;
    const double width = static_cast<double>(kSide) / static_cast<double>(side);
    const auto from = [&](std::uint64_t i, double share) {
      const double v = (static_cast<double>(i) + share) * width;
      return static_cast<std::int32_t>(std::clamp(v, 0.0, static_cast<double>(kSide)));
    };
    constexpr double kReach = 0.207;  // on each side: 1.414 times as wide
    d.error_max = static_cast<std::uint16_t>(16000 + 64 * level);
    d.death_min = static_cast<std::uint16_t>(level < 5 ? 0 : d.error_max - 300);
    for (std::uint64_t y = 0; y < side; ++y) {
      d.star_min_y = from(y, -kReach);
      d.star_max_y = from(y, 1 + kReach);
      for (std::uint64_t x = 0; x < side && page < kPages; ++x) {
        d.star_min_x = from(x, -kReach);
        d.star_max_x = from(x, 1 + kReach);
        d.checksum = page;
        visit(page++, d);
      }
    }
  }
}

/// The segments of a file of which each task of the build made 300 pages.
std::vector<std::uint64_t> segments_of_tasks(const TestFolder& folder) {
  constexpr std::uint64_t kTaskPages = 300;
  IndexWriter index(FileLayer::system(), folder.path().string(), "i", HeightEncoding{});
  for (std::uint64_t page = 0; page < kPages; ++page) {
    if (page % kTaskPages == 0) index.end_segment();
    index.add({});
  }
  index.finish();
  return index.segments();
}

TEST(DirectorySlow, NamesThePagesOfAPointByOneShortNodeOfAStoreOf1E9Vertices) {
  constexpr std::uint32_t kPageBytes = 4096;
  const GridBox bounds{0, 0, kSide, kSide};
  const TestFolder folder;
  auto directory = DirectoryWriter::plan(bounds, kPages, kPageBytes, {}, made_pages);
  ASSERT_TRUE(directory.has_value());
  const std::vector<std::uint64_t> segments = segments_of_tasks(folder);
  // With 8 KiB of metadata, T0 and error table they come with the opening.
  EXPECT_LE(directory->root_bytes() + segments.size() * sizeof(layout::SegmentEntry),
            std::uint64_t{56} << 10);
  EXPECT_LE(directory->node_bytes() * 200, kPages * kPageBytes) << "half a percent of the pages";
  const IndexShape shape(segments);
  ASSERT_EQ(shape.pages(), kPages);
  const PageNames names(shape, true);
  ASSERT_TRUE(names.are_known());
  std::vector<std::byte> root;
  const std::uint64_t nodes_at = std::uint64_t{60} << 10;
  {
    ScratchFile out(FileLayer::system(), folder.file("d"), ScratchFile::Kept::kNew);
    directory->write_nodes(
        [&](const PageVisitor& visit) {
          made_pages(
              [&](std::uint64_t page, const layout::NodeEntry& d) { visit(names.of(page), d); });
        },
        out, nodes_at);
    root = directory->root();
    out.write_at(root, 0);
  }
  const DirectoryPlace place{
      {0, root.size()}, {nodes_at, directory->node_bytes()}, checksum_of(root)};
  const auto source =
      std::make_shared<NotingSource>(read_file(folder.file("d")), std::size_t{64} << 10);
  std::mt19937_64 random(1);
  std::uint64_t most = 0, bytes = 0, pages = 0;
  constexpr int kPoints = 300;
  const RangedFile file(source, {});
  for (int i = 0; i < kPoints; ++i) {
    const PointDirectory read(file, place, bounds, names);
    const auto x = static_cast<std::int32_t>(random() % kSide);
    const auto y = static_cast<std::int32_t>(random() % kSide);
    const GridBox at{x, y, x + 1, y + 1};
    std::vector<std::vector<DirectoryPage>> found(1);
    IoCounters counters;
    source->rounds.clear();
    read.find({&at, 1}, {}, found, counters);
    ASSERT_LE(source->rounds.size(), 1U);  // none: the node was read for a point before
    if (!source->rounds.empty()) {
      ASSERT_EQ(source->rounds[0].size(), 1U);
    }
    // Blocks of 4 KiB, had they not been read before.
    most = std::max<std::uint64_t>(most, (counters.bytes_read + 4095) / 4096 * 4096 + 4096);
    bytes += counters.bytes_read;
    pages += found[0].size();
    ASSERT_GE(found[0].size(), 5U) << "one of each level at least";
  }
  // Front, node, and eight pages: 64 + 28 + 32 KiB in ten requests and three rounds.
  EXPECT_LE(most, std::uint64_t{28} << 10);
  EXPECT_LE(bytes / kPoints, std::uint64_t{16} << 10);
  EXPECT_LE(static_cast<double>(pages) / kPoints, 12.0) << "ten, and what rounding adds";
}

}  // namespace
}  // namespace ptin::test
