// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/measure/question.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <initializer_list>
#include <random>
#include <span>
#include <vector>

#include "engine/crs/crs_facts.h"

namespace ptin::tools {

namespace {

constexpr double kAboveGround = 2.0;  // of both ends of a sight line, height's unit

/// Draws numbers that depend on the seed and the question alone.
class Dice {
 public:
  Dice(std::uint64_t seed, QuestionKind kind, std::uint64_t number) {
    const auto low = [](std::uint64_t n) { return static_cast<std::uint32_t>(n); };
    std::seed_seq sequence{low(seed), low(seed >> 32), static_cast<std::uint32_t>(kind),
                           low(number), low(number >> 32)};
    random_.seed(sequence);
  }
  /// From `low` to below `high`.
  double between(double low, double high) {
    return low + (high - low) * static_cast<double>(random_() >> 11) * 0x1p-53;
  }

 private:
  std::mt19937_64 random_;
};

/// The side of a window as a share of the bounding box's; 0 for questions without a window.
double side_of(QuestionKind kind) {
  switch (kind) {
    case QuestionKind::kPoint:
    case QuestionKind::kSight:
      break;
    case QuestionKind::kWindow10000th:
      return 0.01;
    case QuestionKind::kWindow400th:
      return 0.05;
    case QuestionKind::kWindow25th:
    case QuestionKind::kIsoline25th:
      return 0.2;
  }
  return 0.0;
}

/// A number that tells other numbers apart.
std::uint64_t digest_of(std::initializer_list<std::uint64_t> numbers) {
  std::uint64_t digest = 0;
  for (const std::uint64_t n : numbers) digest = (digest ^ n) * 0x9e3779b97f4a7c15 + 1;
  return digest;
}

Answer ask_point(const Question& question, const Terrain& terrain, const LocateRequest& request) {
  const LocateResult result = terrain.locate(std::span(&question.at, 1), request);
  const auto& point = result.points[0];
  return {result.cost, digest_of({static_cast<std::uint64_t>(point.state),
                                  std::bit_cast<std::uint64_t>(point.height)})};
}

Answer ask_sight(const Question& question, const Terrain& terrain, const SightRequest& request) {
  const SightResult result =
      terrain.sight({question.at, kAboveGround, question.to, kAboveGround}, request);
  return {result.cost, digest_of({static_cast<std::uint64_t>(result.verdict),
                                  std::bit_cast<std::uint64_t>(result.clearance_min)})};
}

Answer ask_window(const Terrain& terrain, const RefineRequest& request) {
  const RefinedTin result = terrain.refine(request);
  return {result.cost, digest_of({result.vertices, result.triangles})};
}

Answer ask_isoline(const Terrain& terrain, const IsolineRequest& request) {
  const Isolines result = terrain.isolines(request);
  return {result.cost, digest_of({result.size(), result.points(), result.crossed.segments})};
}

}  // namespace

const char* name_of(QuestionKind kind) noexcept {
  switch (kind) {
    case QuestionKind::kPoint:
      return "point";
    case QuestionKind::kSight:
      return "sight line";
    case QuestionKind::kWindow10000th:
      return "window 1/10000";
    case QuestionKind::kWindow400th:
      return "window 1/400";
    case QuestionKind::kWindow25th:
      return "window 1/25";
    case QuestionKind::kIsoline25th:
      break;
  }
  return "isoline 1/25";
}

Questions::Questions(const StoreFile& store, std::uint64_t seed, std::optional<double> tolerance)
    : facts_(store.facts()), t0_(store.t0()), ground_(ground_of(crs_facts(store))), seed_(seed) {
  detail_.tolerance = tolerance;
  const GridBox& b = facts_.bounds;
  const double samples = (1.0 * b.max_x - b.min_x + 1) * (1.0 * b.max_y - b.min_y + 1);
  const double records = std::max(1.0, static_cast<double>(store.record_count()));
  for (const SectionInfo& section : store.sections()) {
    const auto bytes = static_cast<double>(section.bytes);
    if (section.name == "heights") bytes_of_sample_ = bytes / samples;
    if (section.name == "pages") bytes_of_record_ = bytes / records;
  }
}

bool Questions::is_in_hull(double x, double y) const {
  const auto is_left = [&](const CoarsestTin::T& t, int i) {
    const GridPoint a = t0_.vertices[t.v[i]].position;
    const GridPoint b = t0_.vertices[t.v[i == 2 ? 0 : i + 1]].position;
    return (b.x - 1.0 * a.x) * (y - a.y) - (b.y - 1.0 * a.y) * (x - a.x) >= 0;
  };
  return std::any_of(t0_.triangles.begin(), t0_.triangles.end(), [&](const CoarsestTin::T& t) {
    return is_left(t, 0) && is_left(t, 1) && is_left(t, 2);
  });
}

Question Questions::make(QuestionKind kind, std::uint64_t number, const Terrain& terrain) const {
  Dice dice(seed_, kind, number);
  const GridBox& box = facts_.bounds;
  const double side = side_of(kind);
  const double half_x = side / 2 * (1.0 * box.max_x - box.min_x);
  const double half_y = side / 2 * (1.0 * box.max_y - box.min_y);
  MapPoint place{};  // on the grid
  const auto draw = [&] {
    constexpr int kMostTries = 1000;  // a hull of no area to speak of has its places anywhere
    for (int i = 0; i == 0 || (i < kMostTries && !is_in_hull(place.x, place.y)); ++i) {
      place.x = dice.between(box.min_x + half_x, box.max_x - half_x);
      place.y = dice.between(box.min_y + half_y, box.max_y - half_y);
    }
    return facts_.map.to_map(place.x, place.y);
  };
  Question question;
  question.kind = kind;
  question.at = draw();
  const MapPoint low = facts_.map.to_map(place.x - half_x, place.y - half_y);
  const MapPoint high = facts_.map.to_map(place.x + half_x, place.y + half_y);
  question.window = {low.x, low.y, high.x, high.y};
  if (kind == QuestionKind::kSight) question.to = draw();
  if (kind == QuestionKind::kIsoline25th) {
    const double height = terrain.locate(std::span(&question.at, 1), {}).points[0].height;
    question.level = std::isfinite(height) ? height : (facts_.min_height + facts_.max_height) / 2;
    if (!std::isfinite(question.level)) question.level = 0;
  }
  return question;
}

Answer Questions::ask(const Question& question, const Terrain& terrain,
                      const QueryLimits& limits) const {
  switch (question.kind) {
    case QuestionKind::kPoint: {
      LocateRequest request;
      request.detail = detail_;
      request.limits = limits;
      return ask_point(question, terrain, request);
    }
    case QuestionKind::kSight: {
      SightRequest request;
      request.curvature.earth_diameter = ground_.earth_diameter;
      request.ground_distance = ground_.distance;
      request.detail = detail_;
      request.limits = limits;
      return ask_sight(question, terrain, request);
    }
    case QuestionKind::kIsoline25th: {
      IsolineRequest request;
      request.levels = {question.level};
      request.region = question.window;
      request.detail = detail_;
      request.limits = limits;
      return ask_isoline(terrain, request);
    }
    case QuestionKind::kWindow10000th:
    case QuestionKind::kWindow400th:
    case QuestionKind::kWindow25th:
      break;
  }
  RefineRequest request;
  request.region = question.window;
  request.form = ResultForm::kMeetingRegion;
  request.detail = detail_;
  request.limits = limits;
  return ask_window(terrain, request);
}

double Questions::samples_of(const Question& question) const {
  if (question.kind == QuestionKind::kPoint) return 4;
  const bool is_line = question.kind == QuestionKind::kSight;
  const Window& w = question.window;
  const MapPoint a = facts_.map.to_grid(is_line ? question.at : MapPoint{w.min_x, w.min_y});
  const MapPoint b = facts_.map.to_grid(is_line ? question.to : MapPoint{w.max_x, w.max_y});
  const double across = std::abs(b.x - a.x), up = std::abs(b.y - a.y);
  return is_line ? 2 * (across + up + 2) : (across + 1) * (up + 1);
}

std::uint64_t Questions::least_bytes(const Question& question, const Answer& answer) const {
  constexpr double kPageBytes = 4096;
  const bool is_by_heights =
      answer.cost.stars_read == 0 && bytes_of_sample_ > 0 && !detail_.tolerance;
  const double bytes = is_by_heights
                           ? samples_of(question) * bytes_of_sample_
                           : static_cast<double>(answer.cost.stars_read) * bytes_of_record_;
  return static_cast<std::uint64_t>(std::max(1.0, std::ceil(bytes / kPageBytes)) * kPageBytes);
}

PredicatePtr Questions::predicate(const Question& question) const {
  const bool is_point = question.kind == QuestionKind::kPoint;
  if (question.kind == QuestionKind::kSight || question.kind == QuestionKind::kIsoline25th)
    return nullptr;
  const Region region = is_point ? Region(question.at) : Region(question.window);
  std::vector<PredicatePtr> parts = {meets_region(region, facts_.map)};
  if (detail_.tolerance) parts.push_back(error_above(*detail_.tolerance));
  return all_of(std::move(parts));
}

}  // namespace ptin::tools
