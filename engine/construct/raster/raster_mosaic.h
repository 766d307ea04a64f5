// SPDX-License-Identifier: GPL-3.0-or-later
//
// One raster, or several that lie on one grid, read as if they were one.
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "engine/construct/grid/source_options.h"
#include "engine/construct/raster/raster_part.h"
#include "engine/geometry/affine.h"

namespace ptin {

/// The files of a terrain, each at its place on the common grid. Where files overlap, heights of a
/// later file replace those of an earlier one, and its voids replace nothing.
///
/// No more files are open at once than the descriptors of the process allow: a mosaic and its
/// duplicates share them, and a file whose last use is longest ago is closed first.
/// Threads: one at a time.
class RasterMosaic {
 public:
  /// @param paths    One raster, or several with the same steps, type, scale, offset and CRS whose
  ///                 samples lie on one grid to a hundredth of a pixel.
  /// @param options  `nodata` and `a_srs` are looked at; `bbox` is crop()'s matter.
  /// @throws Error as RasterSource::open
  RasterMosaic(const std::vector<std::string>& paths, const SourceOptions& options);
  RasterMosaic(RasterMosaic&&) noexcept = default;
  RasterMosaic& operator=(RasterMosaic&&) = delete;
  ~RasterMosaic();

  /// The same files at the same places, none of them open. The files of a mosaic of several are
  /// closed here too, until they are read again.
  [[nodiscard]] RasterMosaic duplicate();

  /// Leaves out samples outside of the bounds, in CRS units.
  /// @throws Error invalid_argument  bounds that mean nothing, or that hold no sample
  void crop(const SourceOptions::Bounds& bounds);

  /// From sample (0, 0), the south-western one, to map units.
  [[nodiscard]] const AffineMap& map() const noexcept { return map_; }
  [[nodiscard]] std::int64_t width() const noexcept { return width_; }    ///< Samples in x.
  [[nodiscard]] std::int64_t height() const noexcept { return height_; }  ///< Samples in y.
  /// The shape of the first file: its type, scale, offset and blocks are those of all.
  [[nodiscard]] const RasterShape& first() const noexcept { return parts_[0].part.shape(); }
  /// The unit of heights: that of the first file that declares one, and so of all that do.
  [[nodiscard]] std::string unit() const;
  /// The last file that covers a sample.
  [[nodiscard]] const std::string& path_at(std::int64_t x, std::int64_t y) const;
  /// Those of all files, in their order.
  [[nodiscard]] SourceWarnings warnings() const;
  [[nodiscard]] bool is_one_file() const noexcept { return parts_.size() == 1; }
  /// Whether crop() left samples out.
  [[nodiscard]] bool is_cropped() const noexcept { return is_cropped_; }
  /// The files, for errors.
  [[nodiscard]] std::string context() const;

  /// Reads a window, row-major, row 0 in the south; T is the raw type of the files (first().raw).
  /// Values where `valid` is 0 mean nothing. REQUIRES: the window lies inside; the spans are of its
  /// size.
  /// @throws Error io_error  a block cannot be read, or a file changed since it was opened
  /// Memory: none for one file; for several the values of one file at a time.
  template <class T>
  void read(const SampleRange& window, std::span<T> values, std::span<std::uint8_t> valid);
  /// As RasterPart::gives_back().  REQUIRES: is_one_file(), uncropped
  template <class T>
  [[nodiscard]] bool gives_back(const SampleRange& window, std::span<const T> values,
                                std::span<const std::uint8_t> valid) {
    return parts_[0].part.gives_back(window, values, valid);
  }

 private:
  struct PlacedPart {
    RasterPart part;
    std::int64_t x = 0, y = 0;    ///< Its south-western sample, in the terrain.
    std::uint64_t last_used = 0;  ///< `clock_` at that time.
  };

  RasterMosaic() = default;
  void place();
  [[noreturn]] void refuse_bounds(const SourceOptions::Bounds& bounds) const;
  void touch(PlacedPart& placed);
  template <class T>
  void overlay(PlacedPart& placed, const SampleRange& window, std::span<T> values,
               std::span<std::uint8_t> valid);

  AffineMap map_;
  std::int64_t width_ = 0, height_ = 0;
  bool is_cropped_ = false;
  std::vector<PlacedPart> parts_;
  std::uint64_t clock_ = 0;
  /// How many mosaics share the descriptors of the process: this one and its duplicates. Null when
  /// it was moved away.
  std::shared_ptr<std::atomic<std::size_t>> sharers_ =
      std::make_shared<std::atomic<std::size_t>>(1);
};

}  // namespace ptin
