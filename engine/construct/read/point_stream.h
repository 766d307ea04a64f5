// SPDX-License-Identifier: GPL-3.0-or-later
//
// Points as they come: one file of points of any kind, read once, in batches.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "engine/construct/grid/decimal.h"

namespace ptin {

/// A point of a source, before it is put on the grid; CRS units and the height's unit.
struct SourcePoint {
  Decimal x, y, z;
};

/// Which points of a source are wanted.
struct PointChoice {
  std::vector<int> classes;  ///< LAS: keep these classes (0 .. 255); empty keeps all.
  std::string layer;         ///< OGR: the layer; "" where there is only one.
  std::string z_field;       ///< OGR: the attribute that holds the height; "" for the geometry's z.
};

/// A grid that a source brings along: LAS coordinates are whole steps from an offset.
struct SourceLattice {
  double unit = 0.0;                      ///< CRS units, > 0.
  double origin_x = 0.0, origin_y = 0.0;  ///< CRS units.
};

/// What a source declares before its first point is read.
struct PointStreamFacts {
  std::string crs;           ///< Anything GDAL understands; "" when the source does not say.
  std::string vertical_crs;  ///< Likewise, where it is told apart from `crs`.
  /// Digits after the point that coordinates and heights are declared to have: at least so many are
  /// kept.
  int plan_decimals = 0;
  int height_decimals = 0;
  /// Set where steps are no power of ten or the offset is not a whole number of them:
  /// `plan_decimals` says nothing then, and the grid is this one.
  std::optional<SourceLattice> lattice;
};

struct ExternalMemory;

/// What a source may take that is sorted before its first point comes.
struct StreamResources {
  const ExternalMemory* memory = nullptr;  ///< While the stream is opened; null: its own choice.
  std::stop_token stop;
  std::function<void(std::uint64_t done, std::uint64_t total)> progress;  ///< May be empty.
};

/// One input file as a stream. Not thread-safe; files stay open as long as it lives.
class PointStream {
 public:
  PointStream() = default;
  PointStream(const PointStream&) = delete;
  PointStream& operator=(const PointStream&) = delete;
  virtual ~PointStream() = default;

  [[nodiscard]] virtual const PointStreamFacts& facts() const noexcept = 0;
  /// The next points, some thousands at a time; false when there is none left.
  /// @param batch  Overwritten.
  /// @throws Error  invalid_argument  the input is not what it says (the context names the place)
  ///                io_error          it cannot be read on
  [[nodiscard]] virtual bool next(std::vector<SourcePoint>& batch) = 0;

  /// Points so far that the choice, or the source itself (withheld; no height), leaves out.
  [[nodiscard]] virtual std::uint64_t left_out() const noexcept { return 0; }
  /// How far dropping digits has moved a point so far, CRS units.
  [[nodiscard]] virtual double largest_shift() const noexcept { return 0.0; }
  /// Progress in units of its own; total 0 when that is unknown.
  [[nodiscard]] virtual std::uint64_t done() const noexcept = 0;
  [[nodiscard]] virtual std::uint64_t total() const noexcept = 0;
};

/// True when a name is that of points: as text (.csv, .xyz, .txt, .tsv, in any case, also followed
/// by .gz) or LAS (.las, .laz).
[[nodiscard]] bool is_point_file(const std::string& path);
/// Those of them that are text.
[[nodiscard]] bool is_point_text(const std::string& path);
/// True when a name says that text is packed, to be unpacked on the way: .gz, in any case.
[[nodiscard]] bool is_packed(const std::string& path);

/// True when an input is points rather than a raster: by its name, or because a layer or attribute
/// is chosen, or as a TIN that has vertices, or since OGR reads it and GDAL finds no raster in it.
/// Cost: opens other files than those known by name.
[[nodiscard]] bool is_point_input(const std::string& path, const PointChoice& choice);

/// Opens a file of points by its name: LAS (las_reader.h), a TIN for its vertices (tin_vertices.h),
/// text (xyz_reader.h), anything else as a layer of OGR's (ogr_points.h); with a layer or z-field
/// chosen, OGR always.
/// @param nodata  This height means none: such points are handed out all the same, but that
///                vertices of a TIN stay only where a triangle has three heights, as when it is
///                built.
/// @throws Error  not_found, io_error, invalid_argument, unsupported_version  as those; a choice
///                that means nothing for the kind of file
[[nodiscard]] std::unique_ptr<PointStream> open_point_stream(const std::string& path,
                                                             const PointChoice& choice,
                                                             std::optional<double> nodata = {},
                                                             const StreamResources& resources = {});

}  // namespace ptin
