// SPDX-License-Identifier: GPL-3.0-or-later
#include <cmath>
#include <memory>

#include <gdal_priv.h>
#include <gtest/gtest.h>
#include <ogr_spatialref.h>

#include "engine/error.h"
#include "tests/tools/program.h"
#include "tools/render/north.h"
#include "tools/render/overlay.h"
#include "tools/render/relief.h"
#include "tools/render/sheet.h"

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

/// A raster of heights, all of it surface.
TerrainRaster raster_of(int width, const std::vector<float>& heights) {
  TerrainRaster raster;
  raster.width = width;
  raster.height = static_cast<int>(heights.size()) / width;
  raster.heights = heights;
  raster.states.assign(heights.size(), PointState::kSurface);
  return raster;
}

/// A hundredth of the samples, ten times as high as the ground, took nine tenths of the colours.
TEST(ChooseStyle, GivesNoColoursToAFewSamplesBeyondAllOthers) {
  const View view = make_view({0, 0, 100, 100}, kUnits, 100, 100);
  std::vector<float> heights;
  for (int y = 0; y < 100; ++y) {
    for (int x = 0; x < 100; ++x) heights.push_back(100.0F + static_cast<float>(x));
  }
  const ReliefStyle even = choose_style(raster_of(100, heights), view, false, 1);
  EXPECT_EQ(even.low, 100);
  EXPECT_EQ(even.high, 199);
  EXPECT_FALSE(even.any_below || even.any_above || even.any_water || even.any_void);
  for (std::size_t i = 0; i < heights.size(); i += 100) heights[i] = 2000;
  TerrainRaster raster = raster_of(100, heights);
  raster.states[1] = PointState::kVoid;
  const ReliefStyle style = choose_style(raster, view, false, 1);
  EXPECT_TRUE(style.any_above && style.any_void);
  EXPECT_LT(style.high, 260);
  EXPECT_GT(style.high, 199);
}

TEST(Layout, KeepsTheMapWithinASheetAndLeavesASmallOneAlone) {
  SheetText text;
  text.title = "Mountains";
  text.foot = std::string(300, 'x') + " " + std::string(300, 'y');
  const auto within = layout_within(900, 700, text);
  ASSERT_TRUE(within);
  EXPECT_EQ(within->foot.size(), 2U);
  EXPECT_GT(within->map.left, 0);
  EXPECT_LT(within->map.right, 900);
  EXPECT_LT(within->map.bottom, 700 - 2 * 14);
  const auto around = layout_around(static_cast<int>(within->map.width()),
                                    static_cast<int>(within->map.height()), text);
  ASSERT_TRUE(around);
  EXPECT_EQ(around->width, 900);
  EXPECT_EQ(around->height, 700);
  EXPECT_FALSE(layout_within(300, 300, text));
}

/// By the formula of the convergence of meridians: that of the difference of longitude times the sine
/// of the latitude, to a part in a thousand near the middle of a zone.
TEST(NorthAt, IsWhereTheMeridianGoes) {
  const auto facts_of = [](int code) {
    OGRSpatialReference crs;
    crs.importFromEPSG(code);
    char* wkt = nullptr;
    crs.exportToWkt(&wkt);
    const CrsFacts facts = crs_facts(std::string(wkt));
    CPLFree(wkt);
    return facts;
  };
  constexpr double kDegree = M_PI / 180;
  EXPECT_EQ(north_at({7, 45}, facts_of(4326)), 0.0);
  EXPECT_NEAR(north_at({500'000, 5'000'000}, facts_of(32632)).value(), 0, 1e-9);
  // 8 E 45 N lies one degree west of the middle of zone 32: north is to the right of up.
  EXPECT_NEAR(north_at({421'184.7, 4'983'436.8}, facts_of(32632)).value(),
              1 * kDegree * std::sin(45 * kDegree), 1e-5);
  // The axes of South Africa's CRS point west and south.
  EXPECT_NEAR(std::abs(north_at({100, 2'800'000}, facts_of(2053)).value()), M_PI, 1e-3);
  EXPECT_FALSE(north_at({0, 0}, CrsFacts{}));
}

/// Ten thousand triangles to a pixel were a black square.
TEST(DrawWireframe, LeavesDenseTrianglesGrey) {
  constexpr std::int32_t kSide = 150;
  StoreFacts facts;
  RefinedTin refined = slope(facts, false);
  Tin& tin = refined.tin;
  tin = {};
  for (std::int32_t y = 0; y < kSide; ++y) {
    for (std::int32_t x = 0; x < kSide; ++x) {
      tin.vertices.push_back({{x, y}, facts.heights.bits(0), 0});
      tin.has_height.push_back(1);
      const auto v = static_cast<VertexId>(y * kSide + x);
      if (x + 1 == kSide || y + 1 == kSide) continue;
      tin.triangles.push_back({{v, v + 1, v + kSide}, {kNone, kNone, kNone}});
      tin.triangles.push_back({{v + 1, v + kSide + 1, v + kSide}, {kNone, kNone, kNone}});
    }
  }
  tin.classes.assign(tin.triangles.size(), TriangleClass::kSurface);
  const testing::TestFolder folder;
  const View view = make_view({0, 0, kSide - 1, kSide - 1}, kUnits, 30, 30);
  Canvas canvas(folder.file("dense.png"), false, 30, 30);
  draw_wireframe(canvas, refined, facts, view);
  canvas.publish();
  GDALAllRegister();
  const std::unique_ptr<GDALDataset> picture(GDALDataset::Open(folder.file("dense.png").c_str()));
  ASSERT_TRUE(picture);
  std::vector<std::uint8_t> grey(30 * 30);
  ASSERT_EQ(picture->GetRasterBand(1)->RasterIO(GF_Read, 0, 0, 30, 30, grey.data(), 30, 30,
                                                GDT_Byte, 0, 0),
            CE_None);
  const auto middle = grey[15 * 30 + 15];
  EXPECT_GT(middle, 90);
  EXPECT_LT(middle, 250);
}

TEST(Render, DrawsContoursAndSheetsOfEveryStyle) {
  const testing::TestFolder folder;
  const std::string store = testing::built(folder, "mountains_257.tif");
  const auto svg_of = [&](std::vector<std::string> more, const std::string& name) {
    more.insert(more.begin(),
                {"render", store, "--size", "400", "420", "-q", "-o", folder.file(name)});
    testing::expect_done(more);
    return testing::read_file(folder.file(name));
  };
  const auto paths_of = [](const std::string& svg) {
    std::size_t count = 0;
    for (auto at = svg.find("<path "); at != std::string::npos; at = svg.find("<path ", at + 1))
      ++count;
    return count;
  };
  const std::string map = svg_of({}, "map.svg"), plain = svg_of({"--style", "plain"}, "plain.svg");
  EXPECT_GT(paths_of(map), paths_of(plain) + 20);
  const std::string lines = svg_of({"--contours", "200", "--error", "10"}, "lines.svg");
  const std::string feet = svg_of({"--contours", "656.16798ft", "--error", "10"}, "feet.svg");
  EXPECT_GT(paths_of(lines), paths_of(map) + 20);
  EXPECT_NEAR(double(paths_of(feet)), double(paths_of(lines)), 0.1 * double(paths_of(lines)));
  const auto image_width_of = [](const std::string& svg) {
    const std::string width = "width=\"";
    const auto at = svg.find(width, svg.find("<image "));
    return std::stod(svg.substr(at + width.size(), 8));
  };
  const double pixels = image_width_of(map);
  EXPECT_GT(pixels, 250);
  EXPECT_NEAR(image_width_of(svg_of({"--style", "print"}, "print.svg")), 3.125 * pixels, 1);
  for (const std::vector<std::string>& bad :
       {std::vector<std::string>{"--contours", "0"}, {"--contours", "-5"}, {"--style", "poster"}}) {
    std::vector<std::string> words = {"render", store, "-o", folder.file("bad.png")};
    words.insert(words.end(), bad.begin(), bad.end());
    EXPECT_EQ(testing::run_ptin(words).status, 2) << bad[0];
  }
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
  const auto large = draw({"--size", "32767", "32767", "--style", "plain"});
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
