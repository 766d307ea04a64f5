// SPDX-License-Identifier: GPL-3.0-or-later
#include "storage/file/ranged_file.h"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <random>

#include <gtest/gtest.h>

#include "engine/error.h"
#include "tests/storage/noting_source.h"
#include "tests/support/test_folder.h"

namespace ptin {
namespace {

using test::noise;
using test::NotingSource;
using test::TestFolder;

constexpr std::uint64_t kBlock = RangedFile::kBlockBytes;

class RangedFileTest : public testing::Test {
 protected:
  void open(std::size_t front = 0, RemoteCaches options = {}) {
    source = std::make_shared<NotingSource>(content, front);
    file = std::make_unique<RangedFile>(source, options);
  }
  void expect_reads(std::uint64_t offset, std::size_t bytes) const {
    std::vector<std::byte> got(bytes);
    file->read_at(got, offset);
    EXPECT_TRUE(std::equal(got.begin(), got.end(), content.begin() + static_cast<long>(offset)))
        << offset << " " << bytes;
  }
  void announce(const std::vector<ByteRange>& ranges) const { file->will_need(ranges); }

  std::vector<std::byte> content = noise(300 * kBlock + 77);
  std::shared_ptr<NotingSource> source;
  std::unique_ptr<RangedFile> file;
};

TEST_F(RangedFileTest, ReadsBlocksOnceAndTheFrontNotAtAll) {
  open(3 * kBlock);
  expect_reads(10, 2 * kBlock);
  EXPECT_TRUE(source->rounds.empty());
  expect_reads(5 * kBlock + 1, 10);
  expect_reads(5 * kBlock, kBlock);
  EXPECT_EQ(source->rounds, (std::vector<NotingSource::Round>{{{5 * kBlock, kBlock}}}));
  expect_reads(300 * kBlock + 5, 72);  // the last block is short
  EXPECT_EQ(source->rounds.back(), (NotingSource::Round{{300 * kBlock, 77}}));
  EXPECT_EQ(file->cost().remote_rounds, 3U) << "one for the front";
  EXPECT_EQ(file->cost().remote_bytes, 3 * kBlock + kBlock + 77);
}

TEST_F(RangedFileTest, ReadsWhatWasAnnouncedInOneRoundWhenItIsWanted) {
  open();
  announce({{10 * kBlock, kBlock}, {50 * kBlock, 2 * kBlock}, {200 * kBlock, kBlock}});
  EXPECT_TRUE(source->rounds.empty()) << "a hint alone reads nothing";
  expect_reads(10 * kBlock, kBlock);
  const std::vector<NotingSource::Round> one{
      {{10 * kBlock, kBlock}, {50 * kBlock, 2 * kBlock}, {200 * kBlock, kBlock}}};
  EXPECT_EQ(source->rounds, one);
  expect_reads(51 * kBlock, kBlock);
  expect_reads(200 * kBlock, kBlock);
  EXPECT_EQ(source->rounds, one);
  IoCounters counters;
  file->settle(counters);
  EXPECT_EQ(counters.remote_rounds, 1U);
  EXPECT_EQ(counters.remote_requests, 3U);
  EXPECT_EQ(counters.remote_bytes, 4 * kBlock);
  file->settle(counters);
  EXPECT_EQ(counters.remote_rounds, 1U) << "told once";
}

TEST_F(RangedFileTest, JoinsWhatLiesSideBySide) {
  open();
  announce({{10 * kBlock, kBlock},
            {11 * kBlock, kBlock},
            {13 * kBlock, kBlock},
            {14 * kBlock, kBlock},
            {30 * kBlock, kBlock}});
  expect_reads(10 * kBlock, 1);
  EXPECT_EQ(source->rounds,
            (std::vector<NotingSource::Round>{
                {{10 * kBlock, 2 * kBlock}, {13 * kBlock, 2 * kBlock}, {30 * kBlock, kBlock}}}))
      << "gaps are for whoever announces";
}

TEST_F(RangedFileTest, ForgetsAnnouncementsAtTheNextAndAtTheEndOfAQuestion) {
  open();
  announce({{10 * kBlock, kBlock}, {50 * kBlock, kBlock}});
  announce({{70 * kBlock, kBlock}});
  expect_reads(70 * kBlock, 1);
  announce({{90 * kBlock, kBlock}});
  file->check_unchanged();
  expect_reads(100 * kBlock, 1);
  EXPECT_EQ(source->rounds,
            (std::vector<NotingSource::Round>{{{70 * kBlock, kBlock}}, {{100 * kBlock, kBlock}}}));
}

TEST_F(RangedFileTest, TakesWhatIsAlsoNeededAlongWhateverIsReadNext) {
  open();
  const ByteRange beside{30 * kBlock, 2 * kBlock};
  file->will_also_need({&beside, 1});
  announce({{10 * kBlock, kBlock}, {50 * kBlock, kBlock}});
  expect_reads(50 * kBlock, 1);
  expect_reads(31 * kBlock, 1);
  EXPECT_EQ(source->rounds,
            (std::vector<NotingSource::Round>{{{30 * kBlock, 2 * kBlock}, {50 * kBlock, kBlock}}}));
  // Nothing is left of a question that ended.
  file->will_also_need({&beside, 1});
  file->check_unchanged();
  expect_reads(100 * kBlock, 1);
  EXPECT_EQ(source->rounds.back(), (NotingSource::Round{{100 * kBlock, kBlock}}));
}

TEST_F(RangedFileTest, SplitsLongAnnouncementsIntoRoundsThatTheCacheHolds) {
  open(0, {.memory_bytes = RangedFile::kLeastCacheBytes, .folder = {}});
  announce({{0, 300 * kBlock}});
  for (std::uint64_t block = 0; block < 300; ++block) expect_reads(block * kBlock, kBlock);
  const std::uint64_t most = RangedFile::kLeastCacheBytes / 4;
  EXPECT_EQ(source->rounds.size(), (300 * kBlock + most - 1) / most);
  std::uint64_t bytes = 0;
  for (const auto& round : source->rounds) {
    ASSERT_EQ(round.size(), 1U);
    EXPECT_LE(round[0].bytes, most);
    bytes += round[0].bytes;
  }
  EXPECT_EQ(bytes, 300 * kBlock) << "nothing is read twice";
  // The first blocks made room for the last.
  EXPECT_FALSE(file->is_at_hand({0, kBlock}));
  EXPECT_TRUE(file->is_at_hand({299 * kBlock, kBlock}));
}

TEST_F(RangedFileTest, ReadsAnythingWhateverIsAnnouncedAndHoweverSmallTheCache) {
  open(5 * kBlock, {.memory_bytes = 0, .folder = {}});
  std::mt19937_64 random(7);
  const auto below = [&](std::uint64_t n) { return random() % n; };
  for (int i = 0; i < 300; ++i) {
    std::vector<ByteRange> ranges;
    for (std::uint64_t n = below(20); n > 0; --n) {
      ranges.push_back({below(content.size() + kBlock), below(50 * kBlock)});
    }
    announce(ranges);
    const std::uint64_t offset = below(content.size());
    expect_reads(offset, below(std::min<std::uint64_t>(content.size() - offset, 400000)) + 1);
  }
}

TEST_F(RangedFileTest, FailsWhereTheSourceFailsAndReadsOnAfterwards) {
  open();
  source->fails = true;
  announce({{10 * kBlock, 3 * kBlock}});
  std::vector<std::byte> got(kBlock);
  EXPECT_THROW(file->read_at(got, 10 * kBlock), Error);
  source->fails = false;
  EXPECT_NO_THROW(file->check_unchanged());
  expect_reads(10 * kBlock, 3 * kBlock);
  EXPECT_THROW(file->read_at(got, content.size() - 5), Error) << "behind the end";
}

TEST_F(RangedFileTest, TellsThatTheObjectWasReplacedFromThenOn) {
  open(kBlock);
  EXPECT_NO_THROW(file->check_unchanged());
  source->fault = ErrorCode::corruption;
  source->fails = true;
  std::vector<std::byte> got(10);
  EXPECT_THROW(file->read_at(got, 10 * kBlock), Error);
  source->fails = false;
  EXPECT_THROW(file->check_unchanged(), Error);
}

class SparseCacheTest : public RangedFileTest {
 protected:
  void open_kept(std::uint64_t key = 42) {
    open(0, {.memory_bytes = 0, .folder = folder.path().string()});
    file->keep_on_disk(key);
  }
  TestFolder folder{TestFolder::Size::kSmall};
};

TEST_F(SparseCacheTest, KeepsBlocksForTheNextOpening) {
  open_kept();
  expect_reads(17 * kBlock, 40 * kBlock);
  expect_reads(300 * kBlock, 77);
  open_kept();
  expect_reads(17 * kBlock + 5, 40 * kBlock - 5);
  expect_reads(300 * kBlock, 77);
  EXPECT_TRUE(source->rounds.empty());
  expect_reads(16 * kBlock, 2 * kBlock);
  EXPECT_EQ(source->rounds, (std::vector<NotingSource::Round>{{{16 * kBlock, kBlock}}}));
  EXPECT_EQ(folder.names(), std::vector<std::string>{"000000000000002a.ptin-cache"});
}

TEST_F(SparseCacheTest, KeepsFilesOfOtherContentApart) {
  open_kept(42);
  expect_reads(0, kBlock);
  content = noise(content.size(), 2);
  open_kept(43);
  expect_reads(0, kBlock);
  EXPECT_EQ(source->rounds.size(), 1U);
}

TEST_F(SparseCacheTest, ReadsAgainWhatTheDiskHasDamaged) {
  open_kept();
  expect_reads(0, 20 * kBlock);
  const std::string path = folder.file("000000000000002a.ptin-cache");
  {
    std::fstream cache(path, std::ios::binary | std::ios::in | std::ios::out);
    cache.seekp(3 * kBlock + 100);
    cache.write("damage", 6);
    cache.seekp(301 * kBlock + 7 * 8);  // the checksum of block 7
    cache.write("\0\0\0\0\0\0\0\0", 8);
  }
  open_kept();
  expect_reads(0, 20 * kBlock);
  EXPECT_EQ(source->rounds,
            (std::vector<NotingSource::Round>{{{3 * kBlock, kBlock}, {7 * kBlock, kBlock}}}));
  std::filesystem::resize_file(path, 10 * kBlock);  // the checksums are gone
  open_kept();
  expect_reads(0, 20 * kBlock);
  EXPECT_EQ(source->rounds, (std::vector<NotingSource::Round>{{{0, 20 * kBlock}}}));
}

TEST_F(SparseCacheTest, RefusesAFolderThatIsNotThere) {
  open(0, {.memory_bytes = 0, .folder = folder.file("none")});
  EXPECT_THROW(file->keep_on_disk(1), Error);
}

}  // namespace
}  // namespace ptin
