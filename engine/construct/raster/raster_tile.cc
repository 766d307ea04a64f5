// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/raster/raster_tile.h"

#include <algorithm>
#include <functional>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "engine/construct/grid/crs.h"
#include "engine/construct/raster/raster_surface.h"
#include "engine/construct/tile/border_witnesses.h"
#include "engine/construct/tile/part_surface.h"
#include "engine/mesh/raster_tin.h"

namespace ptin {

namespace {

/// How far around a window the border between surface and void is looked for, so that what lies
/// close to the window's seams knows of a border beyond. Whether the last of these samples are lone,
/// the cells around them decide: hence one more.
constexpr std::int64_t kMargin = 32 + 1;
/// Depths beyond so many samples count as infinite.
constexpr double kFarthest = 64.0;

template <class T>
std::vector<T> cut_out(std::vector<T>& from, const SampleRange& outer, const SampleRange& inner) {
  if (outer.width == inner.width && outer.height == inner.height) {
    return std::move(from);
  }
  std::vector<T> part(static_cast<std::size_t>(inner.width * inner.height));
  for (std::int64_t y = 0; y < inner.height; ++y) {
    const auto* row = from.data() + (inner.y0 - outer.y0 + y) * outer.width + (inner.x0 - outer.x0);
    std::copy_n(row, inner.width, part.data() + y * inner.width);
  }
  return part;
}

/// A window within another one, and the triangles of make_raster_tin() in both.
class InnerWindow {
 public:
  InnerWindow(const SampleRange& outer, const SampleRange& inner) : outer_(outer), inner_(inner) {}

  /// The place in the outer window of sample `i` of the inner one.
  [[nodiscard]] std::size_t outer_sample(std::size_t i) const {
    const auto x = static_cast<std::int64_t>(i) % inner_.width;
    const auto y = static_cast<std::int64_t>(i) / inner_.width;
    return static_cast<std::size_t>((inner_.y0 - outer_.y0 + y) * outer_.width +
                                    (inner_.x0 - outer_.x0) + x);
  }
  /// The number in the inner window of a triangle of the outer one; kNone when it is not there.
  [[nodiscard]] TriangleId inner_triangle(TriangleId t) const {
    const std::int64_t cell = t / 2;
    const std::int64_t x = cell % (outer_.width - 1) - (inner_.x0 - outer_.x0);
    const std::int64_t y = cell / (outer_.width - 1) - (inner_.y0 - outer_.y0);
    if (x < 0 || y < 0 || x + 1 >= inner_.width || y + 1 >= inner_.height) {
      return kNone;
    }
    return static_cast<TriangleId>(2 * (y * (inner_.width - 1) + x) + t % 2);
  }

 private:
  SampleRange outer_, inner_;
};

GridBox box_of_window(const SampleRange& window) {
  return {static_cast<std::int32_t>(window.x0), static_cast<std::int32_t>(window.y0),
          static_cast<std::int32_t>(window.x0 + window.width - 1),
          static_cast<std::int32_t>(window.y0 + window.height - 1)};
}

/// Whether the raster goes on beyond an edge on the side of a window.
std::function<bool(GridPoint, GridPoint)> goes_on_beyond(const SampleRange& raster,
                                                         const SampleRange& window) {
  const GridBox all = box_of_window(raster), part = box_of_window(window);
  return [=](GridPoint a, GridPoint b) {
    return (a.x == b.x &&
            ((a.x == part.min_x && a.x > all.min_x) || (a.x == part.max_x && a.x < all.max_x))) ||
           (a.y == b.y &&
            ((a.y == part.min_y && a.y > all.min_y) || (a.y == part.max_y && a.y < all.max_y)));
  };
}

/// The witnesses of the inner window, found in the outer one.
BorderWitnesses witnesses_of(const Tin& outer_tin, const RasterSamples& samples,
                             const SampleRange& window) {
  const InnerWindow inner(samples.range, window);
  std::vector<std::uint8_t> is_inner(outer_tin.triangles.size());
  for (TriangleId t = 0; t < is_inner.size(); ++t) {
    is_inner[t] = inner.inner_triangle(t) == kNone ? 0 : 1;
  }
  BorderWitnesses found = find_border_witnesses(
      {outer_tin, goes_on_beyond(samples.raster, samples.range), is_inner, samples.step,
       static_cast<double>(kMargin - 1) * std::min(samples.step.x, samples.step.y),
       kFarthest * std::max(samples.step.x, samples.step.y)});
  const auto own_of = [&]<class T>(const std::vector<T>& all) {
    std::vector<T> own;
    own.reserve(static_cast<std::size_t>(window.samples()));
    for (std::size_t i = 0; i < window.samples(); ++i) {
      own.push_back(all[inner.outer_sample(i)]);
    }
    return own;
  };
  BorderWitnesses own{own_of(found.kind),   own_of(found.nearest), own_of(found.reach),
                      own_of(found.region), own_of(found.doubt),   std::move(found.corners)};
  for (CornerWitness& w : own.corners) {
    w.triangle = inner.inner_triangle(w.triangle);
  }
  return own;
}

/// True when some triangles are surface and some are void.
bool has_border(const Tin& tin) {
  return std::find(tin.classes.begin(), tin.classes.end(), TriangleClass::kSurface) !=
             tin.classes.end() &&
         std::find(tin.classes.begin(), tin.classes.end(), TriangleClass::kVoid) !=
             tin.classes.end();
}

/// Turns lone samples into void ones. Returns how many lie in `window`.
std::uint64_t drop_lone_samples(std::vector<std::uint8_t>& valid, const SampleRange& outer,
                                const SampleRange& window) {
  std::uint64_t dropped = 0;
  for (const std::uint64_t i : find_lone_samples(valid, outer)) {
    valid[i] = 0;
    const std::int64_t x = outer.x0 + static_cast<std::int64_t>(i) % outer.width - window.x0;
    const std::int64_t y = outer.y0 + static_cast<std::int64_t>(i) / outer.width - window.y0;
    dropped += x >= 0 && y >= 0 && x < window.width && y < window.height ? 1 : 0;
  }
  return dropped;
}

}  // namespace

SampleRange range_around(const SampleRange& raster, const SampleRange& window) {
  const std::int64_t x0 = std::max(window.x0 - kMargin, raster.x0);
  const std::int64_t y0 = std::max(window.y0 - kMargin, raster.y0);
  return {x0, y0, std::min(window.x0 + window.width + kMargin, raster.x0 + raster.width) - x0,
          std::min(window.y0 + window.height + kMargin, raster.y0 + raster.height) - y0};
}

StartedTile start_raster_tile(const RasterSource& source, const SampleRange& window,
                              const MeasureUnits& units, bool keep_around) {
  RasterSamples samples;
  samples.raster = {0, 0, source.width(), source.height()};
  samples.has_voids = source.void_samples() != 0;
  samples.keep_around = keep_around;
  samples.range = samples.has_voids || keep_around ? range_around(samples.raster, window) : window;
  const auto n = static_cast<std::size_t>(samples.range.samples());
  samples.heights.resize(n);
  samples.valid.resize(n);
  source.read(samples.range, samples.heights, samples.valid);
  if (samples.has_voids) {
    samples.step = largest_step(GroundMetric(source.frame()), box_of_window(samples.range));
  }
  return start_raster_tile(std::move(samples), window, units);
}

StartedTile start_raster_tile(RasterSamples&& samples, const SampleRange& window,
                              const MeasureUnits& units) {
  StartedTile started;
  started.lone_samples = drop_lone_samples(samples.valid, samples.range, window);
  std::optional<BorderWitnesses> witnesses;
  if (std::find(samples.valid.begin(), samples.valid.end(), 0) != samples.valid.end()) {
    const Tin around =
        make_raster_tin(samples.heights, samples.valid, samples.range, units.heights);
    if (has_border(around)) {
      witnesses = witnesses_of(around, samples, window);
    }
  }
  if (samples.keep_around) {
    started.around = {box_of_window(samples.range), samples.heights, samples.valid};
  }
  std::vector<HeightBits> heights = cut_out(samples.heights, samples.range, window);
  std::vector<std::uint8_t> valid = cut_out(samples.valid, samples.range, window);
  started.box = box_of_window(window);
  started.tile.units = units;
  started.tile.samples_fill_grid = true;
  started.tile.tin = make_raster_tin(heights, valid, window, units.heights);
  start_tile(started.tile, witnesses ? &*witnesses : nullptr);
  auto full =
      std::make_unique<RasterSurface>(std::move(heights), std::move(valid), window, units.heights);
  if (witnesses) {
    full->set_border(std::make_unique<PartSurface>(
        started.tile.tin, units.heights,
        PartBorder{std::move(*witnesses), goes_on_beyond(samples.raster, window), samples.step}));
  } else if (samples.has_voids) {
    full->set_far_from_border();
  }
  started.full = std::move(full);
  return started;
}

}  // namespace ptin
