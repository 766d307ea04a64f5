// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/raster/raster_scan.h"

#include <algorithm>
#include <limits>
#include <span>
#include <type_traits>
#include <utility>

#include "engine/construct/tasks/value_text.h"
#include "engine/stop.h"

namespace ptin {
namespace {

/// About how many samples are looked at together.
constexpr std::int64_t kStepSamples = std::int64_t{1} << 20;

/// Whole rows where the blocks of the file are whole rows, else a few blocks side by side.
SampleRange step_of(const RasterShape& shape, std::int64_t width, std::int64_t samples) {
  const auto [block_width, block_height] = shape.block;
  const std::int64_t columns =
      block_width >= shape.width
          ? width
          : std::min<std::int64_t>(width,
                                   std::max<std::int64_t>(4096 / block_width, 1) * block_width);
  const std::int64_t rows = std::max<std::int64_t>(samples / columns, 1);
  return {0, 0, columns, rows > block_height ? rows / block_height * block_height : rows};
}

HeightScan::Given given(RawType raw) {
  return raw == RawType::kFloat32 ? HeightScan::Given::kFloat32 : HeightScan::Given::kFloat64;
}

}  // namespace

/// Facts of the samples of a band: a plain value, without a byte that means nothing.
struct RasterScan::Found {
  HeightScan heights;  ///< Heights of rasters that do not hold whole codes.
  std::int64_t low = std::numeric_limits<std::int64_t>::max();  ///< The least whole code.
  std::int64_t high = std::numeric_limits<std::int64_t>::min();
  std::uint64_t codes = 0;  ///< Their number.
  RasterSuspects suspects{};
};

RasterScan::RasterScan(RasterMosaic mosaic, std::int64_t band_samples)
    : band_samples_(band_samples),
      mosaic_(std::move(mosaic)),
      shape_(mosaic_.first()),
      step_(step_of(shape_, mosaic_.width(), std::min(kStepSamples, band_samples))) {}

std::int64_t RasterScan::rows_of_band() const {
  const std::int64_t steps =
      band_samples_ / std::max<std::int64_t>(mosaic_.width() * step_.height, 1);
  return std::max<std::int64_t>(steps, 1) * step_.height;
}

SampleRange RasterScan::band(std::size_t number) const {
  const std::int64_t north = mosaic_.height() - static_cast<std::int64_t>(number) * rows_of_band();
  const std::int64_t south = std::max<std::int64_t>(north - rows_of_band(), 0);
  return {0, south, mosaic_.width(), north - south};
}

TaskList RasterScan::tasks() const {
  const std::int64_t rows = rows_of_band();
  std::vector<std::uint64_t> sizes;
  for (std::int64_t i = 0; i < (mosaic_.height() + rows - 1) / rows; ++i) {
    sizes.push_back(band(static_cast<std::size_t>(i)).samples());
  }
  // The values of a step, of at most eight bytes, and whether each is one; where rasters are laid over
  // one another those of one of them besides; and a mask.
  return {TaskKind::kScan, std::move(sizes), (2 * (8 + 1) + 1) * step_.samples()};
}

template <class T>
RasterScan::Found RasterScan::scan(RasterMosaic& mosaic, const Task& task) const {
  Found found{.heights = HeightScan(given(shape_.raw))};
  const SampleRange whole = band(number_of(task.name));
  std::vector<T> values(
      static_cast<std::size_t>(step_.width * std::min(step_.height, whole.height)));
  std::vector<std::uint8_t> valid(values.size());
  std::uint64_t done = 0;
  for (std::int64_t north = whole.y0 + whole.height; north > whole.y0; north -= step_.height) {
    for (std::int64_t x = 0; x < whole.width; x += step_.width) {
      stop_if_asked(task.stop, "reading", mosaic.context());
      const std::int64_t south = std::max(north - step_.height, whole.y0);
      const SampleRange w{x, south, std::min(step_.width, whole.width - x), north - south};
      const auto n = static_cast<std::size_t>(w.width * w.height);
      mosaic.read<T>(w, std::span(values).first(n), std::span(valid).first(n));
      T low = std::numeric_limits<T>::max(), high = std::numeric_limits<T>::lowest();
      for (std::size_t i = 0; i < n; ++i) {
        low = valid[i] ? std::min(low, values[i]) : low;
        high = valid[i] ? std::max(high, values[i]) : high;
        found.codes += valid[i];
        if constexpr (!std::is_integral_v<T>) {
          if (valid[i]) {
            found.heights.add(shape_.offset + shape_.scale * static_cast<double>(values[i]));
          }
        }
      }
      if (low <= high) {
        if constexpr (std::is_integral_v<T>) {
          found.low = std::min<std::int64_t>(found.low, low);
          found.high = std::max<std::int64_t>(found.high, high);
        }
        found.suspects.add<T>(
            std::span(values).first(n), std::span(valid).first(n), static_cast<double>(low),
            static_cast<double>(high), [&](std::size_t i) {
              const auto column = w.x0 + static_cast<std::int64_t>(i) % w.width;
              const auto row = mosaic.height() - 1 - w.y0 - static_cast<std::int64_t>(i) / w.width;
              return static_cast<std::uint64_t>(row * mosaic.width() + column);
            });
      }
      done += n;
      task.tell(done);
    }
  }
  return found;
}

std::unique_ptr<RasterMosaic> RasterScan::take_mosaic() {
  const std::lock_guard lock(mutex_);
  if (idle_.empty()) {
    return std::make_unique<RasterMosaic>(mosaic_.duplicate());
  }
  std::unique_ptr<RasterMosaic> mosaic = std::move(idle_.back());
  idle_.pop_back();
  return mosaic;
}

void RasterScan::put_back(std::unique_ptr<RasterMosaic> mosaic) {
  const std::lock_guard lock(mutex_);
  idle_.push_back(std::move(mosaic));
}

TaskResult RasterScan::run(const Task& task) {
  std::unique_ptr<RasterMosaic> mosaic = take_mosaic();
  const Found found = shape_.raw == RawType::kInt32     ? scan<std::int32_t>(*mosaic, task)
                      : shape_.raw == RawType::kFloat32 ? scan<float>(*mosaic, task)
                                                        : scan<double>(*mosaic, task);
  put_back(std::move(mosaic));
  TaskResult result;
  result.told = text_of_value(found);
  return result;
}

RasterScan::Joined RasterScan::join(const TaskResults& results) const {
  Found all{.heights = HeightScan(given(shape_.raw))};
  for (const auto& [name, result] : results) {
    const auto found = value_in_text<Found>(result.told);
    all.heights.join(found.heights);
    all.suspects.join(found.suspects);
    all.low = std::min(all.low, found.low);
    all.high = std::max(all.high, found.high);
    all.codes += found.codes;
  }
  if (shape_.raw != RawType::kInt32) {
    return {all.heights.fit(), all.suspects.apart()};
  }
  const HeightEncoding encoding{HeightType::int32, shape_.scale, shape_.offset};
  HeightFit fit{encoding, shape_.scale, 0.0, 0.0, -1.0, all.codes};
  if (all.codes > 0) {
    fit.min_height = encoding.height_of_code(static_cast<double>(all.low));
    fit.max_height = encoding.height_of_code(static_cast<double>(all.high));
  }
  return {fit, all.suspects.apart()};
}

}  // namespace ptin
