// SPDX-License-Identifier: GPL-3.0-or-later
//
// One opened raster file: its place in the world, and its raw values turned to the grid's
// orientation.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>

#include "engine/construct/grid/source_warning.h"
#include "engine/construct/grid/terrain_frame.h"
#include "engine/construct/raster/raster_nodata.h"
#include "engine/construct/tile/tile_tree.h"

namespace ptin {

/// The type as which the raw values of a raster are read: int32 for Byte, Int16, UInt16 and Int32
/// unless their scale is negative; float for Float32 without scale and offset; double otherwise.
enum class RawType : std::uint8_t { kInt32, kFloat32, kFloat64 };

/// What a raster file says of itself, in the grid's orientation: x to the east, y to the north,
/// sample (0, 0) the centre of its south-western pixel.
struct RasterShape {
  std::int64_t width = 0;
  std::int64_t height = 0;
  AffineMap map;  ///< From samples to the CRS.
  /// As the file states it, skew and order of rows and columns too; none: it states none.
  std::optional<std::array<double, 6>> geotransform;
  bool is_point = false;           ///< The file calls its pixels points (AREA_OR_POINT).
  bool georeferenced = false;      ///< false: the map is the identity, in pixels.
  bool rows_from_south = false;    ///< The file's first row is the southernmost.
  bool columns_from_east = false;  ///< The file's first column is the easternmost.
  std::string crs;                 ///< As declared_crs() (grid/dataset_crs.h); empty when unknown.
  std::string plane_unit;          ///< Unit of x and y, besides the CRS; empty when unknown.
  std::string unit;                ///< Unit of heights; empty when unknown.
  RawType raw = RawType::kInt32;
  std::string type_name;  ///< GDAL's: "Int16", "Float32" ...
  StoredType stored;
  double scale = 1.0;  ///< height = offset + scale * raw value
  double offset = 0.0;
  std::optional<double> nodata;  ///< The nodata value in force: the caller's, or what is declared.
  bool is_overridden = false;    ///< The file declares another nodata value than that in force.
  bool is_masked = false;        ///< A band beside the heights tells which of them count.
  std::array<int, 2> block = {1, 1};  ///< Width and height of the file's own blocks.
};

/// A raster file, which is opened when it is needed. Not thread-safe: one call at a time.
class RasterPart {
 public:
  /// Opens the file.
  /// @param nodata_override  Replaces the nodata value that the file declares; none keeps that.
  /// @throws Error  not_found         no such file
  ///                invalid_argument  not a raster, no band or several, complex numbers, as
  ///                                  describe_place()
  RasterPart(std::string path, std::optional<double> nodata_override);
  /// A copy that is closed: it opens the file again, with a descriptor of its own.
  [[nodiscard]] RasterPart closed_copy() const { return RasterPart(*this); }
  ~RasterPart();
  RasterPart(RasterPart&&) noexcept;
  RasterPart& operator=(RasterPart&&) noexcept;

  [[nodiscard]] const RasterShape& shape() const noexcept { return shape_; }
  /// Warnings of what the file declares.
  [[nodiscard]] const SourceWarnings& warnings() const noexcept { return warnings_; }
  [[nodiscard]] const std::string& path() const noexcept { return path_; }

  /// Closes the file until the next read(): a mosaic may have more files than a process may have
  /// descriptors.
  void close() noexcept;
  [[nodiscard]] bool is_open() const noexcept { return bands_ != nullptr; }

  /// Reads raw values and whether each is a height, row-major from the south. T is int32_t, float
  /// or double, as shape().raw says. A value is none where it is the nodata value, NaN, or masked
  /// out. REQUIRES: the window lies inside the file; the spans hold width * height.
  /// @throws Error  io_error          a block cannot be read
  ///                invalid_argument  a height that is not finite: the message names its pixel
  template <class T>
  void read(const SampleRange& window, std::span<T> values, std::span<std::uint8_t> valid);

  /// Whether the numbers that GDAL hands out, in the raster's own type, follow from the values and from
  /// what is declared: void ones are the nodata value, or where there is none the usual NaN, bit for bit.
  /// @param values, valid  As read() gave them for the window.
  /// @throws Error io_error
  /// Cost: of a VRT, that of reading it.
  template <class T>
  [[nodiscard]] bool gives_back(const SampleRange& window, std::span<const T> values,
                                std::span<const std::uint8_t> valid);

 private:
  struct Bands;
  RasterPart(const RasterPart& other);
  void open();
  /// Turns bytes that GDAL hands out from 0 to 255 into signed ones.
  template <class T>
  void sign_bytes(std::span<T> values) const;

  std::string path_;
  std::optional<double> nodata_override_;
  NodataRange nodata_;  ///< The nodata value in force, compared with stored values.
  RasterShape shape_;
  SourceWarnings warnings_;
  std::unique_ptr<Bands> bands_;
};

}  // namespace ptin
