// SPDX-License-Identifier: GPL-3.0-or-later
//
// Reading a source of points: a portion at a time, by any process, and what all portions are together.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <mutex>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "engine/construct/grid/left_out.h"
#include "engine/construct/grid/point_classes.h"
#include "engine/construct/grid/point_grid.h"
#include "engine/construct/grid/source_options.h"
#include "engine/construct/grid/source_point.h"
#include "engine/construct/grid/source_warning.h"
#include "engine/construct/grid/warnings_file.h"
#include "engine/construct/points/point_files.h"
#include "engine/construct/points/point_portions.h"
#include "engine/construct/read/point_part.h"
#include "engine/construct/scratch/array_file.h"
#include "engine/construct/tasks/task.h"

namespace ptin {

/// Where a point of a source lies: one of a few, evenly spread over the order of the source.
struct SampledPoint {
  std::int64_t x = 0, y = 0;  ///< The mantissas of its coordinates.
  std::int32_t x_decimals = 0, y_decimals = 0;
};

/// Every k-th of some points, for the least power of two k that makes them few. Memory: kMost points.
class EvenSample {
 public:
  static constexpr std::size_t kMost = 1024;
  void add(const SourcePoint& p);
  [[nodiscard]] const std::vector<SampledPoint>& points() const noexcept { return points_; }
  /// k: how many points each one stands for.
  [[nodiscard]] std::uint64_t step() const noexcept { return step_; }

 private:
  std::vector<SampledPoint> points_;
  std::uint64_t seen_ = 0, step_ = 1;
};

/// What one portion is, when it has been read.
struct PortionRead {
  PointStreamFacts source;
  PointExtent extent;        ///< Extent of the wanted points.
  LeftOutPoints left_out{};  ///< By the stream, or since they are not wanted.
  PointClasses classes{};    ///< All points of the stream.
  std::optional<RowsOfPart> rows;
  SourceWarnings warnings;  ///< Those of PointStream::warnings().
  std::vector<SampledPoint> samples;
  std::uint64_t sample_step = 1;
  ArrayFileFacts spool;  ///< The file of its points.
};
template <class File, MaybeConst<PortionRead> Read>
void serialize(File& file, Read& r) {
  file.values(r.source.crs, r.source.vertical_crs, r.source.units.plane, r.source.units.heights,
              r.source.plan_decimals, r.source.height_decimals, r.source.lattice, r.extent,
              r.left_out, r.classes, r.rows, r.warnings, r.samples, r.sample_step, r.spool);
}

/// The portions of one stage of reading.
struct ReadingPlan {
  std::uint64_t first_number = 0;  ///< Number of the file that the first of them is written to.
  std::vector<PointPortion> portions;
};
template <class File, MaybeConst<ReadingPlan> Plan>
void serialize(File& file, Plan& p) {
  file.values(p.first_number, p.portions);
}

/// Reads portions of a source. Threads: any number.
class PortionReader {
 public:
  /// All must outlive this.
  PortionReader(const std::vector<std::string>& inputs, const SourceOptions& options,
                const PointFiles& files)
      : inputs_(inputs), options_(options), files_(files) {}

  /// Reads a portion, and writes the wanted points to the spool of this number, and what it is to the
  /// file beside it.
  /// @return  The facts of that file; none where the portion has quotes (QuotesInPart).
  /// @throws Error as open_point_stream(), PointStream, resource_exhausted, io_error, cancelled
  [[nodiscard]] std::optional<ArrayFileFacts> read(const PointPortion& portion,
                                                   std::uint64_t number, const Task& task);

 private:
  [[nodiscard]] PortionRead read_to_spool(const PointPortion& portion, std::uint64_t number,
                                          const Task& task);

  const std::vector<std::string>& inputs_;
  const SourceOptions& options_;
  const PointFiles& files_;
  std::mutex one_tin_;  ///< TINs are sorted one at a time: so much disk is planned for.
};

/// A portion that was read, and where it is.
struct SpooledPortion {
  PointPortion portion;
  std::uint64_t number = 0;
  ArrayFileFacts facts;
};

/// What is known when the last point has been read.
struct PointReading {
  std::string crs{};           ///< The CRS that all files declare; "" where a_srs replaces it.
  std::string vertical_crs{};  ///< Likewise.
  DeclaredUnits units{};       ///< Those of all files.
  std::string crs_path{};      ///< The file that declared these first.
  PointGridScan scan;          ///< What all points and files say.
  LeftOutPoints left_out{};
  PointClasses classes{};
  std::vector<std::uint64_t> empty_inputs{};  ///< The numbers of those that have no point at all.
  SourceWarnings warnings{};                  ///< Warnings of all portions.
  struct Spool {
    std::uint64_t number = 0;
    std::uint64_t points = 0;
    ArrayFileFacts facts;
  };
  std::vector<Spool> spools{};  ///< In the order of the source; none is empty.
  struct Sample {
    SampledPoint point;
    std::uint64_t weight = 1;  ///< The points that it stands for.
  };
  std::vector<Sample> samples{};
};

/// Joins portions, which are in the order of the inputs.
/// @throws Error  corruption; invalid_argument  as PointSource, of what only all portions together show
[[nodiscard]] PointReading join_portions(const std::vector<std::string>& inputs,
                                         const SourceOptions& options, const PointFiles& files,
                                         const std::vector<SpooledPortion>& portions);

/// The grid of all points, and of the lines where there are any.
/// @throws Error invalid_argument  as PointSource::sort()
[[nodiscard]] PointGrid grid_with_lines(const PointReading& reading, const SourceOptions& options);

}  // namespace ptin
