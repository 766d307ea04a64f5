// SPDX-License-Identifier: GPL-3.0-or-later
//
// The directory: cells, bytes that are rounded outwards, what is read against a look at all pages.
#include <algorithm>
#include <map>
#include <random>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "engine/error.h"
#include "storage/directory_cells.h"
#include "storage/directory_writer.h"
#include "storage/packed_rtree.h"
#include "storage/point_directory.h"
#include "storage/record_page.h"
#include "storage/sample_heights.h"
#include "storage/verify.h"
#include "tests/storage/noting_source.h"
#include "tests/storage/store_fixture.h"
#include "tests/support/share_of_cases.h"

namespace ptin::test {
namespace {

GridBox any_box(std::mt19937_64& random, std::int32_t side) {
  const auto at = [&] { return static_cast<std::int32_t>(random() % (side + 1U)); };
  GridBox box{at(), at(), at(), at()};
  if (box.min_x > box.max_x) std::swap(box.min_x, box.max_x);
  if (box.min_y > box.max_y) std::swap(box.min_y, box.max_y);
  return box;
}

RC_GTEST_PROP(DirectoryCells, CoverEachPlaceOnce, (std::uint64_t seed)) {
  std::mt19937_64 random(seed);
  const std::int32_t side = 1 << random() % 31;
  const GridBox bounds = any_box(random, side);
  std::vector<GridPoint> points;
  for (std::uint64_t i = random() % 300; i > 0; --i) {
    const GridBox b = any_box(random, side);
    points.push_back({std::clamp(b.min_x, bounds.min_x, bounds.max_x),
                      std::clamp(b.min_y, bounds.min_y, bounds.max_y)});
  }
  const auto count = static_cast<std::uint32_t>(1 + random() % 70);
  const DirectoryCells cells = make_cells(bounds, count, points);
  RC_ASSERT(cells.count() == count);
  RC_ASSERT(cells.is_sound());
  for (int i = 0; i < 50; ++i) {
    const GridBox a = any_box(random, side);
    const GridPoint p{std::clamp(a.min_x, bounds.min_x, bounds.max_x),
                      std::clamp(a.min_y, bounds.min_y, bounds.max_y)};
    const DirectoryCells::Cell cell = cells.cell_of(p);
    RC_ASSERT(contains(cell.box, p));
    // Every box that holds the place, and no other cell with the place alone.
    std::vector<std::uint32_t> met, alone;
    const GridBox box = united(any_box(random, side), p);
    cells.for_each(box, [&](const DirectoryCells::Cell& c) { met.push_back(c.number); });
    cells.for_each(box_of(p), [&](const DirectoryCells::Cell& c) { alone.push_back(c.number); });
    RC_ASSERT(std::is_sorted(met.begin(), met.end()));
    RC_ASSERT(std::binary_search(met.begin(), met.end(), cell.number));
    RC_ASSERT(alone == std::vector<std::uint32_t>{cell.number});
    const GridBox rounded = box_of_bytes(box_in_cell(box, cell.box), cell.box);
    RC_ASSERT(contains(rounded, p));
    RC_ASSERT(contains(cell.box, rounded));
    RC_ASSERT(contains(
        rounded,
        GridBox{std::max(box.min_x, cell.box.min_x), std::max(box.min_y, cell.box.min_y),
                std::min(box.max_x, cell.box.max_x), std::min(box.max_y, cell.box.max_y)}));
  }
}

TEST(DirectoryScale, RoundsErrorsUpAndDeathsDown) {
  const std::vector<std::pair<ShortBits, ShortBits>> ranges{
      {1, kShortInfinity - 1}, {16043, 17522}, {16000, 16000},
      {16000, 16253},          {16000, 16254}, {kShortInfinity, kShortInfinity}};
  for (const auto& [least, most] : ranges) {
    const DirectoryScale scale = DirectoryScale::of(least, most);
    EXPECT_TRUE(scale.is_sound());
    for (std::uint32_t bits = 0; bits <= kShortInfinity; ++bits) {
      const auto error = static_cast<ShortBits>(bits);
      const std::uint8_t byte = scale.byte_of_error(error);
      ASSERT_GE(scale.error_of(byte), error);
      ASSERT_TRUE(byte == 0 || scale.error_of(byte - 1U) < error) << "the least such byte";
      if (error >= least && error <= most) {
        ASSERT_LT(scale.error_of(byte) - error, 1 << scale.step_shift);
      }
    }
    for (std::uint32_t bits = 0; bits <= kMostDeathBits; ++bits) {
      const auto death = static_cast<ShortBits>(bits);
      const std::uint8_t byte = scale.byte_of_death(death);
      ASSERT_LE(scale.death_of(byte), death);
      ASSERT_EQ(byte == 0, death == 0);
      ASSERT_TRUE(byte == 255 || scale.death_of(byte + 1U) > death || death == 0 ||
                  scale.death_of(byte + 1U) == kMostDeathBits)
          << "the largest such byte";
    }
  }
}

DirectoryOptions small_cells(std::uint64_t pages_of_cell) {
  return {.least_pages = 1, .pages_of_cell = pages_of_cell, .page_bytes_of_byte = 1};
}

/// A store with a directory of several cells, at hand and elsewhere.
struct TwoStores {
  TestFolder folder;
  Bytes bytes;
  std::shared_ptr<const StoreFile> near, far;
  explicit TwoStores(HeightType type, std::uint64_t seed = 1) {
    RandomRecords options;
    options.seed = seed;
    options.segments = 4;
    options.records = 2000;
    options.type = type;
    write_store(folder.file("a"), random_content(options), {.directory = small_cells(7)});
    bytes = read_file(folder.file("a"));
    near = StoreFile::open(folder.file("a"));
    far = StoreFile::open(std::make_shared<NotingSource>(bytes, 65536));
  }
};

TEST(PointDirectory, NamesEachPageWithLivingStarsAtAPlace) {
  for (const HeightType type : {HeightType::float32, HeightType::int32}) {
    const TwoStores stores(type);
    ASSERT_NE(stores.far->directory(), nullptr);
    const GridBox& bounds = stores.near->facts().bounds;
    std::mt19937_64 random(1);
    std::vector<GridBox> places;
    for (int i = 0; i < 60; ++i) {
      const auto x = static_cast<std::int32_t>(random() % bounds.max_x);
      const auto y = static_cast<std::int32_t>(random() % bounds.max_y);
      const std::int32_t on_line = i % 3 == 0 ? 0 : 1;
      places.push_back({x, y, x + on_line, y + (i % 5 == 0 ? 0 : 1)});
    }
    std::map<decltype(DirectoryPage::id), StarredRecords> pages;  // as the near store reads them
    for (const double level : some_of({-1.0, 0.0, 0.5, 10.0, 1e30})) {
      for (const bool with_ties : {false, true}) {
        StarFilter filter;
        filter.level = level;
        filter.with_ties = with_ties;
        std::vector<std::vector<DirectoryPage>> found(places.size());
        IoCounters counters;
        SampleHeights samples;
        stores.far->directory()->find(places, filter, found, counters);
        for (std::size_t i = 0; i < places.size(); ++i) {
          std::vector<StarPage> expected;
          filter.box = places[i];
          stores.near->star_index().search_stars(filter, expected, counters);
          for (const StarPage& page : expected) {
            // The index takes pages that meet the place's box; here they hold it.
            const GridBox& stars = stores.near->page_info(page.id).stars.box;
            EXPECT_EQ(std::any_of(found[i].begin(), found[i].end(),
                                  [&](const DirectoryPage& p) { return p.id == page.id; }) ||
                          !contains(stars, places[i]),
                      true);
          }
          for (std::size_t k = 0; k < found[i].size(); ++k) {
            const auto [whole, is_new] = pages.try_emplace(found[i][k].id);
            if (is_new) {
              stores.near->read_starred(found[i][k].id, whole->second, samples, counters);
            }
            StarredRecords part;
            const auto look = [&](const RecordPage& page) { page.decode(part); };
            stores.far->look_at(found[i][k], look, samples, counters);
            EXPECT_TRUE(are_same(whole->second, part));
          }
        }
      }
    }
  }
}

/// The triangle below the diagonal of a box.
class BelowDiagonal final : public StarPredicate {
 public:
  explicit BelowDiagonal(const GridBox& box) : box_(box) {}
  [[nodiscard]] bool may_hold(const StarAttributes& a) const noexcept override {
    return meets(a.box, box_) && std::int64_t{std::max(a.box.min_x, box_.min_x)} - box_.min_x +
                                         std::max(a.box.min_y, box_.min_y) - box_.min_y <=
                                     std::min(std::int64_t{box_.max_x} - box_.min_x,
                                              std::int64_t{box_.max_y} - box_.min_y);
  }
  [[nodiscard]] GridBox reach() const noexcept override { return box_; }

 private:
  GridBox box_;
};

TEST(PointDirectory, NamesEachPageWithLivingStarsInABox) {
  const TwoStores stores(HeightType::int32, 5);
  const PointDirectory& directory = *stores.far->directory();
  const GridBox& bounds = stores.near->facts().bounds;
  std::mt19937_64 random(2);
  std::size_t named = 0, expected = 0;
  for (int i = 0; i < 100; ++i) {
    StarFilter filter;
    filter.box = i == 0 ? GridBox{INT32_MIN, INT32_MIN, INT32_MAX, INT32_MAX}
                        : any_box(random, bounds.max_x);
    filter.level = std::vector<double>{-1.0, 0.0, 0.5, 10.0, 1e30}[random() % 5];
    filter.with_ties = random() % 2 == 0;
    const BelowDiagonal below(filter.box);
    filter.also = i > 0 && random() % 2 == 0 ? &below : nullptr;
    std::vector<StarPage> pages;
    std::vector<DirectoryPage> found;
    IoCounters counters, cost;
    stores.near->star_index().search_stars(filter, pages, counters);
    directory.find_in(filter, found, cost);
    for (std::size_t k = 1; k < found.size(); ++k) {
      ASSERT_LT(found[k - 1].id, found[k].id);
    }
    EXPECT_EQ(cost.bytes_read, directory.bytes_for(filter.box));
    for (const StarPage& page : pages) {
      const auto at = std::lower_bound(found.begin(), found.end(), page.id,
                                       [](const DirectoryPage& p, PageId id) { return p.id < id; });
      EXPECT_TRUE(at != found.end() && at->id == page.id) << "box " << i;
    }
    named += found.size();
    expected += pages.size();
  }
  EXPECT_LT(named, 2 * expected) << "boxes in bytes name more, not many";
  EXPECT_GT(expected, 1000U);
}

TEST(PointDirectory, IsSoundByVerify) {
  for (const std::uint64_t pages_of_cell : {1U, 7U, 1000U}) {
    const TestFolder folder;
    write_store(folder.file("a"), random_content({.segments = 4, .records = 2000}),
                {.directory = small_cells(pages_of_cell)});
    const VerifyReport report = verify_store(folder.file("a"));
    EXPECT_TRUE(report.is_sound()) << report.faults[0].what << " " << report.faults[0].where;
    EXPECT_GT(section_of(read_file(folder.file("a")), layout::SectionKind::kDirectory).bytes, 0U);
  }
}

/// What verify says of the store with one change, whatever checksums the change needs put right.
std::vector<std::string> faults_after(
    const TwoStores& stores,
    const std::function<void(Bytes&, std::uint64_t root, std::uint64_t nodes)>& change) {
  Bytes bytes = stores.bytes;
  change(bytes, section_of(bytes, layout::SectionKind::kDirectory).offset,
         section_of(bytes, layout::SectionKind::kDirectoryNodes).offset);
  seal(bytes);
  write_file(stores.folder.file("b"), bytes);
  std::vector<std::string> faults;
  for (const VerifyFault& f : verify_store(stores.folder.file("b")).faults) {
    faults.push_back(f.what + " " + f.where);
  }
  return faults;
}

TEST(PointDirectory, IsHeldAgainstTheIndexByVerify) {
  const TwoStores stores(HeightType::int32);
  const auto cells =
      object_at<layout::DirectoryHead>(
          stores.bytes, section_of(stores.bytes, layout::SectionKind::kDirectory).offset)
          .cells;
  ASSERT_GT(cells, 3U);
  const auto begins = [](const std::vector<std::string>& faults, const std::string& text) {
    return faults.size() == 1 && faults[0].find(text) == 0;
  };
  using Offset = std::uint64_t;
  // A node that says another thing, sealed or not.
  EXPECT_TRUE(begins(
      faults_after(stores, [](Bytes& b, Offset, Offset nodes) { b[nodes + 1] ^= std::byte{1}; }),
      "the node does not say what the index says of its pages directory node 0"));
  EXPECT_TRUE(begins(
      faults_after(stores, [](Bytes& b, Offset root, Offset) { b[root + 16] ^= std::byte{1}; }),
      "the node does not say what the index says of its pages directory node 0"));
  EXPECT_TRUE(begins(faults_after(stores,
                                  [&](Bytes& b, Offset root, Offset) {
                                    // The first two cells have other numbers of entries.
                                    const Offset at = root + 16 + 8 * cells;
                                    auto a = object_at<std::uint16_t>(b, at),
                                         c = object_at<std::uint16_t>(b, at + 2);
                                    set_object(b, at, static_cast<std::uint16_t>(a - 1));
                                    set_object(b, at + 2, static_cast<std::uint16_t>(c + 1));
                                  }),
                     "cell 0 has another number of entries than pages"));
  // What no program wrote is refused before it is used, by questions too.
  for (const auto& [at, value] :
       std::vector<std::pair<Offset, std::uint32_t>>{{0, cells + 1},
                                                     {8, 1},
                                                     {16 + 4 * cells, 1},
                                                     {16 + 4 * (cells + cells / 2), 0x7FFFFFFFU}}) {
    Bytes bytes = stores.bytes;
    set_object(bytes, section_of(bytes, layout::SectionKind::kDirectory).offset + at, value);
    seal(bytes);
    const auto far = StoreFile::open(std::make_shared<NotingSource>(bytes, 65536));
    std::vector<std::vector<DirectoryPage>> found(1);
    IoCounters counters;
    SampleHeights samples;
    const GridBox place{1, 1, 2, 2};
    EXPECT_THROW(far->directory()->find({&place, 1}, {}, found, counters), Error) << at;
    write_file(stores.folder.file("b"), bytes);
    EXPECT_EQ(verify_store(stores.folder.file("b")).faults.size(), 1U) << at;
  }
  {
    Bytes bytes = stores.bytes;
    const Offset nodes = section_of(bytes, layout::SectionKind::kDirectoryNodes).offset;
    bytes[nodes] ^= std::byte{1};
    write_file(stores.folder.file("b"), bytes);
    const VerifyReport report = verify_store(stores.folder.file("b"));
    ASSERT_EQ(report.faults.size(), 1U);
    EXPECT_EQ(report.faults[0].what, "the section does not match its checksum");
  }
}

/// A page that is not there, in a node whose checksum is right.
TEST(PointDirectory, RefusesAPageThatIsNotThere) {
  TwoStores stores(HeightType::int32);
  Bytes bytes = stores.bytes;
  const auto root = section_of(bytes, layout::SectionKind::kDirectory).offset;
  const auto nodes = section_of(bytes, layout::SectionKind::kDirectoryNodes).offset;
  const auto cells = object_at<layout::DirectoryHead>(bytes, root).cells;
  set_object(bytes, nodes, std::uint32_t{1} << 30);
  const std::uint64_t node_bytes =
      object_at<std::uint16_t>(bytes, root + 16 + 8 * cells) * layout::kDirectoryEntryBytes;
  set_object(bytes, root + 16,
             static_cast<std::uint32_t>(checksum_of(std::span(bytes).subspan(nodes, node_bytes))));
  seal(bytes);
  const auto far = StoreFile::open(std::make_shared<NotingSource>(bytes, 65536));
  std::vector<std::vector<DirectoryPage>> found(1);
  IoCounters counters;
  SampleHeights samples;
  const GridBox place{0, 0, 0, 0};
  EXPECT_THROW(far->directory()->find({&place, 1}, {}, found, counters), Error);
}

TEST(PointDirectory, IsWrittenWhereItPays) {
  const TestFolder folder;
  const auto has_directory = [&](const RandomRecords& records, const DirectoryOptions& options) {
    write_store(folder.file("a"), random_content(records),
                {.overwrite = true, .directory = options});
    return section_of(read_file(folder.file("a")), layout::SectionKind::kDirectory).bytes > 0;
  };
  const RandomRecords few{.segments = 2, .records = 1000};
  EXPECT_FALSE(has_directory(few, {})) << "its index comes with the opening";
  EXPECT_TRUE(has_directory(few, {.least_pages = 1}));
  // Entries of 14 bytes would take more than one for a thousand of the pages.
  EXPECT_FALSE(has_directory(few, {.least_pages = 1, .page_bytes_of_byte = 1000}));
  RandomRecords none = few;
  none.records = 0;
  EXPECT_FALSE(has_directory(none, {.least_pages = 0}));
}

}  // namespace
}  // namespace ptin::test
