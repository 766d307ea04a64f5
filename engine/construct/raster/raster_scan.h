// SPDX-License-Identifier: GPL-3.0-or-later
//
// The first reading of a raster: how many of its samples have a height, and which encoding holds the
// heights.
#pragma once

#include <cstdint>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "engine/construct/grid/height_fit.h"
#include "engine/construct/raster/raster_mosaic.h"
#include "engine/construct/raster/raster_suspects.h"
#include "engine/construct/tasks/task_schedule.h"

namespace ptin {

/// Looks at all samples once, in tasks: bands of so many samples or a few more, from the north. Which
/// bands there are depends on the raster alone, not on who looks at them.
class RasterScan final : public TaskWorker {
 public:
  static constexpr std::int64_t kBandSamples = std::int64_t{1} << 22;
  explicit RasterScan(RasterMosaic mosaic, std::int64_t band_samples = kBandSamples);

  /// All of them. Their sizes count samples.
  [[nodiscard]] TaskList tasks() const;
  /// @throws Error  as RasterSource::open()
  [[nodiscard]] TaskResult run(const Task& task) override;
  /// The findings of all tasks: the encoding, and values that may stand for no height.
  struct Joined {
    HeightFit fit;
    std::vector<RasterSuspects::Suspect> suspects;
  };
  [[nodiscard]] Joined join(const TaskResults& results) const;

 private:
  struct Found;
  [[nodiscard]] std::int64_t rows_of_band() const;
  [[nodiscard]] SampleRange band(std::size_t number) const;
  template <class T>
  [[nodiscard]] Found scan(RasterMosaic& mosaic, const Task& task) const;
  [[nodiscard]] std::unique_ptr<RasterMosaic> take_mosaic();
  void put_back(std::unique_ptr<RasterMosaic> mosaic);

  std::int64_t band_samples_;
  RasterMosaic mosaic_;                              ///< Never read from: tasks take duplicates.
  RasterShape shape_;                                ///< Shape of its first file.
  SampleRange step_;                                 ///< The size of what is looked at together.
  std::mutex mutex_;                                 ///< Guards the mosaics.
  std::vector<std::unique_ptr<RasterMosaic>> idle_;  ///< Duplicates that no task uses.
};

}  // namespace ptin
