// SPDX-License-Identifier: GPL-3.0-or-later
//
// Progressive transmission: streams against refinements, cut anywhere, going on from others.
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
#include "engine/query/stream/stream_reader.h"
#include "engine/query/stream/stream_writer.h"
#include "tests/query/random_predicate.h"
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

RC_GTEST_PROP(Stream, GivesTheRefinementByWhatWasWanted, (std::uint64_t seed)) {
  Asked asked(seed);
  StreamRequest request;
  request.wanted = reference::random_predicate(asked.random, asked.hierarchy.facts, 2);
  request.metadata = "{\"n\":" + std::to_string(seed) + "}";
  const Bytes bytes = sent(asked.store, request);
  StreamReader reader("stream");
  for (std::size_t at = 0; at < bytes.size();) {  // in pieces of any size
    const std::size_t n = std::min<std::size_t>(1 + asked.random() % 700, bytes.size() - at);
    RC_ASSERT(!reader.is_complete());
    reader.feed(std::span(bytes).subspan(at, n));
    at += n;
  }
  RC_ASSERT(reader.is_complete());
  RC_ASSERT(reader.bytes_used() == bytes.size());
  RC_ASSERT(validate(reader.tin()).empty());
  RC_ASSERT(canonical(reader.tin()) == canonical(asked.fresh(request.wanted).tin));
  RC_ASSERT(reader.metadata() == request.metadata);
  RC_ASSERT(reader.splits() == asked.count(*request.wanted));
  RC_ASSERT(reader.t0_vertices() == asked.hierarchy.t0.vertices.size());
  StoreFacts facts = asked.hierarchy.facts;
  facts.source_samples = 0;
  facts.page_bytes = reader.facts().page_bytes;
  RC_ASSERT(reader.facts() == facts);
}

RC_GTEST_PROP(Stream, ComesFrameByFrameWhenWanted, (std::uint64_t seed)) {
  Asked asked(seed);
  StreamSummary summary;
  const Bytes bytes = sent(asked.store, {}, &summary);
  const std::size_t most = asked.random() % 2 == 0 ? bytes.size() : 1 + asked.random() % 700;
  StreamReader reader("stream");
  std::size_t grown = 0;
  for (std::span<const std::byte> rest(bytes); !rest.empty();) {
    const std::uint64_t used = reader.bytes_used();
    const std::size_t before = reader.tin().vertices.size();
    rest = rest.subspan(reader.feed_frame(rest.first(std::min(most, rest.size()))));
    grown += reader.tin().vertices.size() != before ? 1 : 0;
    // What was taken ends with the frame, or waits for the rest of one.
    RC_ASSERT(reader.bytes_used() == used || reader.bytes_used() == bytes.size() - rest.size());
  }
  RC_ASSERT(reader.is_complete());
  RC_ASSERT(grown == summary.frames - 2);  // but for start and end
  RC_ASSERT(canonical(reader.tin()) == canonical(asked.fresh(nullptr).tin));
}

/// Heights too, which canonical() leaves out.
std::vector<std::tuple<VertexKey, HeightBits, std::uint8_t>> vertices_of(const Tin& tin) {
  std::vector<std::tuple<VertexKey, HeightBits, std::uint8_t>> all;
  for (VertexId v = 0; v < tin.vertices.size(); ++v) {
    all.emplace_back(key_of(tin.position(v)), tin.vertices[v].height, tin.has_height[v]);
  }
  std::sort(all.begin(), all.end());
  return all;
}

TEST(Stream, GivesTheFullTinBackExactly) {
  for (std::uint64_t seed = 0; seed < 60; ++seed) {
    const Asked asked(seed);
    StreamReader reader("stream");
    reader.feed(sent(asked.store, {}));
    EXPECT_EQ(canonical(reader.tin()), canonical(asked.hierarchy.full)) << "seed " << seed;
    EXPECT_EQ(vertices_of(reader.tin()), vertices_of(asked.hierarchy.full)) << "seed " << seed;
    EXPECT_EQ(reader.certificate().error, asked.hierarchy.facts.base_error);
  }
}

/// What a cut stream has to be: the first records of the total order, and their certificate.
void require_prefix(const StreamReader& reader, const Asked& asked, const PredicatePtr& wanted) {
  RC_ASSERT(validate(reader.tin()).empty());
  const RefinedTin fresh = asked.fresh(wanted, reader.t0_vertices() + reader.splits());
  RC_ASSERT(reader.tin().vertices.size() == fresh.vertices);
  RC_ASSERT(canonical(reader.tin()) == canonical(fresh.tin));
  if (wanted == nullptr) {
    // As tight as the largest error left out, which a refinement by number may only bound.
    std::vector<double> errors{0.0}, deviations{0.0};
    for (const VertexSplit& r : asked.hierarchy.records) {
      const bool applied = std::any_of(reader.tin().vertices.begin(), reader.tin().vertices.end(),
                                       [&](const Vertex& v) { return v.position == r.u; });
      errors.push_back(applied ? 0.0 : r.error);
      deviations.push_back(applied ? 0.0 : r.deviation);
    }
    const double error = *std::max_element(errors.begin(), errors.end());
    RC_ASSERT(reader.certificate().error == error);
    RC_ASSERT(reader.certificate().error <= fresh.certified_error);
    RC_ASSERT(reader.certificate().deviation >=
              *std::max_element(deviations.begin(), deviations.end()));
  }
}

RC_GTEST_PROP(Stream, CutAnywhereIsTheFirstOfTheTotalOrderWithItsCertificate,
              (std::uint64_t seed)) {
  Asked asked(seed);
  StreamRequest request;
  if (asked.random() % 2 == 0) {
    request.wanted = reference::random_predicate(asked.random, asked.hierarchy.facts, 2);
  }
  const Bytes bytes = sent(asked.store, request);
  for (int i = 0; i < 6; ++i) {
    const std::size_t cut = asked.random() % (bytes.size() + 1);
    StreamReader reader("stream");
    reader.feed(first(bytes, cut));
    RC_ASSERT(reader.is_complete() == (cut == bytes.size()));
    RC_ASSERT(reader.bytes_used() <= cut);
    if (reader.has_mesh()) {
      require_prefix(reader, asked, request.wanted);
    }
  }
}

TEST(Stream, CanBeCutAtEveryByte) {
  const Asked asked(7);
  const Bytes bytes = sent(asked.store, {});
  StreamReader reader("stream");
  std::uint64_t splits = UINT64_MAX;
  double error = INFINITY;
  for (const std::byte b : bytes) {
    reader.feed({&b, 1});
    if (reader.has_mesh() && reader.splits() != splits) {
      splits = reader.splits();
      require_prefix(reader, asked, nullptr);
      EXPECT_LE(reader.certificate().error, error);
      error = reader.certificate().error;
    }
  }
  EXPECT_TRUE(reader.is_complete());
  EXPECT_EQ(splits, asked.hierarchy.records.size());
}

RC_GTEST_PROP(Stream, ADeltaBringsWhatIsMissingAndNothingElse, (std::uint64_t seed)) {
  Asked asked(seed);
  StreamReader reader("stream");
  std::vector<PredicatePtr> served;
  for (int i = 0; i < 4; ++i) {
    StreamRequest request;
    request.wanted = reference::random_predicate(asked.random, asked.hierarchy.facts, 2);
    for (const PredicatePtr& p : served) {
      request.held.push_back({p});
    }
    const std::size_t before = asked.count(*any_of(served));
    served.push_back(request.wanted);
    StreamSummary summary;
    reader.feed(sent(asked.store, request, &summary));
    RC_ASSERT(reader.is_complete());
    RC_ASSERT(summary.splits == asked.count(*any_of(served)) - before);
    RC_ASSERT(validate(reader.tin()).empty());
    RC_ASSERT(canonical(reader.tin()) == canonical(asked.fresh(any_of(served)).tin));
  }
}

RC_GTEST_PROP(Stream, ACutStreamIsTakenUpWhereItEnded, (std::uint64_t seed)) {
  Asked asked(seed);
  StreamRequest request;
  request.wanted = reference::random_predicate(asked.random, asked.hierarchy.facts, 1);
  const Bytes bytes = sent(asked.store, request);
  StreamReader reader("stream");
  reader.feed(first(bytes, bytes.size() / 4 + asked.random() % (bytes.size() - bytes.size() / 4)));
  if (!reader.has_mesh()) {
    return;
  }
  const std::uint64_t had = reader.splits();
  StreamRequest rest = request;
  rest.held = {{request.wanted, had}};
  reader.begin_next();
  reader.feed(sent(asked.store, rest));
  RC_ASSERT(reader.splits() == asked.count(*request.wanted) - had);
  RC_ASSERT(canonical(reader.tin()) == canonical(asked.fresh(request.wanted).tin));
}

/// Two servings that overlap, the second one a delta of few splits, then the rest.
void go_on_from_a_part(Asked& asked, bool cut) {
  StreamRequest one, two;
  one.wanted = reference::random_predicate(asked.random, asked.hierarchy.facts, 1);
  one.most_splits = asked.random() % (asked.count(*one.wanted) + 1);
  StreamReader reader("stream");
  reader.feed(sent(asked.store, one));
  two.held = {{one.wanted, one.most_splits}};
  const std::size_t all = asked.hierarchy.records.size();
  if (!cut) two.most_splits = asked.random() % (all + 1);
  const Bytes delta = sent(asked.store, two);
  reader.begin_next();
  reader.feed(first(delta, cut ? 1 + asked.random() % delta.size() : delta.size()));
  StreamRequest rest;
  rest.held = {{one.wanted, one.most_splits}, {two.wanted, reader.splits()}};
  const std::uint64_t had = one.most_splits + reader.splits();
  if (!reader.is_complete()) reader.begin_next();
  StreamSummary summary;
  reader.feed(sent(asked.store, rest, &summary));
  RC_ASSERT(reader.is_complete());
  RC_ASSERT(summary.splits == all - had);
  RC_ASSERT(canonical(reader.tin()) == canonical(asked.hierarchy.full));
}

RC_GTEST_PROP(Stream, ADeltaThatWasCutIsTakenUpWhereItEnded, (std::uint64_t seed)) {
  Asked asked(seed);
  go_on_from_a_part(asked, true);
}

RC_GTEST_PROP(Stream, ADeltaOfFewSplitsIsTakenUpWhereItEnded, (std::uint64_t seed)) {
  Asked asked(seed);
  go_on_from_a_part(asked, false);
}

TEST(Stream, SendsTheMostImportantSplitsWhenFewAreAskedFor) {
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    const Asked asked(seed);
    StreamRequest request;
    request.most_splits = asked.hierarchy.records.size() / 3;
    StreamReader reader("stream");
    StreamSummary summary;
    reader.feed(sent(asked.store, request, &summary));
    EXPECT_TRUE(reader.is_complete());
    require_prefix(reader, asked, nullptr);
    EXPECT_EQ(summary.certificate.error, reader.certificate().error);
  }
}

/// The triangles that a level crosses: one corner at or above it, one below.
std::vector<reference::Corners> crossing(const Tin& tin, double level, const HeightEncoding& h) {
  std::vector<reference::Corners> all;
  for (TriangleId t = 0; t < tin.triangles.size(); ++t) {
    int above = 0;
    for (const VertexId v : tin.triangles[t].v) {
      above += h.height(tin.vertices[v].height) >= level ? 1 : 0;
    }
    if (tin.classes[t] == TriangleClass::kSurface && above != 0 && above != 3) {
      all.push_back(reference::corners_of(tin, t));
    }
  }
  std::sort(all.begin(), all.end());
  return all;
}

TEST(Stream, OfALevelHasItsIsolineExactly) {
  std::size_t crossed = 0;
  for (std::uint64_t seed = 0; seed < 30; ++seed) {
    const Asked asked(seed);
    const StoreFacts& f = asked.hierarchy.facts;
    if (!(f.min_height < f.max_height)) {
      continue;
    }
    const double level = f.min_height + 0.37 * (f.max_height - f.min_height);
    StreamRequest request;
    request.wanted = contains_height(level, f.heights);
    StreamReader reader("stream");
    reader.feed(sent(asked.store, request));
    const auto wanted = crossing(asked.hierarchy.full, level, f.heights);
    EXPECT_EQ(crossing(reader.tin(), level, f.heights), wanted) << "seed " << seed;
    crossed += wanted.size();
  }
  EXPECT_GT(crossed, 100u);
}

TEST(Stream, IsTheSameTwice) {
  const Asked asked(12);
  EXPECT_EQ(sent(asked.store, {}), sent(asked.store, {}));
}

TEST(Stream, RefusesMoreThanItsMemoryBeforeSendingAnything) {
  const Asked asked(2);
  StreamRequest request;
  request.limits.memory_bytes = 10'000;
  bool sent_some = false;
  try {
    write_stream(OpenedTerrain(asked.store), request,
                 [&](std::span<const std::byte>) { sent_some = true; });
    FAIL() << "more than the limit was taken";
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ErrorCode::resource_exhausted);
  }
  EXPECT_FALSE(sent_some);
}

/// A piece after the other, each as large as the memory allows.
TEST(Stream, SendsAsManyAsItsMemoryHolds) {
  const Asked asked(2);
  const std::uint64_t all = asked.hierarchy.records.size();
  StreamReader reader("stream");
  StreamRequest request;
  request.fewest_splits = 1;
  // Enough to hold all, and not to send all at once.
  request.limits.memory_bytes = 310 * (all + asked.hierarchy.t0.vertices.size());
  int pieces = 0;
  for (std::uint64_t had = 0; had < all; had += reader.splits(), ++pieces) {
    ASSERT_LT(pieces, 20);
    if (pieces > 0) reader.begin_next();
    StreamSummary summary;
    reader.feed(sent(asked.store, request, &summary));
    ASSERT_GT(summary.splits, 0U);
    ASSERT_EQ(reader.tin().vertices.size(),
              asked.hierarchy.t0.vertices.size() + had + summary.splits);
    request.held.push_back({nullptr, summary.splits});
  }
  EXPECT_GT(pieces, 1);
  EXPECT_EQ(canonical(reader.tin()), canonical(asked.hierarchy.full));
}

/// True everywhere, and counts who asks.
class CountedPredicate final : public AttributePredicate {
 public:
  [[nodiscard]] bool holds(const Attributes&) const noexcept override {
    ++asked;
    return true;
  }
  mutable std::uint64_t asked = 0;
};

TEST(Stream, RefusesWhatIsHeldWithoutReadingIt) {
  const Asked asked(2);
  const auto counted = std::make_shared<CountedPredicate>();
  StreamRequest request;
  request.fewest_splits = 1;
  request.held = {{counted, asked.hierarchy.records.size() / 2}};
  request.limits.memory_bytes = 100 * asked.hierarchy.records.size();
  EXPECT_THROW(sent(asked.store, request), Error);
  EXPECT_EQ(counted->asked, 0U);
}

TEST(Stream, StopsWhenCancelled) {
  const Asked asked(2);
  std::stop_source stop;
  stop.request_stop();
  StreamRequest request;
  request.limits.stop = stop.get_token();
  EXPECT_THROW(sent(asked.store, request), Error);
}

}  // namespace
}  // namespace ptin
