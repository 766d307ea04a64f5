// SPDX-License-Identifier: GPL-3.0-or-later
//
// Points for `verify --against`. The builder's readers hand them out; where they lie on the grid, which
// of them count and what those that fall together come to is decided here.
#include <algorithm>

#include "engine/construct/grid/source_point.h"
#include "engine/construct/points/open_points.h"
#include "engine/error.h"
#include "engine/geometry/point.h"
#include "engine/stop.h"
#include "tools/verify/decimal_steps.h"
#include "tools/verify/sorted_samples.h"
#include "tools/verify/source_samples.h"

namespace ptin::tools {

namespace {

std::unique_ptr<PointStream> open_stream(const std::string& path, const SampleChoices& choices,
                                         const SampleResources& resources,
                                         TakeInvalidRow invalid_row) {
  return open_point_stream(path, choices.points, choices.nodata,
                           {&resources.memory, resources.stop, {}, std::move(invalid_row)});
}

bool is_left_out(const SourcePoint& p, const SampleChoices& choices) {
  if (choices.nodata && to_double(p.z) == *choices.nodata) return true;
  const double x = to_double(p.x), y = to_double(p.y);
  const auto& box = choices.bbox;
  return box && (x < (*box)[0] || y < (*box)[1] || x > (*box)[2] || y > (*box)[3]);
}

bool is_within(const GridBox& b, MapPoint grid) {
  return grid.x >= b.min_x && grid.x <= b.max_x && grid.y >= b.min_y && grid.y <= b.max_y;
}

class PointSamples final : public SourceSamples {
 public:
  PointSamples(const std::vector<std::string>& paths, const StoreFile& store,
               const SampleResources& resources)
      : facts_(store.facts()),
        choices_(choices_of(store)),
        lines_(resources.lines, store, choices_.resolution, resources.stop),
        samples_(facts_, resources.memory, choices_.duplicates) {
    for (const std::string& path : paths) read(path, resources);
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
  void read(const std::string& path, const SampleResources& resources);
  void add(const SourcePoint& p);
  void add_sample(GridPoint p, double height);

  const StoreFacts& facts_;
  SampleChoices choices_;
  SourceExtent extent_;
  LineSamples lines_;
  SortedSamples samples_;
};

void PointSamples::read(const std::string& path, const SampleResources& resources) {
  const auto note_misfit = [&](std::uint64_t line, const std::string& fault) {
    if (!choices_.points.skip_invalid)
      misfits_.add(path + ":" + std::to_string(line) + ": " + fault);
  };
  const auto stream = open_stream(path, choices_, resources, note_misfit);
  std::vector<SourcePoint> batch;
  while (stream->next(batch)) {
    stop_if_asked(resources.stop, "verification");
    for (const SourcePoint& p : batch) add(p);
  }
}

void PointSamples::add(const SourcePoint& p) {
  if (is_left_out(p, choices_)) return;
  const MapPoint grid = grid_position(p, facts_.map, choices_.resolution);
  if (!is_within(facts_.bounds, grid)) {
    if (!lines_.has_boundary()) extent_.add(grid.x, grid.y);
    return;  // outside of a boundary that reaches no farther, or of another terrain
  }
  const GridPoint place{static_cast<std::int32_t>(grid.x), static_cast<std::int32_t>(grid.y)};
  if (!lines_.is_empty()) {
    // A line's height stands where a point falls on its vertex.
    if (lines_.vertices().contains(key_of(place)) || !lines_.holds(place)) return;
    lines_.divide_at(place);
  }
  add_sample(place, to_double(p.z));
}

void PointSamples::add_sample(GridPoint p, double height) {
  extent_.add(p.x, p.y);
  if (contains(facts_.bounds, p)) samples_.add(p, height);
}

}  // namespace

void check_first_points(const std::vector<std::string>& paths, const StoreFile& store,
                        const SampleResources& resources) {
  // Points that lie outside of a boundary are dropped, however many come first.
  if (!resources.lines.is_empty()) return;
  constexpr int kMost = 4096;
  const StoreFacts& facts = store.facts();
  const SampleChoices choices = choices_of(store);
  const auto pass_over = [](std::uint64_t, const std::string&) {};
  const auto stream = open_stream(paths.front(), choices, resources, pass_over);
  SourceExtent extent;
  std::vector<SourcePoint> batch;
  for (int seen = 0; seen < kMost && stream->next(batch);) {
    for (const SourcePoint& p : batch) {
      if (is_left_out(p, choices)) continue;
      const MapPoint grid = grid_position(p, facts.map, choices.resolution);
      if (is_within(facts.bounds, grid)) return;
      extent.add(grid.x, grid.y);
      ++seen;
    }
  }
  const bool has_points = extent.min_x <= extent.max_x;
  if (has_points) check_extent(extent, paths, facts, choices);
}

std::unique_ptr<SourceSamples> open_point_samples(const std::vector<std::string>& paths,
                                                  const StoreFile& store,
                                                  const SampleResources& resources) {
  return std::make_unique<PointSamples>(paths, store, resources);
}

}  // namespace ptin::tools
