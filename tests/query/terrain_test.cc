// SPDX-License-Identifier: GPL-3.0-or-later
//
// The one face: every question that Terrain answers is that of its sub-room, on the index in use,
// and within the limits of its request.
#include <cstddef>
#include <functional>
#include <memory>
#include <set>
#include <span>
#include <stop_token>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "engine/error.h"
#include "engine/query/questions.h"
#include "tests/query/built_terrain.h"

namespace ptin {
namespace {

/// Counts how often it is asked for pages, and asks another index.
class CountingIndex final : public RecordIndex {
 public:
  explicit CountingIndex(const RecordIndex& index) : index_(index) {}
  void search(const AttributePredicate& predicate, std::vector<PageId>& out,
              IoCounters& counters) const override {
    ++searches;
    index_.search(predicate, out, counters);
  }
  mutable int searches = 0;

 private:
  const RecordIndex& index_;
};

const Terrain& mountains() { return reference::built_terrain("mountains_257.tif"); }

MapPoint at(double x, double y) {
  const StoreFacts& facts = mountains().store().facts();
  return facts.map.to_map(x * facts.bounds.max_x, y * facts.bounds.max_y);
}

ViewshedRequest viewshed_request(const QueryLimits& limits) {
  ViewshedRequest request;
  request.eye = at(0.5, 0.5);
  request.eye_height = 2.0;
  request.radius = 500.0;
  request.limits = limits;
  return request;
}

IsolineRequest isoline_request(const QueryLimits& limits) {
  IsolineRequest request;
  request.levels = {500.0, 1000.0};
  request.limits = limits;
  return request;
}

/// Every question of the face, each asked with the same limits.
std::vector<std::pair<const char*, std::function<void(const Terrain&, const QueryLimits&)>>>
every_question() {
  static const std::vector<MapPoint> line = {at(0.2, 0.3), at(0.7, 0.6)};
  return {
      {"refine",
       [](const Terrain& t, const QueryLimits& l) {
         RefineRequest request;
         request.limits = l;
         static_cast<void>(t.refine(request));
       }},
      {"parts",
       [](const Terrain& t, const QueryLimits& l) {
         PartRequest request;
         request.limits = l;
         TinParts parts = t.parts(request);
         walk_cells(parts, [](const GridCell&, const Tin&, double) {});
       }},
      {"moving_window",
       [](const Terrain& t, const QueryLimits& l) {
         MovingWindow window = t.moving_window({l.memory_bytes, 0});
         window.move_to(everything(), l.stop);
       }},
      {"locate",
       [](const Terrain& t, const QueryLimits& l) {
         LocateRequest request;
         request.limits = l;
         // By stars two points fit any limit.
         static_cast<void>(t.locate(line, request, AnswerBy::kSplits));
       }},
      {"profile",
       [](const Terrain& t, const QueryLimits& l) {
         ProfileRequest request;
         request.limits = l;
         static_cast<void>(t.profile(line, request));
       }},
      {"profiles",
       [](const Terrain& t, const QueryLimits& l) {
         ProfileRequest request;
         request.limits = l;
         const std::vector<std::vector<MapPoint>> lines = {line, line};
         static_cast<void>(t.profile(lines, request));
       }},
      {"highest",
       [](const Terrain& t, const QueryLimits& l) {
         HighestRequest request;
         request.region = Window{at(0.4, 0.4).x, at(0.4, 0.4).y, at(0.6, 0.6).x, at(0.6, 0.6).y};
         request.limits = l;
         static_cast<void>(t.highest(request));
       }},
      {"sight",
       [](const Terrain& t, const QueryLimits& l) {
         SightRequest request;
         request.limits = l;
         static_cast<void>(t.sight({line[0], 2.0, line[1], 2.0}, request));
       }},
      {"sight_lines",
       [](const Terrain& t, const QueryLimits& l) {
         SightRequest request;
         request.limits = l;
         static_cast<void>(t.sight_lines(request, SightSolver::kCoarseRecords)
                               .solve({line[0], 2.0, line[1], 2.0}));
       }},
      {"viewshed",
       [](const Terrain& t, const QueryLimits& l) {
         static_cast<void>(t.viewshed(viewshed_request(l)));
       }},
      {"isolines", [](const Terrain& t,
                      const QueryLimits& l) { static_cast<void>(t.isolines(isoline_request(l))); }},
      {"volume",
       [](const Terrain& t, const QueryLimits& l) {
         VolumeRequest request;
         request.limits = l;
         static_cast<void>(t.volume(request));
       }},
      {"stream",
       [](const Terrain& t, const QueryLimits& l) {
         StreamRequest request;
         request.limits = l;
         t.stream(request, [](std::span<const std::byte>) {});
       }},
  };
}

ErrorCode code_of(const std::function<void()>& ask) {
  try {
    ask();
  } catch (const Error& e) {
    return e.code();
  }
  return ErrorCode::internal;
}

/// One byte is the least limit that there can be: whatever keeps something is refused.
TEST(Terrain, EveryQuestionKeepsToTheLimitsOfItsRequest) {
  std::stop_source stopped;
  stopped.request_stop();
  for (const auto& [name, ask] : every_question()) {
    SCOPED_TRACE(name);
    EXPECT_NO_THROW(ask(mountains(), {}));
    EXPECT_EQ(code_of([&] {
                ask(mountains(), QueryLimits{1, {}});
              }),
              ErrorCode::resource_exhausted);
    EXPECT_EQ(code_of([&] {
                ask(mountains(), QueryLimits{QueryLimits{}.memory_bytes, stopped.get_token()});
              }),
              ErrorCode::cancelled);
  }
}

TEST(Terrain, EveryQuestionThatSplitsAnswerSearchesTheIndexInUse) {
  for (const auto& [name, ask] : every_question()) {
    SCOPED_TRACE(name);
    const std::set<std::string> of_stars{"highest", "parts", "profile", "profiles", "volume"};
    if (of_stars.contains(name)) continue;  // the file has one index of stars
    Terrain terrain = mountains();          // a copy, which shares the file
    const auto index = std::make_shared<const CountingIndex>(mountains().store().index());
    terrain.use_index(index);
    ask(terrain, {});
    EXPECT_GT(index->searches, 0);
  }
}

TEST(Terrain, AnswersAsItsSubRoomsDo) {
  const Terrain& terrain = mountains();
  const std::vector<MapPoint> points = {at(0.31, 0.77), at(0.5, 0.5)};
  LocateRequest where;
  where.detail.tolerance = 5.0;
  const LocateResult located = terrain.locate(points, where);
  const LocateResult expected = locate(terrain, points, where);
  ASSERT_EQ(located.points.size(), points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    EXPECT_EQ(located.points[i].height, expected.points[i].height);
    EXPECT_EQ(located.points[i].height_min, expected.points[i].height_min);
  }
  EXPECT_EQ(terrain.highest({}).point.height, highest(terrain, {}).point.height);
  EXPECT_EQ(terrain.isolines(isoline_request({})).points(),
            isolines(terrain, isoline_request({})).points());
  EXPECT_EQ(terrain.viewshed(viewshed_request({})).visible_pixels,
            viewshed(terrain, viewshed_request({})).visible_pixels);
}

}  // namespace
}  // namespace ptin
