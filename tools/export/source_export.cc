// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/export/source_export.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstddef>
#include <limits>
#include <span>
#include <string>
#include <type_traits>
#include <vector>

#include <nlohmann/json.hpp>

#include "engine/crs/crs_facts.h"
#include "engine/error.h"
#include "engine/stop.h"

namespace ptin::tools {

namespace {

[[noreturn]] void damaged(const StoreFile& store) {
  throw Error(ErrorCode::corruption,
              "the metadata say of the source raster what means nothing; the file is damaged",
              store.path());
}

/// What the metadata say of the raster.
nlohmann::json told_of(const StoreFile& store) {
  const nlohmann::json all = metadata_of(store);
  const nlohmann::json::json_pointer place("/source/raster");
  if (!all.contains(place)) damaged(store);
  nlohmann::json told = all.at(place);
  const bool is_sound = told.is_object() && told.contains("geotransform") &&
                        told.contains("pixels") && told.contains("lost");
  if (!is_sound) damaged(store);
  return told;
}

std::optional<std::array<double, 6>> geotransform_in(const nlohmann::json& told,
                                                     const StoreFile& store) {
  const nlohmann::json& numbers = told.at("geotransform");
  if (numbers.is_null()) return std::nullopt;
  std::array<double, 6> result{};
  if (!numbers.is_array() || numbers.size() != result.size()) damaged(store);
  for (std::size_t i = 0; i < result.size(); ++i) {
    if (!numbers[i].is_number()) damaged(store);
    result[i] = numbers[i].get<double>();
  }
  return result;
}

/// Whether a geotransform, or none, places the samples where the file has them, but for a hundredth of a
/// pixel: sums of large and small numbers are rounded.
bool is_placed_by(const std::optional<std::array<double, 6>>& geotransform,
                  const StoreFacts& facts) {
  constexpr double kSlack = 0.01;
  const auto along = [](double edge, double step, std::int32_t last, double origin, double pixel) {
    const double first = step > 0 ? edge + 0.5 * step : edge + (last + 0.5) * step;
    return std::abs(first - origin) <= kSlack * pixel &&
           std::abs(std::abs(step) - pixel) * last <= kSlack * pixel;
  };
  const AffineMap& map = facts.map;
  if (!geotransform) {
    return map.origin_x == 0.0 && map.origin_y == 0.0 && map.step_x == 1.0 && map.step_y == 1.0;
  }
  const std::array<double, 6>& t = *geotransform;
  return along(t[0], t[1], facts.bounds.max_x, map.origin_x, map.step_x) &&
         along(t[3], t[5], facts.bounds.max_y, map.origin_y, map.step_y);
}

GDALDataType type_of(SourceNumber number) {
  switch (number) {
    case SourceNumber::kUInt8:
    case SourceNumber::kInt8:
      return GDT_Byte;
    case SourceNumber::kUInt16:
      return GDT_UInt16;
    case SourceNumber::kInt16:
      return GDT_Int16;
    case SourceNumber::kUInt32:
      return GDT_UInt32;
    case SourceNumber::kInt32:
      return GDT_Int32;
    case SourceNumber::kFloat32:
      return GDT_Float32;
    case SourceNumber::kFloat64:
      return GDT_Float64;
    case SourceNumber::kUnknown:
      break;
  }
  return GDT_Unknown;
}

/// Fills the raster, block by block.
class SourceWriter {
 public:
  SourceWriter(const Terrain& terrain, const SourceRaster& source, RasterFile& file,
               const std::stop_token& stop)
      : path_(terrain.store().path()),
        heights_(terrain.store().facts().heights),
        floor_(*source.floor),
        source_(floor_.facts().source),
        range_(range_of(source_)),
        form_(source.form),
        file_(file),
        stop_(stop) {
    file.band().GetBlockSize(&block_width_, &block_height_);
    // The order of the file's rows and columns; without a geotransform it is the usual one.
    if (form_.geotransform) {
      rows_from_south_ = (*form_.geotransform)[5] > 0;
      columns_from_east_ = (*form_.geotransform)[1] < 0;
    }
  }

  void run(const std::function<void(double)>& progress) {
    const std::int64_t across = (form_.width - 1) / block_width_ + 1;
    const std::int64_t down = (form_.height - 1) / block_height_ + 1;
    for (std::int64_t row = 0; row < down; ++row) {
      for (std::int64_t column = 0; column < across; ++column) {
        stop_if_asked(stop_, "the export", path_);
        write(static_cast<int>(column), static_cast<int>(row));
        const auto done = static_cast<double>(row * across + column + 1);
        if (progress) progress(done / static_cast<double>(across * down));
      }
    }
  }

 private:
  /// Some columns or rows of the file, as samples of the grid.
  struct Range {
    std::int64_t low, high;  ///< The least and the greatest.
    std::int64_t zero;       ///< Which one comes first in the file.
    std::int64_t step;       ///< 1, or -1.
    /// The place in the block.
    [[nodiscard]] std::int64_t place(std::int64_t v) const noexcept { return (v - zero) * step; }
  };
  static Range range(std::int64_t first, std::int64_t side, std::int64_t all, bool is_turned) {
    const std::int64_t last = std::min(first + side, all) - 1;
    if (!is_turned) return {first, last, first, 1};
    return {all - 1 - last, all - 1 - first, all - 1 - first, -1};
  }

  void write(int column, int row) {
    columns_ =
        range(std::int64_t{column} * block_width_, block_width_, form_.width, columns_from_east_);
    rows_ =
        range(std::int64_t{row} * block_height_, block_height_, form_.height, !rows_from_south_);
    switch (form_.type) {
      case GDT_Byte:
        return form_.has_signed_bytes ? write_as<std::int8_t>(column, row)
                                      : write_as<std::uint8_t>(column, row);
      case GDT_UInt16:
        return write_as<std::uint16_t>(column, row);
      case GDT_Int16:
        return write_as<std::int16_t>(column, row);
      case GDT_UInt32:
        return write_as<std::uint32_t>(column, row);
      case GDT_Int32:
        return write_as<std::int32_t>(column, row);
      case GDT_Float32:
        return write_as<float>(column, row);
      default:
        return write_as<double>(column, row);
    }
  }

  /// What samples without a height have: the nodata value, or NaN. No sample of a type that has neither is void.
  template <class T>
  [[nodiscard]] T void_value() const {
    if constexpr (std::is_floating_point_v<T>) {
      return form_.nodata ? static_cast<T>(*form_.nodata) : std::numeric_limits<T>::quiet_NaN();
    } else {
      constexpr auto kLow = static_cast<double>(std::numeric_limits<T>::lowest());
      constexpr auto kHigh = static_cast<double>(std::numeric_limits<T>::max());
      const double value = form_.nodata.value_or(0.0);
      return value >= kLow && value <= kHigh ? static_cast<T>(value) : T{0};
    }
  }

  /// The source's number of a sample.
  template <class T>
  [[nodiscard]] T number(OrderedHeight ordered) const {
    const HeightBits bits = floor_.numbers().bits(ordered);
    if constexpr (std::is_same_v<T, float>) {
      if (heights_.type == HeightType::float32) return std::bit_cast<float>(bits);
    }
    const double number = are_codes(source_) ? heights_.code(bits) : heights_.height(bits);
    if (!contains(range_, number)) {
      throw Error(ErrorCode::corruption,
                  "a height is no number of the source's type; the file is damaged", path_);
    }
    return static_cast<T>(number);
  }

  template <class T>
  void write_as(int column, int row) {
    bytes_.resize(static_cast<std::size_t>(block_width_) * static_cast<std::size_t>(block_height_) *
                  sizeof(T));
    const std::span<T> values(reinterpret_cast<T*>(bytes_.data()), bytes_.size() / sizeof(T));
    std::fill(values.begin(), values.end(), void_value<T>());
    floor_.visit(
        [&](const Floor::Bounds& b) {
          return b.box.max_x >= columns_.low && b.box.min_x <= columns_.high &&
                 b.box.max_y >= rows_.low && b.box.min_y <= rows_.high;
        },
        [&](const Floor::TileAt& at, const FloorTile& samples) {
          take<T>(at, samples, values);
          return true;
        },
        recent_, counters_);
    file_.write_block(column, row, values.data());
  }

  template <class T>
  void take(const Floor::TileAt& at, const FloorTile& tile, std::span<T> values) const {
    const std::int64_t left = floor_.facts().shape.first_of(at.column);
    const std::int64_t low = floor_.facts().shape.first_of(at.row);
    const std::int64_t first = std::max(columns_.low, left);
    const std::int64_t last = std::min(columns_.high, left + tile.width - 1);
    const std::int64_t last_row = std::min(rows_.high, low + tile.height - 1);
    for (std::int64_t y = std::max(rows_.low, low); y <= last_row; ++y) {
      const auto from = static_cast<std::size_t>((y - low) * tile.width - left);
      const std::int64_t to = rows_.place(y) * block_width_;
      for (std::int64_t x = first; x <= last; ++x) {
        const std::size_t i = from + static_cast<std::size_t>(x);
        if (!tile.is_void.empty() && tile.is_void[i] != 0) continue;
        values[static_cast<std::size_t>(to + columns_.place(x))] = number<T>(tile.heights[i]);
      }
    }
    for (const FloorTile::Lone& lone : tile.lone) {
      const std::int64_t x = left + lone.place % tile.width, y = low + lone.place / tile.width;
      if (x < columns_.low || x > columns_.high || y < rows_.low || y > rows_.high) continue;
      values[static_cast<std::size_t>(rows_.place(y) * block_width_ + columns_.place(x))] =
          number<T>(lone.height);
    }
  }

  const std::string path_;
  const HeightEncoding heights_;
  const Floor& floor_;
  const SourceNumber source_;
  const Interval range_;
  const RasterForm& form_;
  RasterFile& file_;
  const std::stop_token& stop_;
  int block_width_ = 0, block_height_ = 0;
  bool rows_from_south_ = false, columns_from_east_ = false;
  Range columns_{}, rows_{};
  std::vector<std::byte> bytes_;  ///< Of the values of a block.
  Floor::Recent recent_;
  IoCounters counters_;
};

}  // namespace

SourceRaster source_raster_of(const Terrain& terrain, const CrsFacts& crs) {
  const StoreFile& store = terrain.store();
  const Floor* const floor = store.floor();
  if (floor == nullptr) {
    refuse(
        "the file does not have the samples of a raster: it was built from points or a TIN, with "
        "--max-error, of heights that were rounded, or by an older ptin; without --source its full "
        "TIN is written, in pixels of --pixel-size",
        store.path());
  }
  const nlohmann::json told = told_of(store);
  const FloorFacts& facts = floor->facts();
  if (!facts.is_exact) {
    if (!told.at("lost").is_string()) damaged(store);
    refuse("the source raster does not come back as it was: not kept is " +
               told.at("lost").get<std::string>() +
               "; without --source the heights of its samples are written",
           store.path());
  }
  SourceRaster source{floor, {}};
  RasterForm& form = source.form;
  form.width = facts.shape.width;
  form.height = facts.shape.height;
  form.type = type_of(facts.source);
  form.has_signed_bytes = facts.source == SourceNumber::kInt8;
  form.geotransform = geotransform_in(told, store);
  form.is_point = told.at("pixels") == "points";
  const bool is_told_so =
      told.at("lost").is_null() && (form.is_point || told.at("pixels") == "areas");
  if (!is_told_so || !is_placed_by(form.geotransform, store.facts())) damaged(store);
  form.nodata = facts.nodata;
  if (are_codes(facts.source)) {
    form.scale = store.facts().heights.step;
    form.offset = store.facts().heights.offset;
  }
  form.unit = unit_of_pixels({}, crs);
  return source;
}

void export_source(const Terrain& terrain, const SourceRaster& source, const RasterTarget& target,
                   const std::function<void(double)>& progress, const std::stop_token& stop) {
  RasterFile file(target, source.form);
  const double share = target.is_cog ? 0.5 : 1.0;
  SourceWriter(terrain, source, file, stop).run([&](double done) {
    if (progress) progress(done * share);
  });
  terrain.store().pages().check_unchanged();
  file.publish(progress, stop);
}

}  // namespace ptin::tools
