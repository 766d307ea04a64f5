// SPDX-License-Identifier: GPL-3.0-or-later
//
// Isolines as DXF, read back by GDAL, and as LandXML, read back from its text: the lines of the
// GeoPackage.
#include <cmath>
#include <sstream>
#include <string>
#include <vector>

#include <gdal_priv.h>
#include <gtest/gtest.h>
#include <ogrsf_frmts.h>

#include "tests/tools/program.h"
#include "tools/ptin/isoline_layer.h"

namespace ptin::tools {
namespace {

using testing::answer_of;
using testing::expect_done;
using testing::Outcome;
using testing::read_file;
using testing::run_ptin;
using testing::TestFolder;

struct CadLine {
  double elevation = 0.0;
  std::vector<MapPoint> points;
  std::string layer;
};

/// Every line of a layer, by its field elev or, where it has none, by the height of its points.
std::vector<CadLine> cad_lines_in(const std::string& path) {
  GDALAllRegister();
  std::vector<CadLine> lines;
  const GDALDatasetUniquePtr dataset(GDALDataset::Open(path.c_str(), GDAL_OF_VECTOR));
  EXPECT_TRUE(dataset) << path;
  if (!dataset) return lines;
  for (const auto& feature : *dataset->GetLayer(0)) {
    const OGRLineString* geometry = feature->GetGeometryRef()->toLineString();
    const bool has_field = feature->GetFieldIndex("elev") >= 0;
    CadLine line;
    line.elevation = has_field ? feature->GetFieldAsDouble("elev") : geometry->getZ(0);
    for (int i = 0; i < geometry->getNumPoints(); ++i) {
      line.points.push_back({geometry->getX(i), geometry->getY(i)});
      if (!has_field) {
        EXPECT_EQ(geometry->getZ(i), line.elevation);
      }
    }
    if (!has_field) line.layer = feature->GetFieldAsString("Layer");
    lines.push_back(line);
  }
  return lines;
}

/// Every Contour of a LandXML file.
std::vector<CadLine> contours_in(const std::string& text) {
  const std::string start = "<Contour elev=\"";
  std::vector<CadLine> lines;
  for (std::size_t at = text.find(start); at != text.npos; at = text.find(start, at + 1)) {
    CadLine line;
    line.elevation = std::stod(text.substr(at + start.size()));
    const std::size_t begin = text.find("<PntList2D>", at) + 11;
    std::istringstream numbers(text.substr(begin, text.find('<', begin) - begin));
    for (MapPoint p; numbers >> p.y >> p.x;) line.points.push_back(p);
    lines.push_back(line);
  }
  return lines;
}

class CadIsolines : public ::testing::Test {
 protected:
  [[nodiscard]] std::string file(const std::string& name) const { return folder_.file(name); }
  void expect_lines(const std::vector<CadLine>& found, const std::vector<CadLine>& expected,
                    double rounding) const {
    ASSERT_EQ(found.size(), expected.size());
    for (std::size_t i = 0; i < found.size(); ++i) {
      EXPECT_EQ(found[i].elevation, expected[i].elevation);
      ASSERT_EQ(found[i].points.size(), expected[i].points.size());
      for (std::size_t k = 0; k < found[i].points.size(); ++k) {
        ASSERT_NEAR(found[i].points[k].x, expected[i].points[k].x, rounding);
        ASSERT_NEAR(found[i].points[k].y, expected[i].points[k].y, rounding);
      }
    }
  }
  TestFolder folder_;
};

TEST_F(CadIsolines, DxfLinesLieAtTheirHeightsOnTwoLayers) {
  const std::string store = testing::built(folder_, "mountains_257.tif");
  const std::vector<std::string> question = {"--interval", "40", "--base", "10", "-q"};
  const auto write = [&](const std::string& name) {
    std::vector<std::string> arguments = {"isoline", store, "-o", file(name)};
    arguments.insert(arguments.end(), question.begin(), question.end());
    expect_done(arguments);
  };
  write("a.gpkg");
  write("a.dxf");
  write("A.DXF");
  const std::vector<CadLine> lines = cad_lines_in(file("a.dxf"));
  expect_lines(lines, cad_lines_in(file("a.gpkg")), 1e-7);  // GDAL writes 15 digits
  std::size_t heavy = 0;
  for (const CadLine& line : lines) {
    const bool is_index = std::fmod(line.elevation - 10, 200) == 0;
    EXPECT_EQ(line.layer, is_index ? "contour_index" : "contour") << line.elevation;
    heavy += is_index ? 1 : 0;
  }
  EXPECT_GT(heavy, 5U);
  EXPECT_LT(heavy, lines.size() / 2);
  EXPECT_TRUE(read_file(file("a.dxf")) == read_file(file("A.DXF")));
  EXPECT_EQ(folder_.names(),
            (std::vector<std::string>{"A.DXF", "a.dxf", "a.gpkg", "mountains_257.tif.ptin"}));
}

TEST_F(CadIsolines, LevelsOneByOneHaveNoIndex) {
  EXPECT_FALSE(IndexLevels{}.holds(0));
  EXPECT_TRUE((IndexLevels{0.1, 0.0}.holds(0.5)));
  EXPECT_TRUE((IndexLevels{0.1, 0.0}.holds(-1.5)));
  EXPECT_FALSE((IndexLevels{0.1, 0.0}.holds(0.6)));
  EXPECT_TRUE((IndexLevels{20, 5}.holds(-95)));
  const std::string store = testing::built(folder_, "coast_257.tif");
  expect_done({"isoline", store, "--level", "0.5", "10", "-o", file("a.dxf"), "-q"});
  for (const CadLine& line : cad_lines_in(file("a.dxf"))) EXPECT_EQ(line.layer, "contour");
}

TEST_F(CadIsolines, LandXmlHasEveryDigit) {
  const std::string store = testing::built(folder_, "mountains_257.tif");
  expect_done({"isoline", store, "--interval", "40", "-o", file("a.gpkg"), "-q"});
  expect_done({"isoline", store, "--interval", "40", "-o", file("a.xml"), "-q"});
  const std::string text = read_file(file("a.xml"));
  const std::vector<CadLine> lines = contours_in(text);
  EXPECT_GT(lines.size(), 20U);
  expect_lines(lines, cad_lines_in(file("a.gpkg")), 0.0);
  EXPECT_NE(text.find("linearUnit=\"meter\""), text.npos);
  EXPECT_NE(text.find("epsgCode=\"32611\""), text.npos);
  EXPECT_TRUE(
      text.ends_with("        </Contours>\n      </SourceData>\n    </Surface>\n"
                     "  </Surfaces>\n</LandXML>\n"));
  // It is XML: the reader of surfaces finds that there is none in it.
  const Outcome none = run_ptin({"build", file("a.xml"), "-o", file("b.ptin"), "-q"});
  EXPECT_EQ(none.status, 2);
  EXPECT_EQ(none.err.find("no XML"), none.err.npos) << none.err;
}

TEST_F(CadIsolines, OfAStreamAreTheSame) {
  const std::string store = testing::built(folder_, "mountains_257.tif");
  expect_done({"stream", store, "--level", "700", "900", "-o", file("a.pts"), "-q"});
  for (const char* name : {"a.dxf", "a.xml"}) {
    expect_done({"isoline", store, "--level", "700", "900", "-o", file(name), "-q"});
    expect_done({"unstream", file("a.pts"), "--level", "700", "900", "-q", "-o",
                 file(std::string("b") + name)});
    EXPECT_TRUE(read_file(file(name)) == read_file(file(std::string("b") + name))) << name;
  }
}

TEST_F(CadIsolines, RefuseWhatHasFields) {
  const std::string store = testing::built(folder_, "coast_257.tif");
  const auto fails = [&](const std::vector<std::string>& arguments, const std::string& words) {
    const Outcome outcome = run_ptin(arguments);
    EXPECT_EQ(outcome.status, 2) << words;
    EXPECT_NE(outcome.err.find(words), std::string::npos) << outcome.err;
  };
  for (const char* name : {"a.dxf", "a.xml"}) {
    fails({"isoline", store, "--level", "5", "--polygons", "-o", file(name)},
          "has no fields, which --polygons needs; write .gpkg");
    fails({"unstream", "a.pts", "--level", "5", "--steps", "-o", file(name)},
          "has no fields, which --steps needs");
    fails({"viewshed", store, "0", "0", "2", "--radius", "9", "-o", file(name)},
          "the name must end in");
  }
  fails({"isoline", store, "--level", "5", "-o", file("a.doc")},
        "known are .gpkg, .fgb, .geojson, .shp, .dxf, .xml, and - for GeoJSON");
  EXPECT_EQ(folder_.names(), std::vector<std::string>{"coast_257.tif.ptin"});
}

}  // namespace
}  // namespace ptin::tools
