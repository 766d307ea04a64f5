// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/verify/verify_against.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include "engine/crs/crs_facts.h"
#include "engine/error.h"
#include "engine/query/shape/tiler.h"
#include "engine/stop.h"
#include "storage/floor.h"
#include "tools/facts/human.h"
#include "tools/verify/border_lines.h"
#include "tools/verify/lone_points.h"
#include "tools/verify/scan_triangle.h"
#include "tools/verify/sorted_samples.h"
#include "tools/verify/surface_points.h"

namespace ptin::tools {

namespace {

/// What the triangles of one answer say about one sample.
struct Finding {
  /// The least vertical distance over the closed surface triangles that hold the sample.
  double residual = std::numeric_limits<double>::infinity();
  bool in_closed_surface = false;
  bool in_closed_void = false;
  bool covered = false;
  std::uint8_t open_triangles = 0;
};

class Verifier {
 public:
  Verifier(const Terrain& terrain, SourceSamples& source, const AgainstOptions& options)
      : terrain_(terrain),
        source_(source),
        options_(options),
        facts_(terrain.store().facts()),
        choices_(choices_of(terrain.store())),
        ground_(ground_of(crs_facts(terrain.store()))) {
    for (const auto& tolerance : options.tolerances)
      report_.checks.push_back({.tolerance = tolerance});
    const double height = std::max(std::abs(facts_.min_height), std::abs(facts_.max_height));
    // Interpolation in doubles rounds by less.
    slack_ = std::isfinite(height) ? 1e-12 * height : 0.0;
  }

  AgainstReport run();

 private:
  void check_window(const GridBox& box);
  [[nodiscard]] SampleWindow read_with_margin(const GridBox& box) const;
  [[nodiscard]] RefinedTin refined_in(const GridBox& box,
                                      const std::optional<double>& tolerance) const;
  [[nodiscard]] std::vector<Finding> findings(const Tin& tin, const SampleWindow& window) const;
  [[nodiscard]] bool is_too_long(GridPoint a, GridPoint b) const;
  void drop_lone_points(SampleWindow& window) const;
  [[nodiscard]] bool may_be_left_out_as_lone(const SourceSample& sample);
  void judge(const SampleWindow& window, const GridBox& box, const std::vector<Finding>& found,
             double allowed, ToleranceCheck& check);
  [[nodiscard]] std::int64_t margin_of(const GridBox& box) const;
  [[nodiscard]] GridBox widened(const GridBox& box, std::int64_t margin) const;
  [[nodiscard]] GroundSteps least_steps(const GridBox& box) const;
  [[nodiscard]] double border_moves(double allowed) const;
  [[nodiscard]] bool reaches(const GridBox& box, double moved) const;
  [[nodiscard]] BorderLines source_border(const SampleWindow& window, const GridBox& box) const;
  void judge_lone_heights(const SampleWindow& window, const GridBox& box);
  void judge_class(const GridBox& box, const SourceSample& sample, double allowed,
                   ToleranceCheck& check);
  void judge_border(const GridBox& box, double allowed, ToleranceCheck& check);
  void judge_lines(const BorderLines& from, const BorderLines& to, const GridBox& box,
                   double allowed, const char* what, ToleranceCheck& check);
  [[nodiscard]] std::vector<SurfacePoint> random_points(const GridBox& box);
  void judge_lines_of(const Tin& tin, const std::vector<SurfacePoint>& points, double allowed,
                      ToleranceCheck& check);
  void judge_random_points(const GridBox& box, const std::vector<SurfacePoint>& points,
                           const RefinedTin& refined, double allowed, ToleranceCheck& check);
  void fault(ToleranceCheck* check, std::string what);
  [[nodiscard]] std::string place_text(double x, double y) const;
  [[nodiscard]] std::vector<GridBox> windows();

  const Terrain& terrain_;
  SourceSamples& source_;
  const AgainstOptions& options_;
  const StoreFacts& facts_;
  SampleChoices choices_;
  Ground ground_;
  double slack_ = 0.0;
  bool is_grid_ = false;  ///< The source is a raster.
  AgainstReport report_;
  std::optional<BorderLines> border_;  ///< The source's border, in and around the window at hand.
  std::mt19937_64 random_{20260101};
};

void Verifier::fault(ToleranceCheck* check, std::string what) {
  ++report_.fault_count;
  if (check != nullptr) {
    ++check->faults;
    what.insert(
        0, check->tolerance
               ? std::string("at tolerance ").append(short_number(*check->tolerance)).append(": ")
               : std::string("in the full TIN: "));
  }
  if (report_.faults.size() < options_.listed_faults) report_.faults.push_back(std::move(what));
}

std::string Verifier::place_text(double x, double y) const {
  const MapPoint p = facts_.map.to_map(x, y);
  char text[96];
  std::snprintf(text, sizeof text, "(%.15g, %.15g)", p.x, p.y);
  return text;
}

/// A raster is cut into squares of samples; points are halved until few enough are in each window.
std::vector<GridBox> Verifier::windows() {
  is_grid_ = source_.read(box_of(GridPoint{facts_.bounds.min_x, facts_.bounds.min_y})).is_grid;
  std::vector<GridBox> boxes;
  work_in_parts(facts_.bounds, [&](const GridBox& box) {
    stop_if_asked(options_.stop, "verification");
    const std::int64_t side =
        std::max(std::int64_t{box.max_x} - box.min_x, std::int64_t{box.max_y} - box.min_y);
    const bool is_small = is_grid_ ? side < options_.window_side
                                   : side < 2 || source_.count(box) <= options_.samples_per_window;
    if (is_small) boxes.push_back(box);
    return is_small;
  });
  return boxes;
}

AgainstReport Verifier::run() {
  const Misfits& misfits = source_.misfits();
  for (const std::string& misfit : misfits.first) fault(nullptr, misfit);
  report_.fault_count += misfits.count - misfits.first.size();
  const std::vector<GridBox> boxes = windows();
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    stop_if_asked(options_.stop, "verification");
    if (options_.progress) options_.progress(i, boxes.size());
    check_window(boxes[i]);
  }
  if (options_.progress) options_.progress(boxes.size(), boxes.size());
  // A boundary without heights brings vertices that no input has.
  const bool may_be_fewer = source_.lines() != nullptr && source_.lines()->is_flat();
  for (const ToleranceCheck& check : report_.checks) {
    const std::uint64_t samples = check.samples + check.lone_samples;
    const bool is_told =
        samples == facts_.source_samples || (may_be_fewer && samples < facts_.source_samples);
    if (report_.fault_count == 0 && !is_told) {
      fault(nullptr, "the source has " + grouped(check.samples) +
                         " samples with a height, the file says " + grouped(facts_.source_samples));
    }
  }
  return std::move(report_);
}

RefinedTin Verifier::refined_in(const GridBox& box, const std::optional<double>& tolerance) const {
  const MapPoint low = facts_.map.to_map(box.min_x, box.min_y);
  const MapPoint high = facts_.map.to_map(box.max_x, box.max_y);
  RefineRequest request;
  request.region = Window{low.x, low.y, high.x, high.y};
  request.detail.tolerance = tolerance;
  request.form = ResultForm::kMeetingRegion;
  request.limits.stop = options_.stop;
  return terrain_.refine(request);
}

/// How far the border may have moved where an answer is off by `allowed`, in ground units.
double Verifier::border_moves(double allowed) const {
  constexpr double kFormulas = 1.001;  // Two formulas for a degree's length differ by less.
  // What is no raster is held against the file's own finest TIN, which may be off by the base error.
  const double base = is_grid_ ? 0.0 : facts_.base_error;
  return choices_.void_slope > 0 ? (allowed + base) / choices_.void_slope * kFormulas +
                                       1e-9 * least_steps(facts_.bounds).y
                                 : std::numeric_limits<double>::infinity();
}

/// Whether what lies as far as `moved` from a window is looked at with it.
bool Verifier::reaches(const GridBox& box, double moved) const {
  const GroundSteps steps = least_steps(box);
  return moved <= static_cast<double>(margin_of(box)) * std::min(steps.x, steps.y);
}

/// The least steps of the rows of a box: distances come out too small rather than too large.
GroundSteps Verifier::least_steps(const GridBox& box) const {
  const GroundSteps low = ground_steps(facts_.map, ground_, box.min_y);
  const GroundSteps high = ground_steps(facts_.map, ground_, box.max_y);
  return {std::min(low.x, high.x), std::min(low.y, high.y)};
}

/// How far around a window the border is looked for, in grid units: as far as it may have moved at the
/// largest tolerance, within reason.
std::int64_t Verifier::margin_of(const GridBox& box) const {
  double largest = 0.0;
  for (const auto& tolerance : options_.tolerances)
    largest = std::max(largest, tolerance.value_or(0.0));
  const GroundSteps steps = least_steps(box);
  const double moved = border_moves(std::max(largest, facts_.base_error));
  const double sides = 2.0 * std::max(options_.window_side, box.max_x - box.min_x);
  return static_cast<std::int64_t>(std::min(sides, std::ceil(moved / std::min(steps.x, steps.y)))) +
         2;
}

GridBox Verifier::widened(const GridBox& box, std::int64_t margin) const {
  const GridBox& all = facts_.bounds;
  const auto within = [](std::int64_t v, std::int32_t low, std::int32_t high) {
    return static_cast<std::int32_t>(std::clamp<std::int64_t>(v, low, high));
  };
  return {within(box.min_x - margin, all.min_x, all.max_x),
          within(box.min_y - margin, all.min_y, all.max_y),
          within(box.max_x + margin, all.min_x, all.max_x),
          within(box.max_y + margin, all.min_y, all.max_y)};
}

SampleWindow Verifier::read_with_margin(const GridBox& box) const {
  SampleWindow inner = source_.read(box);
  if (!is_grid_) return inner;
  SampleWindow window = source_.read(widened(box, !facts_.free_of_voids ? margin_of(box) : 2));
  drop_lone_samples(window);
  return window;
}

/// The border of the source in and around a window: by the mask of a raster, by the file's own finest
/// triangles elsewhere (whose corners and classes are checked one by one).
BorderLines Verifier::source_border(const SampleWindow& window, const GridBox& box) const {
  const GroundSteps steps = least_steps(widened(box, margin_of(box)));
  if (window.is_grid) return {border_of_mask(window), steps};
  return {border_of_tin(refined_in(widened(box, margin_of(box)), std::nullopt).tin), steps};
}

bool Verifier::is_too_long(GridPoint a, GridPoint b) const {
  const GroundSteps steps =
      ground_steps(facts_.map, ground_, (static_cast<double>(a.y) + b.y) / 2.0);
  constexpr double kFormulas = 0.999;  // Two formulas for a degree's length differ by less.
  return std::hypot((static_cast<double>(a.x) - b.x) * steps.x,
                    (static_cast<double>(a.y) - b.y) * steps.y) >
         *choices_.max_edge * (ground_.geographic ? kFormulas : 1.0 - 1e-9);
}

/// Makes points void whose triangles in the full TIN are all void, each for its long edge: they
/// have no surface to be measured against. The triangles are the file's own; that each is long
/// enough is checked here.
void Verifier::drop_lone_points(SampleWindow& window) const {
  if (window.is_grid || !choices_.max_edge) return;
  const Tin tin = refined_in(window.box, std::nullopt).tin;
  enum : std::uint8_t { kUnseen, kLone, kSurface };
  std::vector<std::uint8_t> seen(tin.vertices.size(), kUnseen);
  for (TriangleId t = 0; t < tin.triangles.size(); ++t) {
    const auto& v = tin.triangles[t].v;
    const std::array<GridPoint, 3> p{tin.position(v[0]), tin.position(v[1]), tin.position(v[2])};
    const bool is_void =
        tin.classes[t] == TriangleClass::kVoid &&
        (is_too_long(p[0], p[1]) || is_too_long(p[1], p[2]) || is_too_long(p[2], p[0]) ||
         (source_.lines() != nullptr && source_.lines()->has_boundary()));
    for (const VertexId corner : v) {
      seen[corner] = is_void && seen[corner] != kSurface ? kLone : kSurface;
    }
  }
  const auto before = [](const SourceSample& s, GridPoint p) {
    return s.y != p.y ? s.y < p.y : s.x < p.x;
  };
  for (VertexId v = 0; v < tin.vertices.size(); ++v) {
    const GridPoint p = tin.position(v);
    const auto it = std::lower_bound(window.samples.begin(), window.samples.end(), p, before);
    if (seen[v] == kLone && it != window.samples.end() && it->x == p.x && it->y == p.y) {
      it->is_void = it->is_lone = true;
    }
  }
}

void Verifier::check_window(const GridBox& box) {
  SampleWindow window = read_with_margin(box);
  drop_lone_points(window);
  if (window.is_grid) judge_lone_heights(window, box);
  border_.reset();
  if (!facts_.free_of_voids) border_.emplace(source_border(window, box));
  const std::vector<SurfacePoint> anywhere = random_points(box);
  std::vector<SurfacePoint> on_lines;
  if (source_.lines() != nullptr) {
    on_lines = points_along(*source_.lines(), box, [&](GridPoint p) {
      return source_.read(box_of(p)).samples.at(0).height;
    });
  }
  for (ToleranceCheck& check : report_.checks) {
    const RefinedTin refined = refined_in(box, check.tolerance);
    check.certified_error = std::max(check.certified_error, refined.certified_error);
    check.certified_deviation = std::max(check.certified_deviation, refined.certified_deviation);
    const double asked = std::max(check.tolerance.value_or(0.0), facts_.base_error);
    if (refined.certified_error > asked) {
      fault(&check, "the answer certifies only " + short_number(refined.certified_error) +
                        " near " + place_text(box.min_x, box.min_y));
    }
    const double allowed = std::min(asked, refined.certified_error);
    judge(window, box, findings(refined.tin, window), allowed, check);
    if (border_) judge_border(box, allowed, check);
    judge_lines_of(refined.tin, on_lines, allowed, check);
    if (check.tolerance) judge_random_points(box, anywhere, refined, allowed, check);
  }
}

/// The heights of lone samples are those of no vertex: only the raster's own in the file have them.
void Verifier::judge_lone_heights(const SampleWindow& window, const GridBox& box) {
  const Floor* const floor = terrain_.store().floor();
  if (floor == nullptr || std::ranges::none_of(window.samples, &SourceSample::is_lone)) return;
  const FloorShape& shape = floor->facts().shape;
  Floor::Recent recent;
  IoCounters counters;
  floor->visit(
      [&](const Floor::Bounds& b) { return meets(b.box, box); },
      [&](const Floor::TileAt& at, const FloorTile& tile) {
        for (const FloorTile::Lone& lone : tile.lone) {
          const GridPoint p{
              static_cast<std::int32_t>(shape.first_of(at.column) + lone.place % tile.width),
              static_cast<std::int32_t>(shape.first_of(at.row) + lone.place / tile.width)};
          if (!contains(box, p)) continue;
          const SourceSample& sample = sample_at(window, p.x, p.y);
          const double height = facts_.heights.height(floor->numbers().bits(lone.height));
          if (std::abs(height - sample.height) <= slack_) continue;
          fault(nullptr, "the lone sample at " + place_text(p.x, p.y) + " has height " +
                             short_number(sample.height) + " in the source, and " +
                             short_number(height) + " in the heights of the raster");
        }
        return true;
      },
      recent, counters);
}

std::vector<Finding> Verifier::findings(const Tin& tin, const SampleWindow& window) const {
  std::vector<Finding> found(window.samples.size());
  const std::int64_t width = std::int64_t{window.box.max_x} - window.box.min_x + 1;
  for (TriangleId t = 0; t < tin.triangles.size(); ++t) {
    const auto& v = tin.triangles[t].v;
    const std::array<GridPoint, 3> corners{tin.position(v[0]), tin.position(v[1]),
                                           tin.position(v[2])};
    const auto lines = edge_lines(corners);
    const bool is_surface = tin.classes[t] == TriangleClass::kSurface;
    const auto visit = [&](std::size_t i, const Weights& weights) {
      Finding& f = found[i];
      f.covered = true;
      f.open_triangles = static_cast<std::uint8_t>(f.open_triangles + (weights.in_open() ? 1 : 0));
      f.in_closed_void = f.in_closed_void || !is_surface;
      if (!is_surface) return;
      f.in_closed_surface = true;
      const double height =
          height_in(tin, t, facts_.heights,
                    {static_cast<double>(weights.w[0]), static_cast<double>(weights.w[1]),
                     static_cast<double>(weights.w[2])});
      const double distance = std::abs(height - window.samples[i].height);
      f.residual = std::min(f.residual, std::max(0.0, distance - slack_));
    };
    if (window.is_grid) {
      scan_triangle(corners, window.box, [&](std::int32_t x, std::int32_t y) {
        visit(static_cast<std::size_t>((y - window.box.min_y) * width + (x - window.box.min_x)),
              weights_at(lines, {x, y}));
      });
      continue;
    }
    // Points are sorted by y, then x: those in the rows of the triangle are one run.
    const std::int32_t low = std::min({corners[0].y, corners[1].y, corners[2].y});
    const std::int32_t high = std::max({corners[0].y, corners[1].y, corners[2].y});
    auto it = std::lower_bound(window.samples.begin(), window.samples.end(), low,
                               [](const SourceSample& s, std::int32_t y) { return s.y < y; });
    for (; it != window.samples.end() && it->y <= high; ++it) {
      const Weights weights = weights_at(lines, {it->x, it->y});
      if (weights.in_closed())
        visit(static_cast<std::size_t>(it - window.samples.begin()), weights);
    }
  }
  return found;
}

void Verifier::judge(const SampleWindow& window, const GridBox& box,
                     const std::vector<Finding>& found, double allowed, ToleranceCheck& check) {
  for (std::size_t i = 0; i < window.samples.size(); ++i) {
    const SourceSample& sample = window.samples[i];
    if (!contains(box, GridPoint{sample.x, sample.y})) continue;  // A sample of the margin.
    const Finding& f = found[i];
    ++(sample.is_void ? check.void_samples : check.samples);
    check.lone_samples += sample.is_lone ? 1 : 0;
    if (!f.covered || f.open_triangles > 1) {
      fault(&check, std::string(f.covered ? "two triangles overlap at " : "no triangle covers ") +
                        place_text(sample.x, sample.y));
    } else if (!sample.is_void && !f.in_closed_surface && may_be_left_out_as_lone(sample)) {
      --check.samples;
      ++check.void_samples;
      ++check.lone_samples;
    } else if (sample.is_void ? !f.in_closed_void : !f.in_closed_surface) {
      judge_class(box, sample, allowed, check);
    } else if (!sample.is_void) {
      check.worst_error = std::max(check.worst_error, f.residual);
      if (f.residual > allowed) {
        fault(&check, "the sample at " + place_text(sample.x, sample.y) + " is off by " +
                          short_number(f.residual) + ", more than the certified " +
                          short_number(allowed) +
                          (f.in_closed_void ? " (on an edge beside a void)" : ""));
      }
    }
  }
}

/// A file that left detail out does not have its lone points any more, so drop_lone_points() does not
/// see them. The points around decide: all within four times the longest edge.
bool Verifier::may_be_left_out_as_lone(const SourceSample& sample) {
  if (!choices_.max_edge || facts_.base_error == 0 || source_.lines() != nullptr) return false;
  const GroundSteps steps = ground_steps(facts_.map, ground_, static_cast<double>(sample.y));
  const double reach = 4.0 * *choices_.max_edge / std::min(steps.x, steps.y);
  const GridPoint p{sample.x, sample.y};
  const SampleWindow around = source_.read(
      widened(box_of(p), static_cast<std::int64_t>(std::min(std::ceil(reach), double{kGridMax}))));
  return is_lone_point(p, around.samples,
                       [this](GridPoint a, GridPoint b) { return is_too_long(a, b); });
}

void Verifier::judge_class(const GridBox& box, const SourceSample& sample, double allowed,
                           ToleranceCheck& check) {
  const double moved = border_moves(allowed);
  if (border_ &&
      (!reaches(box, moved) || std::isfinite(border_->distance(sample.x, sample.y, moved)))) {
    ++check.reclassified;
    return;
  }
  fault(&check, std::string("the sample at ") + place_text(sample.x, sample.y) + " has " +
                    (sample.is_void ? "no height" : "a height") +
                    " and the TIN says otherwise, though it is farther than " +
                    short_number(moved) + " from the border of its void");
}

/// Whether the border of the TIN at a tolerance is near that of the source, and the other way round.
void Verifier::judge_border(const GridBox& box, double allowed, ToleranceCheck& check) {
  const GridBox around = widened(box, margin_of(box));
  const BorderLines coarse(border_of_tin(refined_in(around, check.tolerance).tin),
                           least_steps(around));
  judge_lines(*border_, coarse, box, allowed, "the border of the source", check);
  judge_lines(coarse, *border_, box, allowed, "the border of the TIN", check);
}

void Verifier::judge_lines(const BorderLines& from, const BorderLines& to, const GridBox& box,
                           double allowed, const char* what, ToleranceCheck& check) {
  const double moved = border_moves(allowed);
  if (!reaches(box, moved)) return;
  const GroundSteps steps = least_steps(box);
  for (const auto& [a, b] : from.lines()) {
    const double length = std::hypot((static_cast<double>(b.x) - a.x) * steps.x,
                                     (static_cast<double>(b.y) - a.y) * steps.y);
    const int points = static_cast<int>(std::clamp(std::ceil(4.0 * length / moved), 8.0, 128.0));
    for (int i = 0; i <= points; ++i) {
      const double t = static_cast<double>(i) / points;
      const double x = a.x + (static_cast<double>(b.x) - a.x) * t;
      const double y = a.y + (static_cast<double>(b.y) - a.y) * t;
      if (x < box.min_x || x > box.max_x || y < box.min_y || y > box.max_y) continue;
      const double distance = to.distance(x, y, moved);
      if (std::isfinite(distance)) {
        check.worst_border_move = std::max(check.worst_border_move, distance);
        continue;
      }
      fault(&check, std::string(what) + " at " + place_text(x, y) + " is farther than " +
                        short_number(moved) + " from that of the other");
    }
  }
}

/// Points anywhere in a box, with the heights of the full TIN; by y.
std::vector<SurfacePoint> Verifier::random_points(const GridBox& box) {
  if (box.max_x <= box.min_x || box.max_y <= box.min_y) return {};
  std::uniform_real_distribution<double> x(box.min_x, box.max_x);
  std::uniform_real_distribution<double> y(box.min_y, box.max_y);
  std::vector<SurfacePoint> points(options_.random_points);
  for (SurfacePoint& p : points) {
    p.x = x(random_);
    p.y = y(random_);
  }
  std::sort(points.begin(), points.end(),
            [](const SurfacePoint& a, const SurfacePoint& b) { return a.y < b.y; });
  const std::vector<double> full =
      heights_at(refined_in(box, std::nullopt).tin, facts_.heights, points, 0.0);
  for (std::size_t i = 0; i < points.size(); ++i) points[i].height = full[i];
  return points;
}

/// Whether a TIN is near enough to lines, at points that it takes for surface.
void Verifier::judge_lines_of(const Tin& tin, const std::vector<SurfacePoint>& points,
                              double allowed, ToleranceCheck& check) {
  constexpr double kWider = 1e-7;
  const double rounding = 1e-9 + 1e3 * slack_;  // points on an edge are beside it in doubles
  const std::vector<double> heights = heights_at(tin, facts_.heights, points, kWider);
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (std::isnan(heights[i])) continue;  // void in this TIN
    const double distance = std::max(0.0, std::abs(heights[i] - points[i].height) - rounding);
    check.worst_breakline_error = std::max(check.worst_breakline_error, distance);
    if (distance > allowed) {
      fault(&check, "the breakline at " + place_text(points[i].x, points[i].y) + " is off by " +
                        short_number(distance) + ", more than the certified " +
                        short_number(allowed));
    }
  }
}

void Verifier::judge_random_points(const GridBox& box, const std::vector<SurfacePoint>& points,
                                   const RefinedTin& refined, double allowed,
                                   ToleranceCheck& check) {
  const double moved = border_moves(allowed);
  const std::vector<double> coarse = heights_at(refined.tin, facts_.heights, points, 0.0);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const SurfacePoint& p = points[i];
    if (std::isnan(p.height) != std::isnan(coarse[i]) && border_ && reaches(box, moved) &&
        !std::isfinite(border_->distance(p.x, p.y, moved))) {
      fault(&check, "at " + place_text(p.x, p.y) + " surface and void are exchanged, " +
                        "farther than " + short_number(moved) + " from the border");
    }
    const double deviation = std::abs(p.height - coarse[i]);
    if (std::isnan(deviation)) continue;  // Void in one of the two TINs.
    check.worst_deviation = std::max(check.worst_deviation, deviation);
    if (deviation > refined.certified_deviation + slack_) {
      fault(&check, "at " + place_text(p.x, p.y) + " it deviates by " + short_number(deviation) +
                        " from the full TIN, more than the certified " +
                        short_number(refined.certified_deviation));
    }
  }
}

}  // namespace

AgainstReport verify_against(const Terrain& terrain, SourceSamples& source,
                             const AgainstOptions& options) {
  return Verifier(terrain, source, options).run();
}

}  // namespace ptin::tools
