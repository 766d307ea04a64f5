// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/serve/pixel_frame.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "engine/stop.h"
#include "tools/export/pixel_value.h"
#include "tools/export/raster_file.h"
#include "tools/facts/human.h"
#include "tools/http/problem.h"
#include "tools/output/file_name.h"
#include "tools/serve/answer_parts.h"

namespace ptin::serve {

namespace {

using http::Problem;

/// Names of the axis to the east, then those of the axis to the north.
constexpr std::array<std::string_view, 11> kAxisNames = {
    "lon", "long", "longitude", "e", "easting", "x", "lat", "latitude", "n", "northing", "y"};
constexpr std::ptrdiff_t kNamesOfEast = 6;

[[noreturn]] void refuse_axes(std::string_view parameter, std::string_view what) {
  throw Problem(400, std::string(what) +
                         "; a coverage has the axes Lon (or E, x) and Lat (or N, y), each once, as "
                         "Lat(34.34:34.35),Lon(-118.31:-118.3) of subset, Lon(200),Lat(100) of "
                         "scale-size")
      .at(std::string(parameter));
}

/// Row by row as numbers of the raster's type, what they were rounded by told.
template <class T>
void put_heights(std::span<const double> heights, std::int64_t width, std::int64_t stride,
                 double nodata, std::vector<std::byte>& bytes, tools::WrittenRaster& written) {
  const std::span<T> values(reinterpret_cast<T*>(bytes.data()), bytes.size() / sizeof(T));
  std::fill(values.begin(), values.end(), static_cast<T>(nodata));
  for (std::size_t i = 0; i < heights.size(); ++i) {
    if (std::isnan(heights[i])) continue;
    const auto w = static_cast<std::size_t>(width);
    T& value = values[i / w * static_cast<std::size_t>(stride) + i % w];
    value = static_cast<T>(heights[i]);
    written.rounding =
        std::max(written.rounding, std::abs(static_cast<double>(value) - heights[i]));
    ++written.surface_pixels;
  }
}

double rounded_up(double bound, double more) {
  return more == 0 ? bound : std::nextafter(bound + more, HUGE_VAL);
}

void describe_certificate(tools::RasterFile& file, const tools::WrittenRaster& written) {
  const auto text_of_bound = [](double bound) {
    std::string text;
    append_json_number(text, bound);
    return std::isfinite(bound) ? text : std::string("inf");
  };
  file.describe("PTIN_CERTIFIED_ERROR", text_of_bound(written.certified_error));
  file.describe("PTIN_CERTIFIED_DEVIATION", text_of_bound(written.certified_deviation));
  file.describe("PTIN_EXACT", written.exact ? "true" : "false");
}

}  // namespace

std::optional<std::string_view> part_for_axis(std::string_view list, int axis,
                                              std::string_view parameter) {
  std::array<std::optional<std::string_view>, 2> parts;
  for (const std::string_view part : ask::parts_of(list, ',')) {
    const std::string_view text = ask::trimmed(part);
    const std::size_t open = text.find('(');
    if (open == std::string_view::npos || !text.ends_with(')')) {
      refuse_axes(parameter, "\"" + tools::shown(text) + "\" is no axis with its values");
    }
    const std::string name = tools::lower_case(std::string(ask::trimmed(text.substr(0, open))));
    const auto known = std::ranges::find(kAxisNames, name);
    const std::size_t which = known - kAxisNames.begin() < kNamesOfEast ? 0 : 1;
    if (known == kAxisNames.end() || parts[which]) {
      refuse_axes(parameter,
                  "the axis \"" + tools::shown(name) + "\" is not there, or comes twice");
    }
    parts[which] = ask::trimmed(text.substr(open + 1, text.size() - open - 2));
  }
  return parts[static_cast<std::size_t>(axis)];
}

PixelFrame frame_dividing(const Window& window, const PixelCounts& counts) {
  const double width = window.max_x - window.min_x, height = window.max_y - window.min_y;
  if (!(width > 0 && height > 0)) {
    throw Problem(400, "a window without an area has no pixels").at("bbox");
  }
  const auto other_side = [](std::uint64_t count, double along, double across) {
    return static_cast<std::uint64_t>(
        std::clamp(std::round(static_cast<double>(count) * across / along), 1.0, 1e9));
  };
  const std::uint64_t columns =
      counts.width ? *counts.width : other_side(*counts.height, height, width);
  const std::uint64_t rows =
      counts.height ? *counts.height : other_side(*counts.width, width, height);
  return {window.min_x,
          window.max_y,
          {width / static_cast<double>(columns), height / static_cast<double>(rows)},
          static_cast<std::int64_t>(columns),
          static_cast<std::int64_t>(rows)};
}

PixelFrame frame_covering(const Window& window, const std::array<double, 2>& size) {
  constexpr double kSameSide = 1e-9;  // A share of a pixel, which rounding decides.
  constexpr double kMostAlong = 1e9;
  const double west = std::floor(window.min_x / size[0] + kSameSide);
  const double east = std::ceil(window.max_x / size[0] - kSameSide);
  const double south = std::floor(window.min_y / size[1] + kSameSide);
  const double north = std::ceil(window.max_y / size[1] - kSameSide);
  return {west * size[0], north * size[1], size,
          static_cast<std::int64_t>(std::clamp(east - west, 1.0, kMostAlong)),
          static_cast<std::int64_t>(std::clamp(north - south, 1.0, kMostAlong))};
}

double side_of_own_pixel(const Places& places, MapPoint own, const Window& window) {
  const MapPoint at = places.to_terrain(
      MapPoint{(window.min_x + window.max_x) / 2, (window.min_y + window.max_y) / 2}, "bbox");
  std::array<MapPoint, 3> corners{at, MapPoint{at.x + own.x, at.y}, MapPoint{at.x, at.y + own.y}};
  places.from_terrain(corners);
  const auto& [here, east, north] = corners;
  return std::sqrt(
      std::abs((east.x - here.x) * (north.y - here.y) - (east.y - here.y) * (north.x - here.x)));
}

tools::WrittenRaster write_frame(const Asked& asked, const Places& places, const PixelFrame& frame,
                                 const LocateRequest& request, const tools::RasterTarget& target) {
  tools::RasterForm form;
  form.width = frame.columns;
  form.height = frame.rows;
  form.type = tools::type_of_pixels(asked.facts(), tools::PixelValue::kHeight);
  form.geotransform = {{frame.west, frame.size[0], 0.0, frame.north, 0.0, -frame.size[1]}};
  form.nodata = target.nodata;
  form.unit = tools::unit_of_pixels(target.content, asked.collection->crs);
  tools::RasterFile file(target, form);
  int block_width = 0, block_height = 0;
  file.band().GetBlockSize(&block_width, &block_height);
  const auto block_pixels =
      static_cast<std::size_t>(block_width) * static_cast<std::size_t>(block_height);
  const bool is_double = form.type == GDT_Float64;
  std::vector<std::byte> bytes(block_pixels * (is_double ? sizeof(double) : sizeof(float)));
  std::vector<MapPoint> centres;
  std::vector<double> heights;
  tools::WrittenRaster written;
  written.exact = true;
  for (std::int64_t row = 0; row < frame.rows; row += block_height) {
    for (std::int64_t column = 0; column < frame.columns; column += block_width) {
      stop_if_asked(request.limits.stop, "the raster");
      const std::int64_t width = std::min<std::int64_t>(block_width, frame.columns - column);
      const std::int64_t height = std::min<std::int64_t>(block_height, frame.rows - row);
      centres.clear();
      for (std::int64_t j = row; j < row + height; ++j) {
        for (std::int64_t i = column; i < column + width; ++i) {
          centres.push_back({frame.west + (static_cast<double>(i) + 0.5) * frame.size[0],
                             frame.north - (static_cast<double>(j) + 0.5) * frame.size[1]});
        }
      }
      places.to_terrain(centres, "bbox");
      heights.resize(centres.size());
      const RasterResult result = asked.terrain().heights_at(centres, request, heights);
      written.certified_error = std::max(written.certified_error, result.certified_error);
      written.certified_deviation =
          std::max(written.certified_deviation, result.certified_deviation);
      written.exact = written.exact && result.exact;
      written.cost.add_counts(result.cost);
      written.cost.seconds += result.cost.seconds;
      if (is_double) {
        put_heights<double>(heights, width, block_width, target.nodata, bytes, written);
      } else {
        put_heights<float>(heights, width, block_width, target.nodata, bytes, written);
      }
      file.write_block(static_cast<int>(column / block_width), static_cast<int>(row / block_height),
                       bytes.data());
    }
  }
  written.certified_error = rounded_up(written.certified_error, written.rounding);
  written.certified_deviation = rounded_up(written.certified_deviation, written.rounding);
  written.exact = written.exact && written.rounding == 0;
  describe_certificate(file, written);
  file.publish({}, request.limits.stop);
  return written;
}

}  // namespace ptin::serve
