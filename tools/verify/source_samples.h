// SPDX-License-Identifier: GPL-3.0-or-later
//
// The samples of a source on a terrain's grid, for `verify --against`. Points and lines come through
// the builder's readers, rasters through GDAL. Where they lie on the grid, which of them are void or
// left out, and what several on one grid point come to is decided by code that the builder does not
// use.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <stop_token>
#include <string>
#include <utility>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "engine/construct/grid/source_options.h"
#include "engine/construct/read/point_stream.h"
#include "engine/geometry/box.h"
#include "storage/file/external_memory.h"
#include "storage/store_file.h"
#include "tools/verify/line_samples.h"

namespace ptin::tools {

/// Choices of the build that decide which samples there are; from the metadata of the store.
struct SampleChoices {
  PointChoice points;
  PointMerge duplicates = PointMerge::kMean;  ///< How points that fall together are merged.
  std::optional<double> nodata;
  std::optional<double> resolution;  ///< Points: the grid's step in CRS units, if it was chosen.
  /// Samples outside were left out; map units: min x, min y, max x, max y.
  std::optional<std::array<double, 4>> bbox;
  double void_slope = 0.0;  ///< 0: nothing bounds how far the border of voids moves.
  /// Points: triangles with an edge that is longer on the ground are void.
  std::optional<double> max_edge;
};
[[nodiscard]] SampleChoices choices_of(const StoreFile& store);

struct SourceSample {
  std::int32_t x = 0;  ///< Grid.
  std::int32_t y = 0;
  double height = 0.0;  ///< Height's unit.
  bool is_void = false;
  bool is_lone = false;  ///< Has a height, but touches no surface triangle; void.
};

/// The samples of a box, row-major where they form a full grid.
struct SampleWindow {
  GridBox box;
  std::vector<SourceSample> samples;
  bool is_grid = false;  ///< One sample at each grid point of `box`, row 0 in the south.
};

/// The sample at a grid point of the box.  REQUIRES: is_grid
[[nodiscard]] inline const SourceSample& sample_at(const SampleWindow& w, std::int64_t x,
                                                   std::int64_t y) {
  const std::int64_t width = std::int64_t{w.box.max_x} - w.box.min_x + 1;
  return w.samples[static_cast<std::size_t>((y - w.box.min_y) * width + (x - w.box.min_x))];
}

/// The box of a source's outermost samples, in grid units of a terrain that may be another one.
struct SourceExtent {
  double min_x = std::numeric_limits<double>::infinity();
  double min_y = std::numeric_limits<double>::infinity();
  double max_x = -std::numeric_limits<double>::infinity();
  double max_y = -std::numeric_limits<double>::infinity();

  void add(double x, double y) {
    min_x = std::min(min_x, x);
    min_y = std::min(min_y, y);
    max_x = std::max(max_x, x);
    max_y = std::max(max_y, y);
  }
};

/// Refuses a source whose samples do not reach as far as the terrain's, or farther. Where the build
/// left out what lies outside of a box, a source may reach farther.
/// @param paths  The inputs, which the sentence names.
/// @throws Error invalid_argument  not the source of this file; both boxes, in map units
void check_extent(const SourceExtent& extent, const std::vector<std::string>& paths,
                  const StoreFacts& facts, const SampleChoices& choices);
/// Several inputs in a few words: the first one, and how many more there are.
[[nodiscard]] std::string inputs_text(const std::vector<std::string>& paths);

/// Rows of text that are no points.
struct Misfits {
  static constexpr std::size_t kKept = 1000;
  std::vector<std::string> first;  ///< In words, at most kKept.
  std::uint64_t count = 0;

  void add(std::string what) {
    if (count++ < kKept) first.push_back(std::move(what));
  }
};

class SourceSamples {
 public:
  SourceSamples() = default;
  SourceSamples(const SourceSamples&) = delete;
  SourceSamples& operator=(const SourceSamples&) = delete;
  virtual ~SourceSamples() = default;

  /// The samples in the closed box. Grid points of the box outside of every file are void samples.
  /// @throws Error io_error
  [[nodiscard]] virtual SampleWindow read(const GridBox& box) = 0;
  /// How many read() would return.  @throws Error io_error
  [[nodiscard]] virtual std::uint64_t count(const GridBox& box) = 0;
  /// The lines that the source was built with; null where it has none.
  [[nodiscard]] virtual const LineSamples* lines() const { return nullptr; }
  /// Rows of text that are no points.
  [[nodiscard]] const Misfits& misfits() const noexcept { return misfits_; }

 protected:
  Misfits misfits_;
};

/// What reading a source may take. Rasters are read by the window and need none of it.
struct SampleResources {
  ExternalMemory memory;  ///< Points are sorted in it, and in its folder where they do not fit.
  std::stop_token stop;
  LineInputs lines;
};

/// Opens rasters, or points of any kind. Points are read here, once; rasters are read by read().
/// @throws Error not_found, io_error, resource_exhausted (disk full), cancelled; invalid_argument
///               (neither a raster nor points; another grid or another extent than the terrain's,
///               which is no source of it)
[[nodiscard]] std::unique_ptr<SourceSamples> open_samples(const std::vector<std::string>& paths,
                                                          const StoreFile& store,
                                                          const SampleResources& resources);

/// Refuses what is the source of another terrain as far as a short look shows: the grid and the
/// extent of rasters; of points, that none of the first few thousand lies on the terrain. Cheap,
/// whatever the size of the source.
/// @throws Error as open_samples()
void check_is_source(const std::vector<std::string>& paths, const StoreFile& store,
                     const SampleResources& resources);

/// Checks of points what check_is_source() checks of others.
void check_first_points(const std::vector<std::string>& paths, const StoreFile& store,
                        const SampleResources& resources);

/// The two kinds of sources; open_samples() chooses, by the kind that the builder would take the inputs
/// for.
[[nodiscard]] std::unique_ptr<SourceSamples> open_raster_samples(
    const std::vector<std::string>& paths, const StoreFile& store);
[[nodiscard]] std::unique_ptr<SourceSamples> open_point_samples(
    const std::vector<std::string>& paths, const StoreFile& store,
    const SampleResources& resources);

}  // namespace ptin::tools
