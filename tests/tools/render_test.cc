// SPDX-License-Identifier: GPL-3.0-or-later
#include <cmath>

#include <gtest/gtest.h>

#include "engine/error.h"
#include "tests/tools/program.h"
#include "tools/render/overlay.h"

namespace ptin::tools {
namespace {

constexpr MapPoint kUnits{1, 1};

TEST(MakeView, KeepsTheAspectOfTheGround) {
  const View view = make_view({0, 0, 200, 100}, kUnits, 0, 0);
  EXPECT_EQ(view.width, 1200);
  EXPECT_EQ(view.height, 600);
  const View north = make_view({10, 59.5, 11, 60.5}, {55'660, 111'320}, 0, 0);
  EXPECT_EQ(north.height, 1200);
  EXPECT_NEAR(north.width, 600, 1);  // a degree of longitude is half as long at 60 degrees
}

TEST(MakeView, CentresTheWindowInAGivenSize) {
  const View view = make_view({0, 0, 100, 100}, kUnits, 400, 200);
  EXPECT_DOUBLE_EQ(view.pixel_x(0), 100);
  EXPECT_DOUBLE_EQ(view.pixel_x(100), 300);
  EXPECT_DOUBLE_EQ(view.pixel_y(100), 0);
  EXPECT_DOUBLE_EQ(view.pixel_y(0), 200);
}

TEST(MakeView, RefusesWhatHasNoArea) {
  EXPECT_THROW(static_cast<void>(make_view({0, 0, 0, 100}, kUnits, 0, 0)), Error);
  EXPECT_THROW(static_cast<void>(make_view({0, 0, 1, 1}, kUnits, -1, 5)), Error);
  EXPECT_THROW(static_cast<void>(make_view({0, 0, 1, 1}, kUnits, 0, 500)), Error);
}

TEST(MakeView, RefusesWhatHasNoSizeOverGround) {
  const double nan = std::nan("");
  EXPECT_THROW(static_cast<void>(make_view({0, 0, 1, 1}, {nan, nan}, 0, 0)), Error);
  EXPECT_THROW(static_cast<void>(make_view({0, 0, 1, 1}, {0, 0}, 100, 100)), Error);
  EXPECT_THROW(static_cast<void>(make_view({0, 0, 1e300, 1e300}, {1e9, 1e9}, 0, 0)), Error);
  EXPECT_THROW(static_cast<void>(make_view({0, 0, 1e-310, 1e-310}, kUnits, 0, 0)), Error);
}

/// A distance that no int holds was doubled beyond all ints.
TEST(PixelsBetweenSamples, AreAFewWhateverTheGridIs) {
  View view;
  EXPECT_EQ(pixels_between_samples({0, 0, 3, 2}, view), 3);
  EXPECT_EQ(pixels_between_samples({0, 0, 1e-9, 1e-9}, view), 1);
  for (const double step : {1e10, 1e300, HUGE_VAL, std::nan("")}) {
    EXPECT_EQ(pixels_between_samples({0, 0, step, step}, view), 12) << step;
  }
}

/// One square of two triangles on a slope that rises to the east; the eastern one void when asked.
RefinedTin slope(StoreFacts& facts, bool half_void) {
  facts.map = {0, 0, 1, 1};
  facts.heights = {HeightType::float32, 1.0, 0.0};
  facts.bounds = {0, 0, 10, 10};
  RefinedTin refined;
  Tin& tin = refined.tin;
  for (const GridPoint p : {GridPoint{0, 0}, {10, 0}, {10, 10}, {0, 10}}) {
    tin.vertices.push_back({p, facts.heights.bits(p.x), 0});
    tin.has_height.push_back(1);
  }
  tin.triangles = {{{0, 1, 2}, {kNone, 1, kNone}}, {{0, 2, 3}, {kNone, kNone, 0}}};
  tin.classes = {half_void ? TriangleClass::kVoid : TriangleClass::kSurface,
                 TriangleClass::kSurface};
  return refined;
}

TEST(Rasterize, TakesTrianglesFarBeyondThePicture) {
  StoreFacts facts;
  const RefinedTin refined = slope(facts, false);
  for (const double far : {1e12, -1e12}) {
    const TerrainRaster raster =
        rasterize(refined, facts, make_view({far, far, far + 1, far + 1}, kUnits, 40, 40));
    for (const PointState c : raster.states) ASSERT_EQ(c, PointState::kOutside);
  }
}

TEST(Rasterize, FillsEveryPixelOnceWithTheHeightOfItsMiddle) {
  StoreFacts facts;
  const RefinedTin refined = slope(facts, false);
  const TerrainRaster raster =
      rasterize(refined, facts, make_view({-5, -5, 15, 15}, kUnits, 40, 40));
  for (int y = 0; y < 40; ++y) {
    for (int x = 0; x < 40; ++x) {
      const bool inside = x >= 10 && x < 30 && y >= 10 && y < 30;
      ASSERT_EQ(raster.states[raster.place(x, y)],
                inside ? PointState::kSurface : PointState::kOutside);
      if (inside) {
        ASSERT_NEAR(raster.heights[raster.place(x, y)], (x + 0.5 - 10) / 2, 1e-5);
      }
    }
  }
}

TEST(DrawRelief, IsDarkAwayFromTheLightAndGreyInVoids) {
  StoreFacts facts;
  const View view = make_view({0, 0, 10, 10}, kUnits, 50, 50);
  const auto brightness = [&](const RefinedTin& refined, int x, int y) {
    const TerrainRaster raster = rasterize(refined, facts, supersampled(view, 2));
    const Image image = draw_relief(raster, view, 2, choose_style(raster, view, false, 1));
    const Colour c = image.at(x, y);
    return c[0] + c[1] + c[2];
  };
  RefinedTin towards = slope(facts, false);  // rises to the east: looks west, to the light
  RefinedTin away = slope(facts, false);
  for (Vertex& v : away.tin.vertices) v.height = facts.heights.bits(10 - v.position.x);
  EXPECT_GT(brightness(towards, 25, 25), brightness(away, 25, 25) + 60);
  const TerrainRaster raster = rasterize(slope(facts, true), facts, view);
  EXPECT_EQ(raster.states[raster.place(40, 40)], PointState::kVoid);
  EXPECT_EQ(raster.states[raster.place(5, 5)], PointState::kSurface);
}

/// What is refused before anything is read or drawn, and drawing that is stopped.
TEST(Render, KnowsItsMemoryAndCanBeStopped) {
  const testing::TestFolder folder;
  const std::string store = testing::built(folder, "ground_points.csv");
  const auto draw = [&](const std::vector<std::string>& more) {
    std::vector<std::string> arguments = {"render", store, "-o", folder.file("a.png")};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return testing::run_ptin(arguments);
  };
  const auto large = draw({"--size", "32767", "32767"});
  EXPECT_EQ(large.status, 7) << large.err;
  EXPECT_NE(large.err.find("a picture of 32767 x 32767 pixels takes 28.0 GiB, and 4.00 GiB are"),
            std::string::npos)
      << large.err;
  EXPECT_EQ(draw({"--size", "400", "400", "--memory", "4M"}).status, 7);
  EXPECT_EQ(draw({"--size", "400", "400", "--memory", "64M"}).status, 0);
  std::stop_source stop;
  stop.request_stop();
  StoreFacts facts;
  const RefinedTin refined = slope(facts, false);
  const View view = make_view({0, 0, 10, 10}, kUnits, 50, 50);
  Canvas canvas(folder.file("b.png"), false, 50, 50);
  EXPECT_THROW(static_cast<void>(rasterize(refined, facts, view, stop.get_token())), Error);
  EXPECT_THROW(static_cast<void>(
                   draw_relief(rasterize(refined, facts, view), view, 1, {}, stop.get_token())),
               Error);
  EXPECT_THROW(draw_wireframe(canvas, refined, facts, view, stop.get_token()), Error);
}

TEST(RenderProgram, DrawsHeightsAtTheEndsOfInt32) {
  const testing::TestFolder folder;
  testing::RasterRecipe recipe;
  recipe.type = "Int32";
  recipe.value = [](int column, int row) {
    return (column + row) % 2 == 0 ? 2147483647.0 : -2147483647.0;
  };
  testing::make_raster(folder.file("ends.tif"), recipe);
  testing::expect_done({"build", folder.file("ends.tif"), "-o", folder.file("ends.ptin"), "-q"});
  testing::expect_done({"render", folder.file("ends.ptin"), "-q", "-o", folder.file("a.png")});
}

}  // namespace
}  // namespace ptin::tools
