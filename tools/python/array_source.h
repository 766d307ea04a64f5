// SPDX-License-Identifier: GPL-3.0-or-later
//
// Arrays of NumPy as sources of a build. GDAL reads them where they lie, as files in its memory file
// system: nothing is copied, and the engine sees a raster or a layer of points as any other.
#pragma once

#include <array>
#include <cstddef>
#include <string>

namespace ptin::python {

/// Rows and columns of numbers; row by row, without gaps.
struct GridArray {
  const void* numbers = nullptr;
  std::string type;  ///< As GDAL calls it: "Float32".
  std::size_t bytes_of_number = 0;
  std::size_t columns = 0, rows = 0;
  /// Map position of the outer corner of the first pixel and the steps, as GDAL has them.
  std::array<double, 6> geotransform{};
};

/// A source in memory: `name` can be read as long as this lives, and the memory that it borrows.
class ArraySource {
 public:
  /// A raster.
  explicit ArraySource(const GridArray& grid);
  /// Points: x, y, height of each, one after the other. One of which a number is NaN is left out.
  ArraySource(const double* numbers, std::size_t points);
  ~ArraySource();
  ArraySource(const ArraySource&) = delete;
  ArraySource& operator=(const ArraySource&) = delete;

  [[nodiscard]] const std::string& name() const noexcept { return name_; }

 private:
  /// Puts memory into the file system, under a name.
  void put(const std::string& file, const void* bytes, std::size_t size);

  std::string folder_, name_;
  std::string text_;  ///< That of the file that describes the raster.
};

}  // namespace ptin::python
