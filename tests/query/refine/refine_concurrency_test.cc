// SPDX-License-Identifier: GPL-3.0-or-later
//
// Many queries at once on one store, some of them cancelled: each answer is the one it would be
// alone.
#include <atomic>
#include <chrono>
#include <optional>
#include <random>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include "engine/error.h"
#include "engine/query/questions.h"
#include "tests/query/random_predicate.h"
#include "tests/query/reference_hierarchy.h"

namespace ptin {
namespace {

struct Outcome {
  bool cancelled = false;
  std::vector<reference::Corners> triangles;
  std::string fault;
};

RefineRequest random_request(std::mt19937_64& random, const reference::Hierarchy& h) {
  RefineRequest request;
  if (random() % 4 != 0) {
    request.region = reference::random_region(random, h.facts);
  }
  if (random() % 3 == 0) {
    request.detail.vertices = h.t0.vertices.size() + random() % h.records.size();
  } else if (random() % 2 == 0) {
    request.detail.tolerance = static_cast<double>(random() % 100) * 0.1;
  }
  request.form = random() % 2 == 0 ? ResultForm::kMeetingRegion : ResultForm::kWholeDomain;
  return request;
}

Outcome ask(const Terrain& tin, const RefineRequest& request) {
  Outcome outcome;
  try {
    outcome.triangles = reference::canonical(tin.refine(request).tin);
  } catch (const Error& e) {
    outcome.cancelled = e.code() == ErrorCode::cancelled;
    outcome.fault = outcome.cancelled ? "" : e.what();
  }
  return outcome;
}

void sixty_four_at_once(PageAccess access) {
  std::mt19937_64 random(20);
  const reference::Hierarchy h =
      reference::simplify(reference::random_grid(random, 70, 70, 1, 0.02), random, {0.0, false});
  const reference::TemporaryStore file(h);
  const Terrain alone(file.open(access));
  const Terrain tin(file.open(access));  // its pages are all untouched when the queries begin
  constexpr int kQueries = 64;
  std::vector<RefineRequest> requests;
  std::vector<std::stop_source> stops(kQueries);
  std::vector<Outcome> outcomes(kQueries);
  for (int i = 0; i < kQueries; ++i) {
    requests.push_back(random_request(random, h));
    requests.back().limits.stop = stops[static_cast<std::size_t>(i)].get_token();
  }
  {
    std::vector<std::jthread> threads;
    for (std::size_t i = 0; i < kQueries; ++i) {
      threads.emplace_back([&, i] { outcomes[i] = ask(tin, requests[i]); });
    }
    for (std::size_t i = 0; i < kQueries; i += 3) {
      std::this_thread::sleep_for(std::chrono::microseconds(random() % 2000));
      stops[i].request_stop();
    }
  }
  for (std::size_t i = 0; i < kQueries; ++i) {
    EXPECT_EQ(outcomes[i].fault, "");
    EXPECT_TRUE(i % 3 == 0 || !outcomes[i].cancelled);
    if (!outcomes[i].cancelled) {
      RefineRequest request = requests[i];
      request.limits.stop = {};
      EXPECT_EQ(outcomes[i].triangles, ask(alone, request).triangles) << "query " << i;
    }
  }
}

TEST(RefineAtOnce, SixtyFourQueriesWithCancellationsOnAMappedStore) {
  sixty_four_at_once(PageAccess::kMapped);
}
TEST(RefineAtOnce, SixtyFourQueriesWithCancellationsOnAPreadStore) {
  sixty_four_at_once(PageAccess::kPread);
}

}  // namespace
}  // namespace ptin
