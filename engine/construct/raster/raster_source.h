// SPDX-License-Identifier: GPL-3.0-or-later
//
// Rasters as a terrain: one file that GDAL reads (a VRT too), or several of one grid.
#pragma once

#include <cstdint>
#include <memory>
#include <mutex>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "engine/construct/grid/source_options.h"
#include "engine/construct/grid/source_warning.h"
#include "engine/construct/grid/terrain_frame.h"
#include "engine/construct/raster/raster_kept.h"
#include "engine/construct/raster/raster_mosaic.h"
#include "engine/construct/raster/raster_suspects.h"
#include "engine/construct/scratch/array_file.h"
#include "engine/construct/tasks/task_driver.h"
#include "engine/construct/tile/tile_tree.h"

namespace ptin {

/// An opened raster terrain. Samples stand at pixel centres, whether the file calls its pixels
/// areas or points; grid x counts columns from the west, grid y rows from the south, whatever the
/// file's own order; without a geotransform a grid unit is a pixel and the CRS unknown.
///
/// A sample is void where it is the nodata value, NaN, masked out (mask band, alpha 0), or in no
/// file. Where files overlap, the last file in the order given that has a height there decides.
/// Scale and offset are applied; for integer rasters they become those of the height encoding, so
/// that no height is rounded.
///
/// Threads: const members may be called from several threads, which take turns at the files.
/// Threads that are not to wait for each other need a duplicate() each.
class RasterSource {
 public:
  /// Opens the files and reads all samples once, block by block, to count them and to choose the
  /// encoding.
  /// @param paths     One raster, or several with the same steps, type, scale, offset and CRS whose
  ///                  samples lie on one grid to a hundredth of a pixel.
  /// @param options   `resolution`, `merge` and `points` do not concern rasters.
  /// @param run       Has the samples looked at (raster_scan.h).
  /// @throws Error  not_found         a file does not exist
  ///                invalid_argument  not a raster; no band or several; rotated; more than 2^30
  ///                                  steps; a single row or column; no sample in `bbox`; an
  ///                                  infinite height (the message names its pixel); files that are
  ///                                  not of one grid. A raster without any height is no error.
  ///                io_error          a block cannot be read
  ///                and what `run` throws
  /// Cost: one reading of all files. Memory: a few MiB, and GDAL's block cache, whose size the
  /// caller sets.
  [[nodiscard]] static RasterSource open(const std::vector<std::string>& paths,
                                         const SourceOptions& options,
                                         const RunTasks& run = run_alone);
  /// What does tasks of that reading in another process.
  /// @throws Error as open()
  [[nodiscard]] static std::unique_ptr<TaskWorker> open_to_scan(
      const std::vector<std::string>& paths, const SourceOptions& options);

  /// Writes what open() found out by reading to the file `index`, for take_up() of other processes.
  /// @return  What take_up() needs to know of it.
  /// @throws Error io_error, resource_exhausted
  [[nodiscard]] ArrayFileFacts save(FileLayer& files, const std::string& index) const;
  /// Opens the files as open() does, but reads no sample.
  /// @param options  Those of open().
  /// @throws Error corruption  the index is not what was written; as open()
  [[nodiscard]] static RasterSource take_up(const std::vector<std::string>& paths,
                                            const SourceOptions& options, const std::string& index,
                                            const ArrayFileFacts& facts);

  /// The same terrain with files of its own. Cost: opens no file before the first read(). The files
  /// of a mosaic are closed in this source too, until they are read again.
  [[nodiscard]] RasterSource duplicate() const;

  [[nodiscard]] const TerrainFrame& frame() const noexcept { return frame_; }
  /// Samples in x and in y, at least 2.
  [[nodiscard]] std::int64_t width() const noexcept { return mosaic_.width(); }
  [[nodiscard]] std::int64_t height() const noexcept { return mosaic_.height(); }
  [[nodiscard]] std::uint64_t valid_samples() const noexcept { return valid_samples_; }
  [[nodiscard]] std::uint64_t void_samples() const noexcept {
    return static_cast<std::uint64_t>(width()) * static_cast<std::uint64_t>(height()) -
           valid_samples_;
  }
  /// Warnings of what the files declare and open() found.
  [[nodiscard]] const SourceWarnings& warnings() const noexcept { return warnings_; }

  /// Reads a window of samples: row-major, row 0 in the south. `heights` is 0 where `valid` is 0.
  /// REQUIRES: the window lies inside the terrain; the spans hold window.samples().
  /// @throws Error  invalid_argument  the window or a span is not as required
  ///                io_error          a block cannot be read, or the file changed since open()
  /// Cost: linear in the window, and decoding those blocks under it that GDAL's cache does not
  /// hold. Memory beside the spans: none for one file of integers; one value of 4 or 8 bytes a
  /// sample for other types; for a mosaic besides the values of one file at a time.
  void read(const SampleRange& window, std::span<HeightBits> heights,
            std::span<std::uint8_t> valid) const;

  /// What a file can keep of the raster, by what is declared: samples are not looked at.
  [[nodiscard]] KeptRaster kept() const;
  /// As read(), and adds to what is lost by looking at the samples: voids that are not alike, and
  /// numbers that heights do not give back.
  /// @param kept  That of kept(), and of windows before.
  void read(const SampleRange& window, std::span<HeightBits> heights, std::span<std::uint8_t> valid,
            KeptRaster& kept) const;

 private:
  explicit RasterSource(RasterMosaic files) : mosaic_(std::move(files)) {}
  [[nodiscard]] static RasterSource opened(const std::vector<std::string>& paths,
                                           const SourceOptions& options);
  void read_samples(const SampleRange& window, std::span<HeightBits> heights,
                    std::span<std::uint8_t> valid, KeptRaster* kept) const;
  void take_unit(const std::string& declared, const std::string& path,
                 const SourceOptions& options);
  void take_plane_unit(const std::string& path);
  void frame_mosaic(const std::string& path, const SourceOptions& options);
  void check_size() const;
  void warn_of(const std::vector<RasterSuspects::Suspect>& suspects);

  TerrainFrame frame_;
  std::uint64_t valid_samples_ = 0;
  SourceWarnings warnings_;
  std::unique_ptr<std::mutex> mutex_ = std::make_unique<std::mutex>();  ///< Guards the mosaic.
  mutable RasterMosaic mosaic_;
};

}  // namespace ptin
