// SPDX-License-Identifier: GPL-3.0-or-later
//
// Small terrains of every kind, each as the tile that construction starts from and as plain samples
// for oracles.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include "engine/construct/collapse/simplify.h"
#include "engine/construct/tile/full_surface.h"
#include "engine/construct/tile/tile.h"

namespace ptin::oracle {

inline constexpr HeightEncoding kInt{HeightType::int32, 1.0, 0.0};
inline constexpr HeightEncoding kFloat{HeightType::float32, 1.0, 0.0};

/// A sample as its source has it.
struct PlainSample {
  GridPoint position;
  double code = 0.0;
  bool has_height = true;
  double depth = 0.0;  ///< Distance to the border between surface and void; may be infinite.
};

struct TestTerrain {
  std::string name;
  Tile tile;
  std::unique_ptr<FullSurface> surface;
  Tin full;
  std::vector<PlainSample> samples;  ///< In the order of their keys, as the vertices of `full`.
  double slope = 0.1;                ///< Height charged per grid step that the border moves.
};

/// A raster in words: codes and mask as functions of column and row.
struct RasterSpec {
  std::string name;
  int width = 2, height = 2;
  std::function<double(int x, int y)> code;
  std::function<bool(int x, int y)> valid;  ///< Empty: everywhere.
  HeightEncoding heights{HeightType::int32, 1.0, 0.0};
  GridPoint origin;
  double slope = 0.1;
};
[[nodiscard]] TestTerrain make_raster(const RasterSpec& spec);

struct PointSpec {
  std::string name;
  std::vector<GridPoint> positions;  ///< In any order; of duplicates the first counts.
  std::function<double(GridPoint)> code;
  HeightEncoding heights{HeightType::int32, 1.0, 0.0};
};
[[nodiscard]] TestTerrain make_points(const PointSpec& spec);

/// As make_raster(), of given samples. Row 0 in the south.
[[nodiscard]] TestTerrain make_sampled(const std::string& name, int width, int height,
                                       const std::vector<HeightBits>& heights,
                                       std::vector<std::uint8_t> valid,
                                       const HeightEncoding& encoding, GridPoint origin,
                                       double slope);

/// Terrains that have broken simplifiers: flat, spikes, lakes, masks, thin, collinear, wide ...
[[nodiscard]] std::vector<std::function<TestTerrain()>> nasty_rasters();
[[nodiscard]] std::vector<std::function<TestTerrain()>> nasty_points();
/// Lakes, seas and voids large enough that their samples join into blocks (sample_blocks.h).
[[nodiscard]] std::vector<std::function<TestTerrain()>> lakes();

/// A terrain that depends on the seed alone, of about `size` vertices.
[[nodiscard]] TestTerrain random_terrain(std::uint64_t seed, int size);

/// Simplifies to T0 and returns the terrain.
[[nodiscard]] TestTerrain simplified(TestTerrain terrain, CostModel cost = CostModel::kError);

}  // namespace ptin::oracle
