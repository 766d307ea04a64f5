// SPDX-License-Identifier: GPL-3.0-or-later
//
// Points for `verify --against`.
#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <optional>

#include "engine/construct/grid/source_point.h"
#include "engine/construct/points/open_points.h"
#include "engine/construct/read/input_kind.h"
#include "engine/error.h"
#include "engine/geometry/point.h"
#include "engine/stop.h"
#include "tools/verify/decimal_steps.h"
#include "tools/verify/sorted_samples.h"
#include "tools/verify/source_samples.h"
#include "tools/verify/text_samples.h"

namespace ptin::tools {

namespace {

bool is_left_out(const std::array<double, 3>& p, const SampleChoices& choices) {
  if (choices.nodata && p[2] == *choices.nodata) return true;
  const auto& box = choices.asked_bbox;
  return box && (p[0] < (*box)[0] || p[1] < (*box)[1] || p[0] > (*box)[2] || p[1] > (*box)[3]);
}

/// True for a file that the reader of text takes: anything that is not known as LAS, a TIN or a
/// layer.
bool is_text(const std::string& path) {
  return point_format_of(path, {}) == PointFormat::kText ||
         kind_of_input(path, {}) == InputKind::kRaster;
}

/// `step` as the number of digits after the point, where it is such a power of ten.
std::optional<int> decimals_of(double step) {
  for (int decimals = 0; decimals <= 17; ++decimals) {
    if (step == 1.0 / std::pow(10.0, decimals)) return decimals;
  }
  return std::nullopt;
}

/// A coordinate rounded to digits after the point, half away from zero, in units of the last one;
/// by its digits, since in the middle of two steps a double lies on one side of it by chance.
double rounded_digits(double value, int decimals) {
  std::array<char, 400> text{};
  const auto end = std::to_chars(text.data(), text.data() + text.size(), std::abs(value),
                                 std::chars_format::fixed)
                       .ptr;
  const std::string digits(text.data(), end);
  const std::size_t point = std::min(digits.find('.'), digits.size());
  double whole = 0.0;
  const auto digit = [&](std::size_t i) { return i < digits.size() ? digits[i] - '0' : 0; };
  for (std::size_t i = 0; i < point; ++i) whole = whole * 10 + digit(i);
  const auto behind = static_cast<std::size_t>(decimals);
  for (std::size_t i = 1; i <= behind; ++i) whole = whole * 10 + digit(point + i);
  whole += digit(point + behind + 1) >= 5 ? 1.0 : 0.0;
  return value < 0.0 ? -whole : whole;
}

/// The grid step of a coordinate that lies `steps` from the origin. Where the grid is one of decimals,
/// digits beyond them were dropped.
double step_of(double value, double steps, double origin, double step) {
  constexpr double kUnsure = 0.07;  // a double is off by a sixteenth of a step at most
  const bool is_in_middle = std::abs(std::abs(steps - std::round(steps)) - 0.5) < kUnsure;
  if (!is_in_middle) return std::round(steps);
  const std::optional<int> decimals = decimals_of(step);
  if (!decimals) return std::round(steps);
  const double first = rounded_digits(origin, *decimals);
  constexpr double kOneOfThem = 1e-3;  // else the origin is no such decimal
  if (std::abs(origin / step - first) > kOneOfThem * std::max(1.0, std::abs(first) * 1e-10))
    return std::round(steps);
  return rounded_digits(value, *decimals) - first;
}

/// Where a position lies on the grid of a terrain. A step that was chosen counts from 0, not from the
/// grid's origin: that decides where a position in the middle between two grid points goes.
MapPoint grid_point_of(MapPoint p, const StoreFacts& facts, const SampleChoices& choices) {
  const AffineMap& map = facts.map;
  if (choices.resolution) {
    const double step = *choices.resolution;
    return {std::round(p.x / step) - std::round(map.origin_x / step),
            std::round(p.y / step) - std::round(map.origin_y / step)};
  }
  const MapPoint grid = map.to_grid(p);
  return {step_of(p.x, grid.x, map.origin_x, map.step_x),
          step_of(p.y, grid.y, map.origin_y, map.step_y)};
}

class PointSamples final : public SourceSamples {
 public:
  PointSamples(const std::vector<std::string>& paths, const StoreFile& store,
               const SampleResources& resources)
      : facts_(store.facts()),
        choices_(choices_of(store)),
        lines_(resources.lines, store, resources.stop),
        samples_(facts_, resources.memory, choices_.duplicates) {
    for (const std::string& path : paths) {
      if (is_text(path) && choices_.points.z_field.empty() && choices_.points.layer.empty()) {
        read_text(path, resources.stop);
      } else {
        read_stream(path, resources);
      }
    }
    lines_.finish();
    for (const auto& [key, height] : lines_.vertices()) add_sample(point_of(key), height);
    // Where a boundary without heights meets the surface, the terrain has vertices that no input has.
    if (!lines_.is_flat()) check_extent(extent_, paths, facts_, choices_);
    samples_.sort(resources.stop);
  }

  [[nodiscard]] const LineSamples* lines() const override {
    return lines_.is_empty() ? nullptr : &lines_;
  }
  [[nodiscard]] std::uint64_t count(const GridBox& box) override { return samples_.count(box); }
  [[nodiscard]] SampleWindow read(const GridBox& box) override {
    SampleWindow window;
    window.box = box;
    window.samples = samples_.read(box);
    std::sort(window.samples.begin(), window.samples.end(),
              [](const SourceSample& a, const SourceSample& b) {
                return a.y != b.y ? a.y < b.y : a.x < b.x;
              });
    return window;
  }

 private:
  void read_text(const std::string& path, const std::stop_token& stop);
  void read_stream(const std::string& path, const SampleResources& resources);
  /// @param grid  Where `p` lies on the grid, rounded.
  void add(const std::array<double, 3>& p, MapPoint grid);
  void add_sample(GridPoint p, double height);

  const StoreFacts& facts_;
  SampleChoices choices_;
  SourceExtent extent_;
  LineSamples lines_;
  SortedSamples samples_;
};

void PointSamples::read_text(const std::string& path, const std::stop_token& stop) {
  constexpr std::uint64_t kLinesBetweenLooks = 4096;
  TextSamples text(path, choices_.points.columns, choices_.nodata.has_value());
  TextSamples::Line line;
  std::uint64_t lines = 0;
  while (text.next(line)) {
    if (lines++ % kLinesBetweenLooks == 0) stop_if_asked(stop, "verification");
    if (line.misfit.empty()) {
      add(line.point, grid_point_of({line.point[0], line.point[1]}, facts_, choices_));
    } else if (!choices_.points.skip_invalid) {
      misfits_.add(path + ":" + std::to_string(line.number) + ": " + line.misfit);
    }
  }
  if (lines == 0) {
    throw Error(ErrorCode::invalid_argument,
                "neither a raster that GDAL reads nor points as lines of x y z", path);
  }
}

void PointSamples::read_stream(const std::string& path, const SampleResources& resources) {
  const auto stream = open_point_stream(path, choices_.points, choices_.nodata,
                                        {&resources.memory, resources.stop, {}});
  const AffineMap& map = facts_.map;
  std::vector<SourcePoint> batch;
  while (stream->next(batch)) {
    stop_if_asked(resources.stop, "verification");
    for (const SourcePoint& p : batch) {
      const std::array<double, 3> place{to_double(p.x), to_double(p.y), to_double(p.z)};
      add(place, choices_.resolution ? grid_point_of({place[0], place[1]}, facts_, choices_)
                                     : MapPoint{steps_of(p.x, map.origin_x, map.step_x),
                                                steps_of(p.y, map.origin_y, map.step_y)});
    }
  }
}

void PointSamples::add(const std::array<double, 3>& p, MapPoint grid) {
  if (is_left_out(p, choices_)) return;
  const GridBox& b = facts_.bounds;
  if (grid.x < b.min_x || grid.x > b.max_x || grid.y < b.min_y || grid.y > b.max_y) {
    if (!lines_.has_boundary()) extent_.add(grid.x, grid.y);
    return;  // outside of a boundary that reaches no farther, or of another terrain
  }
  const GridPoint place{static_cast<std::int32_t>(grid.x), static_cast<std::int32_t>(grid.y)};
  if (!lines_.is_empty()) {
    // A line's height stands where a point falls on its vertex.
    if (lines_.vertices().contains(key_of(place)) || !lines_.holds(place)) return;
    lines_.divide_at(place);
  }
  add_sample(place, p[2]);
}

void PointSamples::add_sample(GridPoint p, double height) {
  extent_.add(p.x, p.y);
  if (contains(facts_.bounds, p)) samples_.add(p, height);
}

/// The first points of an input: enough to see that it is the source of another terrain.
class FirstPoints {
 public:
  FirstPoints(const std::string& path, const StoreFile& store, const SampleResources& resources)
      : facts_(store.facts()), choices_(choices_of(store)) {
    if (is_text(path) && choices_.points.z_field.empty() && choices_.points.layer.empty()) {
      TextSamples text(path, choices_.points.columns, choices_.nodata.has_value());
      TextSamples::Line line;
      for (int lines = 0; lines < kMost && text.next(line); ++lines) {
        if (line.misfit.empty()) add(line.point);
      }
      return;
    }
    const auto stream = open_point_stream(path, choices_.points, choices_.nodata,
                                          {&resources.memory, resources.stop, {}});
    std::vector<SourcePoint> batch;
    while (seen_ < kMost && stream->next(batch)) {
      for (const SourcePoint& p : batch) add({to_double(p.x), to_double(p.y), to_double(p.z)});
    }
  }
  void check(const std::vector<std::string>& paths) const {
    if (seen_ > 0 && !meets_) check_extent(extent_, paths, facts_, choices_);
  }

 private:
  static constexpr int kMost = 4096;

  void add(const std::array<double, 3>& p) {
    if (is_left_out(p, choices_)) return;
    ++seen_;
    const MapPoint grid = grid_point_of({p[0], p[1]}, facts_, choices_);
    extent_.add(grid.x, grid.y);
    const GridBox& b = facts_.bounds;
    meets_ = meets_ ||
             (grid.x >= b.min_x && grid.x <= b.max_x && grid.y >= b.min_y && grid.y <= b.max_y);
  }

  const StoreFacts& facts_;
  SampleChoices choices_;
  SourceExtent extent_;
  int seen_ = 0;
  bool meets_ = false;
};

}  // namespace

void check_first_points(const std::vector<std::string>& paths, const StoreFile& store,
                        const SampleResources& resources) {
  // Points that lie outside of a boundary are dropped, however many come first.
  if (!resources.lines.is_empty()) return;
  FirstPoints(paths.front(), store, resources).check(paths);
}

std::unique_ptr<SourceSamples> open_point_samples(const std::vector<std::string>& paths,
                                                  const StoreFile& store,
                                                  const SampleResources& resources) {
  return std::make_unique<PointSamples>(paths, store, resources);
}

}  // namespace ptin::tools
