// SPDX-License-Identifier: GPL-3.0-or-later
//
// What the reader of a stream rejects (storage/FORMAT.md, "Streams"), and what it keeps to.
#include "engine/query/stream/stream_reader.h"

#include <algorithm>
#include <cstring>
#include <iterator>
#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "engine/error.h"
#include "engine/mesh/validate.h"
#include "engine/query/questions.h"
#include "engine/query/stream/stream_writer.h"
#include "tests/query/stream/sent_stream.h"

namespace ptin {
namespace {

using reference::Asked;
using reference::Bytes;
using reference::canonical;
using reference::first;
using reference::Hierarchy;
using reference::sent;
using reference::TemporaryStore;

ErrorCode rejected(const Bytes& bytes) {
  StreamReader reader("stream");
  try {
    reader.feed(bytes);
  } catch (const Error& e) {
    EXPECT_NE(std::string(e.what()).find("stream"), std::string::npos);
    if (reader.has_mesh()) {
      EXPECT_EQ(validate(reader.tin()), "");
    }
    EXPECT_THROW(reader.feed(bytes), Error) << "a rejected stream goes on";
    return e.code();
  }
  return ErrorCode::internal;
}

TEST(StreamReader, RejectsAnyByteThatWasChanged) {
  const Asked asked(7);
  const Bytes bytes = sent(asked.store, {});
  std::mt19937_64 random(1);
  for (std::size_t i = 0; i < bytes.size(); i += 1 + random() % 7) {
    if (i == 10 || i == 11) {
      continue;  // a newer minor version is read
    }
    Bytes changed = bytes;
    changed[i] ^= static_cast<std::byte>(1U << (random() % 8));
    StreamReader reader("stream");
    try {
      reader.feed(changed);
      EXPECT_FALSE(reader.is_complete()) << "byte " << i;  // a length that grew waits for more
    } catch (const Error& e) {
      EXPECT_TRUE(e.code() == ErrorCode::corruption || e.code() == ErrorCode::unsupported_version);
    }
  }
}

/// A stream taken apart, changed and sealed again.
struct Frames {
  stream::Head head;
  std::vector<std::pair<stream::FrameHead, Bytes>> frames;

  explicit Frames(const Bytes& bytes) {
    std::memcpy(&head, bytes.data(), sizeof head);
    for (std::size_t at = sizeof head; at < bytes.size();) {
      stream::FrameHead f;
      std::memcpy(&f, bytes.data() + at, sizeof f);
      at += sizeof f;
      const auto begin = bytes.begin() + static_cast<std::ptrdiff_t>(at);
      frames.emplace_back(f, Bytes(begin, begin + static_cast<std::ptrdiff_t>(f.bytes)));
      at += f.bytes;
    }
  }
  [[nodiscard]] Bytes sealed() {
    Bytes bytes;
    const auto add = [&](std::span<const std::byte> b) {
      std::copy(b.begin(), b.end(), std::back_inserter(bytes));
    };
    add(std::as_bytes(std::span(&head, 1)));
    for (auto& [f, payload] : frames) {
      f.bytes = static_cast<std::uint32_t>(payload.size());
      f.checksum = stream::checksum_of_frame(f, payload);
      add(std::as_bytes(std::span(&f, 1)));
      add(payload);
    }
    return bytes;
  }
  template <class T, class Change>
  void edit(std::size_t frame, const Change& change) {
    T object;
    std::memcpy(&object, frames[frame].second.data(), sizeof object);
    change(object);
    std::memcpy(frames[frame].second.data(), &object, sizeof object);
  }
};

class StreamReaderRejects : public testing::Test {
 protected:
  StreamReaderRejects() : frames(sent(asked.store, {})) {}
  void expect(ErrorCode code = ErrorCode::corruption) {
    EXPECT_EQ(rejected(frames.sealed()), code);
  }
  Asked asked{7};
  Frames frames;
};

TEST_F(StreamReaderRejects, NothingWhenNothingIsWrong) {
  ASSERT_GE(frames.frames.size(), 4u);
  expect(ErrorCode::internal);
}
TEST_F(StreamReaderRejects, AnotherMagic) { frames.head.magic[1] = 'X', expect(); }
TEST_F(StreamReaderRejects, AFewOtherBytes) {
  for (const char* text : {"j", "junk"}) {
    const auto* bytes = reinterpret_cast<const std::byte*>(text);
    EXPECT_EQ(rejected({bytes, bytes + std::strlen(text)}), ErrorCode::invalid_argument) << text;
  }
}
TEST_F(StreamReaderRejects, ANewerMajorVersion) {
  frames.head.major_version = 2, expect(ErrorCode::unsupported_version);
}
TEST_F(StreamReaderRejects, MajorVersionZero) { frames.head.major_version = 0, expect(); }
TEST_F(StreamReaderRejects, AReservedFieldOfTheHead) { frames.head.reserved = 1, expect(); }
TEST_F(StreamReaderRejects, AFrameThatIsMissing) {
  frames.frames.erase(frames.frames.begin() + 2), expect();
}
TEST_F(StreamReaderRejects, AKindThatCannotComeHere) { frames.frames[1].first.kind = 3, expect(); }
TEST_F(StreamReaderRejects, AnUnknownKind) { frames.frames[2].first.kind = 9, expect(); }
TEST_F(StreamReaderRejects, AReservedFieldOfAFrame) {
  frames.frames[2].first.reserved = 1, expect();
}
TEST_F(StreamReaderRejects, AStartThatIsTooShort) { frames.frames[0].second.resize(100), expect(); }
TEST_F(StreamReaderRejects, AnUnknownFlag) {
  frames.edit<stream::Start>(0, [](auto& s) { s.flags = 2; }), expect();
}
TEST_F(StreamReaderRejects, ADeltaWithoutWhatItGoesOnFrom) {
  frames.edit<stream::Start>(0, [](auto& s) { s.flags = stream::kIsDelta; }), expect();
}
TEST_F(StreamReaderRejects, AMapThatIsNoMap) {
  frames.edit<stream::Start>(0, [](auto& s) { s.step_x = 0; }), expect();
}
TEST_F(StreamReaderRejects, NegativeBounds) {
  frames.edit<stream::Start>(0, [](auto& s) { s.error = layout::to_bits(-1.0); }), expect();
}
TEST_F(StreamReaderRejects, MetadataOfAnotherLength) {
  frames.edit<stream::Start>(0, [](auto& s) { s.metadata_bytes = 7; }), expect();
}
TEST_F(StreamReaderRejects, AnotherDigestThanThatOfT0) {
  frames.edit<stream::Start>(0, [](auto& s) { s.base_digest ^= 1; }), expect();
}
TEST_F(StreamReaderRejects, CountsThatAreNotThoseOfT0) {
  frames.edit<stream::T0Counts>(1, [](auto& c) { c.triangles += 1; }), expect();
}
TEST_F(StreamReaderRejects, AT0WithoutATriangle) {
  frames.edit<stream::T0Counts>(1, [](auto& c) { c.triangles = 0; }), expect();
}
TEST_F(StreamReaderRejects, AT0WhoseVerticesDoNotAscend) {
  auto& payload = frames.frames[1].second;
  std::swap_ranges(payload.begin() + 8, payload.begin() + 24, payload.begin() + 24);
  expect();
}
TEST_F(StreamReaderRejects, AT0ThatIsNoTin) {
  auto& payload = frames.frames[1].second;
  std::swap_ranges(payload.end() - 16, payload.end() - 12, payload.end() - 12);
  expect();
}
TEST_F(StreamReaderRejects, MoreSplitsThanWereSaid) {
  frames.edit<stream::Start>(0, [](auto& s) { s.splits -= 1; }), expect();
}
TEST_F(StreamReaderRejects, MoreSplitsThanTheirBytesCanHold) {
  frames.edit<stream::Start>(0, [](auto& s) { s.splits = 1U << 30; });
  frames.edit<stream::Splits>(2, [](auto& s) { s.count = 1U << 29; }), expect();
}
TEST_F(StreamReaderRejects, AFrameWithoutASplit) {
  frames.edit<stream::Splits>(2, [](auto& s) { s.count = 0; }), expect();
}
TEST(StreamReader, RejectsAFrameTooSmallForItsMesh) {
  std::mt19937_64 random(7);
  const Hierarchy h = reference::simplify(reference::random_grid(random, 40, 40, 1, 0.0), random);
  const TemporaryStore file(h);
  Frames frames(sent(file.open(), {}));
  ASSERT_GT(frames.frames.size(), 5u) << "start, T0, three of splits, end";
  frames.edit<stream::Splits>(3, [](auto& s) { s.count = 1; });
  StreamReader reader("stream");
  try {
    reader.feed(frames.sealed());
    FAIL();
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ErrorCode::corruption);
    EXPECT_NE(e.message().find("fewer splits"), std::string::npos) << e.message();
  }
  EXPECT_EQ(validate(reader.tin()), "");
}

TEST(StreamReader, KeepsToItsMemoryAndTellsBefore) {
  std::mt19937_64 random(8);
  const Hierarchy h = reference::simplify(reference::random_grid(random, 60, 60, 1, 0.0), random);
  const TemporaryStore file(h);
  const Bytes bytes = sent(file.open(), {});
  std::size_t least = 0;
  for (const std::uint64_t limit : {0U, 20'000U, 100'000U, 400'000U}) {
    StreamReader reader("stream", {limit, {}});
    try {
      reader.feed(bytes);
      FAIL() << limit;
    } catch (const Error& e) {
      EXPECT_EQ(e.code(), ErrorCode::resource_exhausted) << e.what();
    }
    EXPECT_GE(reader.tin().vertices.size(), least) << "more memory holds no less";
    EXPECT_LE(reader.tin().vertices.capacity() * sizeof(Vertex) +
                  reader.tin().triangles.capacity() * sizeof(Triangle),
              limit);
    least = reader.tin().vertices.size();
  }
  EXPECT_GT(least, 300u);
  StreamReader free("stream", {std::uint64_t{4} << 20, {}});
  free.feed(bytes);
  EXPECT_TRUE(free.is_complete());
}

TEST(StreamReader, StopsWhenCancelled) {
  std::stop_source stop;
  StreamReader reader("stream", {std::uint64_t{1} << 30, stop.get_token()});
  const Asked asked(5);
  const Bytes bytes = sent(asked.store, {});
  const std::size_t half = bytes.size() / 2;
  reader.feed(first(bytes, half));
  stop.request_stop();
  try {
    reader.feed(std::span(bytes).subspan(half));
    FAIL();
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ErrorCode::cancelled);
  }
  EXPECT_EQ(validate(reader.tin()), "");
}

TEST_F(StreamReaderRejects, ABoundThatIsNoNumber) {
  frames.edit<stream::Splits>(2, [](auto& s) { s.deviation = UINT64_MAX; }), expect();
}
TEST_F(StreamReaderRejects, ACodeThatIsCutShort) {
  std::vector<std::byte>& code = frames.frames[2].second;
  code.erase(code.end() - 8, code.end());
  expect();
}
TEST_F(StreamReaderRejects, BytesBehindTheCode) {
  frames.frames[2].second.push_back(std::byte{1}), expect();
}
TEST_F(StreamReaderRejects, AnEndThatComesTooEarly) {
  frames.edit<stream::Start>(0, [](auto& s) { s.splits += 1; }), expect();
}
TEST_F(StreamReaderRejects, AMeshThatIsNotTheOneSent) {
  frames.edit<stream::End>(frames.frames.size() - 1, [](auto& e) { e.digest ^= 1; }), expect();
}
TEST_F(StreamReaderRejects, AStreamThatBeginsAnewBehindAnother) {
  Bytes bytes = frames.sealed();
  const Bytes again = bytes;
  bytes.insert(bytes.end(), again.begin(), again.end());
  StreamReader reader("stream");
  EXPECT_EQ(reader.feed(bytes), again.size());
  EXPECT_THROW(reader.feed(again), Error);
}
TEST_F(StreamReaderRejects, ADeltaOfAnotherFileOrToAnotherMesh) {
  StreamRequest delta;
  delta.held = {{error_above(5.0)}};
  StreamReader reader("stream");
  reader.feed(frames.sealed());  // everything, which is more than was said
  EXPECT_THROW(reader.feed(sent(asked.store, delta)), Error);
  const Asked other(8);
  delta.held = {{everything()}};
  StreamReader second("stream");
  second.feed(frames.sealed());
  EXPECT_THROW(second.feed(sent(other.store, delta)), Error);
}
TEST_F(StreamReaderRejects, AnyCodeOrIsAValidTin) {
  std::mt19937_64 random(3);
  int refused = 0;
  for (int i = 0; i < 300; ++i) {
    Frames changed = frames;
    auto& payload = changed.frames[2 + random() % (frames.frames.size() - 3)].second;
    payload[24 + random() % (payload.size() - 24)] ^= static_cast<std::byte>(1U << (random() % 8));
    StreamReader reader("stream");
    try {
      reader.feed(changed.sealed());  // some of the last bits of a code say nothing
      EXPECT_EQ(canonical(reader.tin()), canonical(asked.hierarchy.full));
    } catch (const Error& e) {
      EXPECT_EQ(e.code(), ErrorCode::corruption);
      ++refused;
    }
    EXPECT_EQ(validate(reader.tin()), "");
  }
  EXPECT_GT(refused, 150);
}

}  // namespace
}  // namespace ptin
