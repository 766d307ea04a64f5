// SPDX-License-Identifier: GPL-3.0-or-later
//
// Streams of terrains that do not fit the memory: the same bytes, cell by cell.
#include <algorithm>
#include <cerrno>
#include <filesystem>
#include <fstream>
#include <string>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "engine/query/stream/cell_coder.h"
#include "engine/query/stream/stream_frames.h"
#include "engine/query/stream/vertex_ranks.h"
#include "tests/query/random_predicate.h"
#include "tests/query/stream/sent_stream.h"
#include "tests/storage/failing_files.h"

namespace ptin {
namespace {

using reference::Asked;
using reference::Bytes;
using reference::random_predicate;
using reference::sent;

std::string temporary_folder() { return std::filesystem::temp_directory_path().string(); }

/// A window, a tolerance, heights, or everything; whole or the first few; after servings that may have
/// been cut.
StreamRequest random_request(Asked& asked) {
  const auto predicate = [&]() -> PredicatePtr {
    if (asked.random() % 3 == 0) return nullptr;
    return random_predicate(asked.random, asked.hierarchy.facts, 2);
  };
  const auto splits = [&] {
    const bool all = asked.random() % 2 == 0;
    return all ? UINT64_MAX : asked.random() % (asked.hierarchy.records.size() + 1);
  };
  StreamRequest request;
  request.wanted = predicate();
  request.most_splits = splits();
  for (std::uint64_t i = asked.random() % 3; i-- > 0;)
    request.held.push_back({predicate(), splits()});
  return request;
}

/// The same, of which no cell may be large.
StreamRequest in_parts(StreamRequest request, std::mt19937_64& random) {
  request.temporary_folder = temporary_folder();
  request.most_part_bytes = std::uint64_t{1} << (10 + random() % 8);
  request.threads = 1 + static_cast<int>(random() % 2);
  return request;
}

RC_GTEST_PROP(StreamParts, AreTheStreamOfTheWhole, (std::uint64_t seed)) {
  Asked asked(seed);
  const StreamRequest request = random_request(asked);
  StreamSummary whole, parts;
  const Bytes bytes = sent(asked.store, request, &whole);
  const Bytes others = sent(asked.store, in_parts(request, asked.random), &parts);
  RC_ASSERT(parts.splits == whole.splits);
  // Of what the first few splits leave out a search in memory knows a bound alone.
  RC_ASSERT(parts.certificate.error <= whole.certificate.error);
  if (parts.certificate.error < whole.certificate.error) {
    RC_ASSERT(whole.splits == request.most_splits);
    RC_ASSERT(parts.bytes == whole.bytes);
  } else {
    RC_ASSERT(others == bytes);
  }
}

TEST(StreamParts, AreManyForLargeTerrains) {
  std::mt19937_64 random(5);
  for (const bool of_points : {false, true}) {
    const reference::Hierarchy hierarchy =
        reference::simplify_unmeasured(of_points ? reference::random_points(random, 8000, 300)
                                                 : reference::random_grid(random, 100, 90, 3, 0.2),
                                       random);
    const reference::TemporaryStore file(hierarchy);
    StreamRequest request;
    const Bytes bytes = sent(file.open(), request);
    request.temporary_folder = temporary_folder();
    for (const int threads : {1, 2}) {
      request.threads = threads;
      for (const std::uint64_t part_bytes : {std::uint64_t{1} << 17, std::uint64_t{1} << 19}) {
        request.most_part_bytes = part_bytes;
        EXPECT_TRUE(sent(file.open(), request) == bytes) << of_points << ' ' << part_bytes;
      }
    }
  }
}

TEST(StreamParts, OfManyBytesAreCutAtThem) {
  Asked asked(4);
  StreamRequest request;
  request.most_bytes = sent(asked.store, request).size() / 2;
  const Bytes bytes = sent(asked.store, request);
  EXPECT_TRUE(sent(asked.store, in_parts(request, asked.random)) == bytes);
}

/// Whatever a temporary file cannot do is an error of the right kind, before a frame is sent.
TEST(StreamParts, SayWhatTheirFilesCouldNotDo) {
  Asked asked(2);
  StreamRequest request = in_parts({}, asked.random);
  request.threads = 1;
  const OpenedTerrain terrain(asked.store);
  const auto run = [&](FileLayer& files) {
    QueryContext context(request.limits, "t.ptin");
    const auto frames = stream_in_parts(terrain, request, context, files);
    (void)frames->begin();
    std::vector<std::byte> coded;
    for (std::size_t i = 0; i < frames->cuts().frames(); ++i) frames->take(i, coded);
  };
  test::FailingFiles counted(0, 0, false);
  run(counted);
  ASSERT_GT(counted.calls(), 10);
  for (int nth = 1; nth < counted.calls(); ++nth) {  // the last one closes the file
    test::FailingFiles files(nth, ENOSPC, true);
    const auto code = test::code_of([&] { run(files); });
    ASSERT_TRUE(code.has_value()) << nth;
    EXPECT_TRUE(code == ErrorCode::resource_exhausted || code == ErrorCode::io_error) << nth;
  }
}

TEST(StreamParts, NoticeADamagedPage) {
  const Asked asked(3);
  StreamRequest request;
  request.temporary_folder = temporary_folder();
  request.most_part_bytes = 1 << 14;
  const std::string copy = asked.file.path + ".damaged";
  std::filesystem::copy_file(asked.file.path, copy);
  {
    std::fstream file(copy, std::ios::binary | std::ios::in | std::ios::out);
    file.seekp(-100, std::ios::end);  // in the pages, which come last but for the floor
    file.write("damage", 6);
  }
  EXPECT_EQ(test::code_of([&] { (void)sent(StoreFile::open(copy), request); }),
            ErrorCode::corruption);
  std::filesystem::remove(copy);
}

TEST(StreamParts, TakeNoLessThanAFrame) {
  Asked asked(2);
  StreamRequest request = in_parts({}, asked.random);
  request.limits.memory_bytes = 10'000;
  EXPECT_EQ(test::code_of([&] { (void)sent(asked.store, request); }),
            ErrorCode::resource_exhausted);
}

RC_GTEST_PROP(VertexRanks, CountWhatIsThere, (std::uint64_t seed)) {
  std::mt19937_64 random(seed);
  const std::size_t places = 1 + random() % 3000;
  VertexRanks ranks(places);
  std::vector<bool> is_there(places);
  for (int batch = 0; batch < 3; ++batch) {
    for (std::size_t i = random() % places; i-- > 0;) {
      const std::size_t at = random() % places;
      ranks.add(at);
      is_there[at] = true;
    }
    ranks.count();
    std::uint32_t before = 0;
    for (std::size_t at = 0; at < places; ++at) {
      RC_ASSERT(ranks.before(at) == before);
      before += is_there[at] ? 1 : 0;
    }
  }
}

}  // namespace
}  // namespace ptin
