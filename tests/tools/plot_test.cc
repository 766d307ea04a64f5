// SPDX-License-Identifier: GPL-3.0-or-later
//
// Sheets, axes, and the plots of profiles and lines of sight.
#include <array>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <set>

#include <gdal_priv.h>
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "engine/error.h"
#include "tests/tools/program.h"
#include "tools/plot/axis.h"
#include "tools/plot/canvas.h"
#include "tools/plot/sight_plot.h"

namespace ptin::tools {
namespace {

using nlohmann::json;
using testing::answer_of;
using testing::expect_done;
using testing::Outcome;
using testing::read_file;
using testing::run_ptin;
using testing::spawn_ptin;
using testing::TestFolder;

RC_GTEST_PROP(RoundTicks, AreRoundAndAsManyAsThereIsRoomFor, (std::uint32_t seed)) {
  const double low = (double(seed % 20011) - 10000) * std::pow(10.0, double(seed % 19) - 9);
  const double range = double(1 + seed % 7919) * std::pow(10.0, double(seed % 17) - 9);
  const int most = 2 + static_cast<int>(seed % 12);
  const Ticks ticks = round_ticks(low, low + range, most);
  const double decade = std::pow(10.0, std::floor(std::log10(ticks.step) + 1e-9));
  const double digit = ticks.step / decade;
  RC_ASSERT(std::abs(digit - 1) < 1e-6 || std::abs(digit - 2) < 1e-6 || std::abs(digit - 5) < 1e-6);
  RC_ASSERT(ticks.at.size() <= static_cast<std::size_t>(most));
  std::set<std::string> texts;
  for (const double tick : ticks.at) {
    const double slack = 1e-9 * (std::abs(low) + range);
    RC_ASSERT(tick >= low - slack && tick <= low + range + slack);
    texts.insert(tick_text(tick, ticks.step));
  }
  RC_ASSERT(texts.size() == ticks.at.size());
  if (range > 1e-9 * std::abs(low)) {
    RC_ASSERT(double(ticks.at.size()) > double(most) / 2.5 - 2);  // one step finer would not fit
  }
}

TEST(RoundTicks, HaveTheDecimalsThatTheirStepNeeds) {
  EXPECT_EQ(round_ticks(0, 10, 11).at.size(), 11U);
  EXPECT_EQ(round_ticks(633, 1576, 7).at, (std::vector<double>{800, 1000, 1200, 1400}));
  EXPECT_EQ(round_ticks(7, 7, 5).at.size() <= 5, true);
  EXPECT_EQ(tick_text(0.30000000000000004, 0.1), "0.3");
  EXPECT_EQ(tick_text(-1e-17, 0.1), "0.0");
  EXPECT_EQ(tick_text(2500, 500), "2500");
  EXPECT_EQ(tick_text(-26690000000.05, 0.05), "-26690000000.05");
  EXPECT_EQ(tick_text(0.025, 0.005), "0.025");
}

TEST(ShownUnit, TakesKilometresForLongLinesInMetres) {
  EXPECT_EQ(shown_unit("metre", 25'000).text(25'000), "25 km");
  EXPECT_EQ(shown_unit("metre", 900).title("distance"), "distance, m");
  EXPECT_EQ(shown_unit("US survey foot", 90'000).text(90'000), "90000 ft");
  EXPECT_EQ(shown_unit("unknown", 90'000).title("distance"), "distance");
}

/// The pixel of a PNG, as GDAL reads it.
std::array<std::uint8_t, 3> pixel_of(const std::string& path, int x, int y) {
  GDALAllRegister();
  const std::unique_ptr<GDALDataset> data(GDALDataset::Open(path.c_str()));
  std::array<std::uint8_t, 3> pixel{};
  if (!data || data->GetRasterCount() != 3) return pixel;
  for (int band = 1; band <= 3; ++band) {
    EXPECT_EQ(data->GetRasterBand(band)->RasterIO(GF_Read, x, y, 1, 1,
                                                  &pixel[static_cast<std::size_t>(band - 1)], 1, 1,
                                                  GDT_Byte, 0, 0, nullptr),
              CE_None);
  }
  return pixel;
}

TEST(Canvas, WritesAnImageAsItIs) {
  const TestFolder folder;
  Image image(7, 5);
  image.put(6, 4, {255, 0, 128});
  image.put(5, 4, {10, 20, 30});
  Canvas canvas(folder.file("a.png"), false, 7, 5);
  canvas.paint(image);
  EXPECT_TRUE(folder.names().empty());
  canvas.publish();
  EXPECT_EQ(folder.names(), std::vector<std::string>{"a.png"});
  EXPECT_EQ(pixel_of(folder.file("a.png"), 6, 4), (std::array<std::uint8_t, 3>{255, 0, 128}));
  EXPECT_EQ(pixel_of(folder.file("a.png"), 5, 4), (std::array<std::uint8_t, 3>{10, 20, 30}));
  EXPECT_EQ(pixel_of(folder.file("a.png"), 0, 0), (std::array<std::uint8_t, 3>{255, 255, 255}));
  EXPECT_EQ(image.at(5, 4), (Colour{10, 20, 30}));
}

TEST(Canvas, TakesTextOfAnyBytes) {
  const TestFolder folder;
  for (const char* name : {"a.png", "a.svg", "a.pdf"}) {
    Canvas canvas(folder.file(name), false, 200, 50);
    for (const std::string& text : {std::string("\xff\xfe"), std::string("\x1b[31m"),
                                    std::string("caf\xc3\xa9"), std::string()}) {
      canvas.text({10, 20}, text);
      EXPECT_GE(canvas.text_width(text), 0);
    }
    canvas.publish();
  }
  EXPECT_EQ(folder.names().size(), 3U);
  EXPECT_THROW(Canvas(folder.file("a.jpg"), false, 5, 5), Error);
}

/// A ramp of 10 m a column, with a hole of two columns and two rows.
class Plots : public ::testing::Test {
 protected:
  Plots() {
    testing::RasterRecipe recipe;
    recipe.nodata = -9999;
    recipe.unit = "metre";
    recipe.value = [](int column, int row) {
      const bool is_hole = column >= 16 && column < 20 && row >= 10 && row < 14;
      return is_hole ? -9999.0 : 10.0 * column;
    };
    testing::make_raster(folder_.file("ramp.tif"), recipe);
    expect_done({"build", folder_.file("ramp.tif"), "-o", file_, "-q"});
  }
  /// From column to column along a row.
  static std::string line(double from, double to, int row) {
    return "(" + x_of(from) + " " + y_of(row) + "," + x_of(to) + " " + y_of(row) + ")";
  }
  static std::string x_of(double column) { return std::to_string(500015.0 + 30 * column); }
  static std::string y_of(int row) { return std::to_string(3999985 - 30 * row); }
  void plot(const std::string& lines, const std::string& name,
            const std::vector<std::string>& more = {}) const {
    std::vector<std::string> words = {"profile", file_, "--line", lines, "-o", folder_.file(name)};
    words.insert(words.end(), more.begin(), more.end());
    expect_done(words);
  }

  TestFolder folder_;
  std::string file_ = folder_.file("ramp.ptin");
};

using Pixel = std::array<std::uint8_t, 3>;
constexpr Pixel kPaper{255, 255, 255};
constexpr int kAreaLeft = 84, kAreaRight = 1172, kAreaTop = 34, kAreaBottom = 318;

TEST_F(Plots, FillGroundHatchVoidsAndLeaveTheOutsideBlank) {
  plot("LINESTRING" + line(-8, 24, 12), "p.png");  // a quarter of it lies outside
  const std::string png = folder_.file("p.png");
  const auto at = [&](double column, int y) {
    const double share = (column + 8) / 32;
    return pixel_of(png, static_cast<int>(kAreaLeft + share * (kAreaRight - kAreaLeft)), y);
  };
  EXPECT_EQ(at(-4.3, kAreaBottom - 8), kPaper);
  EXPECT_EQ(at(4.3, kAreaBottom - 3), (Pixel{224, 208, 176}));
  EXPECT_EQ(at(22.3, kAreaBottom - 100), (Pixel{224, 208, 176}));
  EXPECT_EQ(at(2.3, kAreaTop + 20), kPaper) << "above ground";
  int hatched = 0;  // of the void's pixels
  for (int y = kAreaTop + 1; y < kAreaBottom; ++y) hatched += at(16.4, y) != kPaper ? 1 : 0;
  EXPECT_GT(hatched, 40);
  EXPECT_LT(hatched, kAreaBottom - kAreaTop - 40);
}

TEST_F(Plots, DrawAPanelForEachLine) {
  plot("LINESTRING" + line(1, 9, 3), "one.png");
  plot("MULTILINESTRING(" + line(1, 9, 3) + "," + line(2, 9, 5) + "," + line(9, 30, 20) + ")",
       "three.png");
  GDALAllRegister();
  const auto height_of = [&](const char* name) {
    const std::unique_ptr<GDALDataset> data(GDALDataset::Open(folder_.file(name).c_str()));
    return data ? data->GetRasterYSize() : 0;
  };
  EXPECT_EQ(height_of("three.png") - height_of("one.png"), 2 * 370);
}

TEST_F(Plots, RefuseMorePanelsThanAPictureHasRoomFor) {
  std::string lines = "MULTILINESTRING(" + line(1, 9, 3);
  for (int i = 0; i < 12; ++i) lines += "," + line(1, 9, 4 + i);
  const Outcome outcome =
      run_ptin({"profile", file_, "--line", lines + ")", "-o", folder_.file("p.svg")});
  EXPECT_EQ(outcome.status, 2);
  EXPECT_NE(outcome.err.find("a picture has room for 12 lines, and these are 13"),
            std::string::npos)
      << outcome.err;
  EXPECT_FALSE(std::filesystem::exists(folder_.file("p.svg")));
  std::string pairs;
  for (int i = 0; i < 13; ++i) {
    pairs += x_of(1) + " " + y_of(3) + " 5 " + x_of(9 + i) + " " + y_of(3) + " 5\n";
  }
  testing::write_file(folder_.file("pairs.txt"), pairs);
  EXPECT_EQ(
      run_ptin({"sight", file_, "--pairs", folder_.file("pairs.txt"), "-o", folder_.file("p.png")})
          .status,
      2);
}

/// The time of the drawing must not show.
TEST_F(Plots, AreTheSameBytesEveryTime) {
  const std::string wkt = "LINESTRING" + line(1, 30, 12);
  for (const std::string extension : {".svg", ".pdf", ".png"}) {
    const std::string first = folder_.file("first" + extension);
    const std::string second = folder_.file("second" + extension);
    ASSERT_EQ(spawn_ptin({"profile", file_, "--line", wkt, "-o", first}).status, 0);
    ASSERT_EQ(spawn_ptin({"profile", file_, "--line", wkt, "-o", second}).status, 0);
    EXPECT_TRUE(read_file(first) == read_file(second)) << extension;
  }
  const std::string pdf = read_file(folder_.file("first.pdf"));
  EXPECT_TRUE(pdf.starts_with("%PDF-"));
  EXPECT_TRUE(pdf.ends_with("%%EOF\n"));
  EXPECT_NE(pdf.find("/CreationDate (20000101000000"), std::string::npos);
}

std::size_t count_of(const std::string& text, const std::string& word) {
  std::size_t count = 0;
  for (std::size_t at = 0; (at = text.find(word, at)) != std::string::npos; ++at) ++count;
  return count;
}

TEST_F(Plots, HoldLabelsAndHatchesAsVectors) {
  plot("LINESTRING" + line(1, 30, 12), "with.svg");
  plot("LINESTRING" + line(1, 30, 3), "without.svg");
  const std::string with = read_file(folder_.file("with.svg"));
  const std::string without = read_file(folder_.file("without.svg"));
  EXPECT_TRUE(with.ends_with("</svg>\n"));
  EXPECT_EQ(with.find("<image"), std::string::npos);
  // Ticks, units, title: a glyph each. "void" twice, and what it means, are more.
  EXPECT_GT(count_of(without, "<use "), 60U);
  EXPECT_GE(count_of(with, "<use "), count_of(without, "<use ") + 20);
  EXPECT_GT(count_of(with, "<path "), count_of(without, "<path "));
}

TEST_F(Plots, ShowTheBandOfACertificateAndStations) {
  const std::string wkt = "LINESTRING" + line(1, 30, 12);
  plot(wkt, "exact.svg");
  plot(wkt, "coarse.svg", {"--error", "30"});
  plot(wkt, "stations.svg", {"--stations", "100m"});
  const auto band = [&](const char* name) {  // half as opaque as a fill, orange
    return count_of(read_file(folder_.file(name)), "fill-opacity:0.35");
  };
  EXPECT_EQ(band("exact.svg"), 0U);
  EXPECT_GE(band("coarse.svg"), 2U) << "on a panel and in the legend";
  EXPECT_GT(count_of(read_file(folder_.file("stations.svg")), "<path "),
            count_of(read_file(folder_.file("exact.svg")), "<path ") + 6);
}

TEST_F(Plots, OfSightHaveTheLineAtTheHeightsOfTheAnswer) {
  const json answer = answer_of({"sight", file_, x_of(2), y_of(3), "15", x_of(28), y_of(25), "10",
                                 "--frequency", "900MHz", "-o", folder_.file("s.png"), "--json"});
  EXPECT_EQ(answer.at("verdict"), "visible");
  EXPECT_NE(pixel_of(folder_.file("s.png"), kAreaLeft, kAreaTop + 5), kPaper);
  PlottedSight sight;
  sight.a.height = 20 + 15;
  sight.b.height = 280 + 10;
  sight.result.length = answer.at("length");
  const json& least = answer.at("fresnel");
  EXPECT_NEAR(
      sight_height(sight, Curvature{}, least.at("distance").get<double>() / sight.result.length),
      least.at("height").get<double>(), 1e-6);
}

TEST_F(Plots, OfSightTakeEndsOnNoGroundAndAtOnePlace) {
  testing::write_file(folder_.file("pairs.csv"),
                      "id,x1,y1,h1,x2,y2,h2\nno ground," + x_of(17.5) + "," + y_of(12) + ",5," +
                          x_of(2) + "," + y_of(3) + ",5\none place," + x_of(3) + "," + y_of(3) +
                          ",5," + x_of(3) + "," + y_of(3) + ",7\n\xff\xfe," + x_of(-50) + "," +
                          y_of(3) + ",5," + x_of(-40) + "," + y_of(3) + ",7\nhidden," + x_of(1) +
                          "," + y_of(12) + ",-5," + x_of(30) + "," + y_of(12) + ",1\n");
  for (const char* name : {"s.png", "s.svg", "s.pdf"}) {
    expect_done({"sight", file_, "--pairs", folder_.file("pairs.csv"), "-o", folder_.file(name),
                 "--error", "10", "--frequency", "5.8GHz"});
    EXPECT_GT(std::filesystem::file_size(folder_.file(name)), 1000U);
  }
  expect_done({"sight", file_, "--pairs", folder_.file("pairs.csv"), "-o", folder_.file("v.png"),
               "--verdict", "--absolute"});
}

TEST_F(Plots, AreDrawnWithoutAnyFont) {
  testing::write_file(folder_.file("fonts.conf"),
                      "<?xml version=\"1.0\"?><!DOCTYPE fontconfig SYSTEM \"fonts.dtd\">"
                      "<fontconfig></fontconfig>");
  ::setenv("FONTCONFIG_FILE", folder_.file("fonts.conf").c_str(), 1);
  for (const char* name : {"p.png", "p.svg", "p.pdf"}) {
    const Outcome outcome = spawn_ptin(
        {"profile", file_, "--line", "LINESTRING" + line(1, 30, 12), "-o", folder_.file(name)});
    EXPECT_EQ(outcome.status, 0) << name << outcome.err;
    EXPECT_GT(std::filesystem::file_size(folder_.file(name)), 1000U);
  }
  ::unsetenv("FONTCONFIG_FILE");
}

TEST_F(Plots, OfTheTerrainKeepItsTrianglesAsVectors) {
  for (const char* name : {"r.svg", "r.pdf", "r.PNG"}) {
    expect_done(
        {"render", file_, "--wireframe", "--size", "200", "200", "-q", "-o", folder_.file(name)});
  }
  const std::string svg = read_file(folder_.file("r.svg"));
  EXPECT_EQ(count_of(svg, "<image "), 1U);
  const json info = answer_of({"render", file_, "--wireframe", "--size", "200", "200", "-o",
                               folder_.file("t.png"), "--json"});
  EXPECT_GT(count_of(svg, "<path "), info.at("triangles").get<std::size_t>());
  EXPECT_TRUE(read_file(folder_.file("r.pdf")).starts_with("%PDF-"));
  EXPECT_EQ(run_ptin({"render", file_, "-o", folder_.file("r.jpg")}).status, 2);
}

}  // namespace
}  // namespace ptin::tools
