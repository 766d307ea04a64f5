// SPDX-License-Identifier: GPL-3.0-or-later
//
// Windows whose sides were given at the centres of pixels, on pixels so small that rounding moves a
// side by much of them: what stands on the side belongs to the window, and nothing beyond it.
#include <array>
#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/tools/program.h"

namespace ptin::tools {
namespace {

using testing::answer_of;
using testing::expect_done;
using testing::TestFolder;

constexpr double kRasterWest = 151.2, kRasterNorth = -33.8;
constexpr int kRasterSide = 40;

/// The centre of a column or row, as a program computes it from the raster's corner and pixels.
double centre(double corner, int place, double pixel) { return corner + (place + 0.5) * pixel; }

/// A number moved by so many units in its last place, in all its digits.
std::string moved(double number, int ulps) {
  for (int i = 0; i < std::abs(ulps); ++i) number = std::nextafter(number, ulps * HUGE_VAL);
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.17g", number);
  return text.data();
}

/// The number as most programs write it.
std::string in_15_digits(double number) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.15g", number);
  return text.data();
}

class WindowSides : public ::testing::TestWithParam<double> {
 protected:
  static double pixel() { return GetParam(); }
  /// A plane that rises to the east, or to the south, by 1 a pixel.
  [[nodiscard]] std::string plane(bool to_the_east) const {
    testing::RasterRecipe recipe;
    recipe.width = recipe.height = kRasterSide;
    recipe.west = kRasterWest;
    recipe.north = kRasterNorth;
    recipe.pixel = pixel();
    recipe.epsg = 4326;
    recipe.value = [=](int column, int row) { return to_the_east ? column : row; };
    testing::make_raster(folder_.file("plane.tif"), recipe);
    expect_done({"build", folder_.file("plane.tif"), "-o", folder_.file("plane.ptin"), "-q"});
    return folder_.file("plane.ptin");
  }
  /// Windows from the centre of pixel (west, north) to that of (east, south): each side moved by up to
  /// two units in its last place, or written with 15 digits.
  static std::vector<std::vector<std::string>> windows(int west, int south, int east, int north) {
    const std::array<double, 4> sides = {
        centre(kRasterWest, west, pixel()), centre(kRasterNorth, south, -pixel()),
        centre(kRasterWest, east, pixel()), centre(kRasterNorth, north, -pixel())};
    std::vector<std::vector<std::string>> all;
    for (const int ulps : {-2, -1, 0, 1, 2}) {
      all.push_back({"--window", moved(sides[0], ulps), moved(sides[1], ulps),
                     moved(sides[2], -ulps), moved(sides[3], -ulps)});
    }
    all.push_back({"--window"});
    for (const double side : sides) all.back().push_back(in_15_digits(side));
    return all;
  }
  [[nodiscard]] nlohmann::json ask(std::vector<std::string> words,
                                   const std::vector<std::string>& window) const {
    words.insert(words.end(), window.begin(), window.end());
    words.emplace_back("--json");
    return answer_of(words);
  }
  [[nodiscard]] std::string file(const std::string& name) const { return folder_.file(name); }

 private:
  TestFolder folder_;
};

TEST_P(WindowSides, ExportHasThePixelsOnThem) {
  const std::string store = plane(true);
  for (int west = 0; west < 8; ++west) {
    for (const auto& window : windows(west, 31, west + 17, 12)) {
      const auto made = ask({"export", store, "-o", file("a.tif"), "--overwrite"}, window);
      EXPECT_EQ(made.at("width"), 18) << window[1] << " to " << window[3];
      EXPECT_EQ(made.at("height"), 20) << window[2] << " to " << window[4];
    }
  }
}

TEST_P(WindowSides, TheHighestAndTheLowestPointOnThemIsAVertex) {
  const std::string store = plane(true);
  for (const auto& window : windows(3, 31, 20, 12)) {
    const auto high = ask({"highest", store}, window).at("point");
    EXPECT_EQ(high.at("height"), 20) << window[3];
    EXPECT_EQ(high.at("at_vertex"), true) << window[3];
    const auto low = ask({"highest", store, "--lowest"}, window).at("point");
    EXPECT_EQ(low.at("height"), 3) << window[1];
    EXPECT_EQ(low.at("at_vertex"), true) << window[1];
  }
}

TEST_P(WindowSides, IsolinesAlongThemStay) {
  const std::string store = plane(false);
  for (const auto& window : windows(3, 31, 20, 12)) {
    for (const char* level : {"31", "12"}) {
      const auto lines =
          ask({"isoline", store, "--level", level, "-o", file("a.gpkg"), "--overwrite"}, window);
      EXPECT_EQ(lines.at("lines"), 1) << level << ", " << window[2] << " to " << window[4];
    }
  }
}

TEST_P(WindowSides, VolumesAreThoseOfWholePixels) {
  const std::string store = plane(true);
  const auto volume = [&](const std::vector<std::string>& window) {
    return ask({"volume", store, "--level", "0"}, window).at("cut").at("volume").get<double>();
  };
  const auto all = windows(3, 31, 20, 12);
  for (const auto& window : all) EXPECT_EQ(volume(window), volume(all[2])) << window[1];
}

INSTANTIATE_TEST_SUITE_P(Degrees, WindowSides, ::testing::Values(1e-4, 1e-5));

}  // namespace
}  // namespace ptin::tools
