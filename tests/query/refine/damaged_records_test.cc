// SPDX-License-Identifier: GPL-3.0-or-later
//
// Records that are wrong although every checksum fits (promise P8): the answer is an Error
// corruption that names the file, or a valid TIN; never a crash.
#include <algorithm>
#include <random>
#include <string>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "engine/error.h"
#include "engine/mesh/validate.h"
#include "engine/query/questions.h"
#include "tests/query/random_predicate.h"
#include "tests/query/reference_hierarchy.h"

namespace ptin {
namespace {

using reference::Hierarchy;
using reference::TemporaryStore;

GridPoint inside(std::mt19937_64& random, const GridBox& box) {
  const auto c = [&](int lo, int hi) {
    return lo + static_cast<int>(random() % (static_cast<std::uint64_t>(hi - lo) + 1));
  };
  return {c(box.min_x, box.max_x), c(box.min_y, box.max_y)};
}

/// Puts one field wrong, mostly to something plausible.
void damage(std::mt19937_64& random, VertexSplit& r, const std::vector<VertexSplit>& all) {
  const VertexSplit& other = all[random() % all.size()];
  switch (random() % 12) {
    case 0:
      r.w = inside(random, r.roi);
      break;
    case 1:
      r.vl = inside(random, r.roi);
      break;
    case 2:
      r.vr = inside(random, r.roi);
      break;
    case 3:
      r.u = inside(random, r.roi);
      break;
    case 4:
      std::swap(r.vl, r.vr);
      break;
    case 5:
      std::swap(r.w, r.vl);
      break;
    case 6:
      r.rank = static_cast<std::uint16_t>(random());
      break;
    case 7:
      r.rank = other.rank;
      break;
    case 8:
      r.flags = static_cast<std::uint16_t>(random() & VertexSplit::kAllFlags);
      break;
    case 9:
      r.w = r.u;
      break;
    case 10:
      r = other;
      break;
    default:
      r.error = r.error * 0.5F;
      break;
  }
}

RC_GTEST_PROP(DamagedRecords, AreNamedOrHarmless, (std::uint64_t seed)) {
  std::mt19937_64 random(seed);
  Hierarchy h = reference::random_hierarchy(seed);
  if (h.records.empty()) {
    return;
  }
  const std::size_t count = 1 + random() % 3;
  for (std::size_t i = 0; i < count; ++i) {
    damage(random, h.records[random() % h.records.size()], h.records);
  }
  std::unique_ptr<TemporaryStore> file;
  try {
    file = std::make_unique<TemporaryStore>(h);
  } catch (const Error&) {
    return;  // the writer saw it first
  }
  const Terrain tin(file->open());
  for (int i = 0; i < 4; ++i) {
    RefineRequest request;
    PredicatePtr p;
    if (i == 1) {
      request.detail.vertices = h.t0.vertices.size() + random() % (h.records.size() + 1);
    } else if (i > 1) {
      p = reference::random_predicate(random, h.facts, 2);
      request.also = p.get();
    }
    request.page_of_triangle = i % 2 == 1;
    try {
      const RefinedTin result = tin.refine(request);
      RC_ASSERT(validate(result.tin).empty());
    } catch (const Error& e) {
      RC_ASSERT(e.code() == ErrorCode::corruption);
      RC_ASSERT(std::string(e.what()).find(file->path) != std::string::npos);
      RC_ASSERT(std::string(e.what()).find("page") != std::string::npos);
    }
  }
}

std::string message_of(const Hierarchy& h) {
  const TemporaryStore file(h);
  try {
    (void)Terrain(file.open()).refine({});
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ErrorCode::corruption);
    return e.message();
  }
  return {};
}

Hierarchy small_grid() {
  std::mt19937_64 random(5);
  return reference::simplify(reference::random_grid(random, 12, 12, 3, 0.1), random, {0.0, true});
}

TEST(DamagedRecords, OfTheWrongRankAreNamedWithPageAndVertex) {
  Hierarchy h = small_grid();
  const auto coarsest =
      std::max_element(h.records.begin(), h.records.end(),
                       [](const VertexSplit& a, const VertexSplit& b) { return a.rank < b.rank; });
  coarsest->rank = 0;
  const std::string message = message_of(h);
  EXPECT_NE(message.find("page "), std::string::npos) << message;
  EXPECT_NE(message.find("record of vertex ("), std::string::npos) << message;
}

TEST(DamagedRecords, ThatGiveASurfaceToAVertexWithoutHeightAreRefused) {
  Hierarchy h = small_grid();
  const auto r = std::find_if(h.records.begin(), h.records.end(), [](const VertexSplit& s) {
    return (s.flags & (VertexSplit::kVertexVoid | VertexSplit::kLeftVoid | VertexSplit::kNoLeft)) ==
           0;
  });
  ASSERT_NE(r, h.records.end());
  r->flags |= VertexSplit::kVertexVoid;
  r->height = 0;
  EXPECT_NE(message_of(h).find("classes"), std::string::npos);
}

TEST(DamagedT0, IsRefusedWhenOpened) {
  const Hierarchy h = small_grid();
  ASSERT_GE(h.t0.triangles.size(), 2u);
  const auto refused = [](const Hierarchy& damaged) {
    try {
      const TemporaryStore file(damaged);
      const Terrain tin(file.open());
    } catch (const Error& e) {
      return e.code() == ErrorCode::corruption || e.code() == ErrorCode::invalid_argument;
    }
    return false;
  };
  EXPECT_FALSE(refused(h));
  Hierarchy d = h;
  d.t0.triangles[0].v[0] = 1000000;
  EXPECT_TRUE(refused(d)) << "a corner out of range";
  d = h;
  std::swap(d.t0.triangles[0].v[0], d.t0.triangles[0].v[1]);
  EXPECT_TRUE(refused(d)) << "clockwise";
  d = h;
  d.t0.triangles.push_back(d.t0.triangles[0]);
  EXPECT_TRUE(refused(d)) << "twice";
  d = h;
  d.t0.triangles.pop_back();
  EXPECT_TRUE(refused(d)) << "one is missing";
  d = h;
  d.t0.vertices.push_back({{1, 1}, 0, 1});
  EXPECT_TRUE(refused(d)) << "a vertex in no triangle";
  d = h;
  d.t0.triangles.clear();
  EXPECT_TRUE(refused(d)) << "no triangles";
}

}  // namespace
}  // namespace ptin
