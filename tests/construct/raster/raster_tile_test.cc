// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/raster/raster_tile.h"

#include <cfloat>
#include <cmath>

#include <gtest/gtest.h>

#include "tests/construct/made_raster.h"
#include "tests/construct/surface_oracle.h"

namespace ptin {
namespace {

oracle::RasterFile masked() {
  oracle::RasterFile file;
  file.columns = 170;
  file.rows = 150;
  file.nodata = -1;
  file.value = [](int x, int y) {
    const bool is_void = (x / 40 + y / 37) % 2 == 0 || (x < 50 && (x * 7 + y * 3) % 29 == 0);
    return is_void && (x % 31 != 0 || y % 17 != 0) ? -1.0 : x + 2.0 * y;
  };
  return file;
}

TEST(MeasureUnits, AreInCodes) {
  TerrainFrame frame;
  frame.heights = {HeightType::int32, 0.01, 7.0};
  frame.height_quantum = 0.01;
  const MeasureUnits units = measure_units(frame, 0.5);
  EXPECT_EQ(units.quantum_code, 1.0);
  EXPECT_EQ(units.void_slope_code, 50.0);
  EXPECT_TRUE(units.exact_codes);
}

TEST(MeasureUnits, ClaimExactCodesForWholeNumbersAlone) {
  // Heights near whole numbers get a quantum of 1, and so does a range of 65536: neither makes the
  // heights whole.
  TerrainFrame frame;
  frame.heights = {HeightType::float32, 1.0, 0.0};
  frame.height_quantum = 1.0;
  EXPECT_FALSE(measure_units(frame, 0.1).exact_codes);
  oracle::RasterFile file;
  file.type = GDT_Float32;
  file.value = [](int x, int y) { return 1000.0 + x + y + 0x1p-12 * (x * y % 3); };
  const oracle::WrittenRaster raster(file);
  const RasterSource source = RasterSource::open({raster.path()}, {});
  EXPECT_EQ(source.frame().height_quantum, 1.0);
  const StartedTile started =
      start_raster_tile(source, {0, 0, 20, 20}, measure_units(source.frame(), 0.1));
  EXPECT_FALSE(started.tile.units.exact_codes);
}

TEST(StartRasterTile, GivesAWindowTheClassesOfTheWhole) {
  const oracle::WrittenRaster raster(masked());
  const RasterSource source = RasterSource::open({raster.path()}, {});
  const MeasureUnits units = measure_units(source.frame(), 0.1);
  const StartedTile whole = start_raster_tile(source, {0, 0, 170, 150}, units);
  EXPECT_GT(whole.lone_samples, 0U);
  std::uint64_t lone = 0;
  for (const SampleRange& window :
       {SampleRange{0, 0, 95, 150}, {95, 0, 75, 75}, {95, 75, 75, 75}}) {
    const StartedTile part = start_raster_tile(source, window, units);
    lone += part.lone_samples;
    const Tin& tin = part.tile.tin;
    for (VertexId v = 0; v < tin.vertices.size(); ++v) {
      const GridPoint p = tin.position(v);
      const auto other = static_cast<VertexId>(p.y * 170 + p.x);
      ASSERT_EQ(whole.tile.tin.position(other), p);
      ASSERT_EQ(tin.has_height[v], whole.tile.tin.has_height[other]);
      ASSERT_EQ(tin.vertices[v].height, whole.tile.tin.vertices[other].height);
    }
    const auto all = oracle::named_triangles(whole.tile.tin);
    for (const oracle::NamedTriangle& t : oracle::named_triangles(tin)) {
      ASSERT_TRUE(std::binary_search(all.begin(), all.end(), t));
    }
  }
  EXPECT_EQ(lone, whole.lone_samples);
}

TEST(StartRasterTile, TurnsSamplesThatTouchNoSurfaceIntoVoids) {
  const oracle::WrittenRaster raster(masked());
  const RasterSource source = RasterSource::open({raster.path()}, {});
  const StartedTile started =
      start_raster_tile(source, {0, 0, 170, 150}, measure_units(source.frame(), 0.1));
  const Tin& tin = started.tile.tin;
  std::vector<std::uint8_t> touched(tin.vertices.size(), 0);
  for (TriangleId t = 0; t < tin.triangles.size(); ++t) {
    for (const VertexId v : tin.triangles[t].v) {
      touched[v] = oracle::is_surface(tin, t) ? 1 : touched[v];
    }
  }
  std::uint64_t with_height = 0;
  for (VertexId v = 0; v < tin.vertices.size(); ++v) {
    ASSERT_EQ(tin.has_height[v], touched[v]);
    ASSERT_EQ(started.tile.vertex_state[v].reach >= 0.0F, touched[v] != 0);
    with_height += tin.has_height[v];
  }
  EXPECT_GT(started.lone_samples, 0U);
  EXPECT_EQ(with_height + started.lone_samples, source.valid_samples());
}

TEST(StartRasterTile, SignsReachesByClassAndMeasuresThemOnTheGround) {
  oracle::RasterFile file;  // samples are 10 apart
  file.nodata = -1;
  file.value = [](int x, int) { return x < 5 ? -1.0 : 3.0; };
  const oracle::WrittenRaster raster(file);
  const RasterSource source = RasterSource::open({raster.path()}, {});
  const StartedTile started =
      start_raster_tile(source, {0, 0, 20, 20}, measure_units(source.frame(), 0.1));
  for (VertexId v = 0; v < started.tile.tin.vertices.size(); ++v) {
    const int x = started.tile.tin.position(v).x;  // the border lies along column 5
    const float reach = started.tile.vertex_state[v].reach;
    ASSERT_EQ(std::signbit(reach), x < 5);
    if (x == 5) {
      ASSERT_EQ(reach, 0.0F);
    } else if (std::abs(reach) > FLT_MIN) {  // else its neighbours are the witnesses
      ASSERT_GE(std::abs(reach), 10.0F * static_cast<float>(std::abs(x - 5)));
    }
  }
}

}  // namespace
}  // namespace ptin
