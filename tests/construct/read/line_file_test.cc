// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/read/line_file.h"

#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "engine/construct/grid/decimal.h"
#include "engine/error.h"
#include "tests/construct/made_raster.h"

namespace ptin {
namespace {

/// The lines of a file in short, or what its refusal says.
std::string lines_in(const std::string& name, const std::string& content,
                     LayerKind kind = LayerKind::kLines, const std::string& layer = "") {
  const oracle::ScratchFolder folder;
  oracle::write_text(folder.file(name), content);
  std::string text;
  try {
    const LineFileCrs facts =
        read_line_file(folder.file(name), {kind, layer, "--option"},
                       [&](const std::vector<SourcePoint>& line, bool) {
                         for (const SourcePoint& v : line) {
                           for (const Decimal d : {v.x, v.y, v.z}) {
                             text += std::to_string(std::lround(to_double(d) * 10)) + " ";
                           }
                         }
                         text += "| ";
                       },
                       {});
    return text + facts.crs + (facts.is_flat ? "without heights" : "");
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ErrorCode::invalid_argument) << e.what();
    return e.message();
  }
}

std::string csv(const std::string& wkt) { return "id,WKT\n1,\"" + wkt + "\"\n"; }

TEST(LineFile, ReadsLinesOfEveryKind) {
  EXPECT_EQ(lines_in("a.csv", csv("LINESTRING Z (1 2 3,4 5.5 6)")), "10 20 30 40 55 60 | ");
  EXPECT_EQ(lines_in("a.csv", csv("MULTILINESTRING Z ((1 2 3,4 5 6),(7 8 9,1 1 1))")),
            "10 20 30 40 50 60 | 70 80 90 10 10 10 | ");
  EXPECT_EQ(
      lines_in("a.csv", csv("POLYGON Z ((0 0 1,4 0 1,4 4 1,0 0 1),(1 0 2,2 0 2,2 1 2,1 0 2))"),
               LayerKind::kAreas),
      "0 0 10 40 0 10 40 40 10 0 0 10 | 10 0 20 20 0 20 20 10 20 10 0 20 | ");
}

TEST(LineFile, TellsLinesWithoutHeightsAndRefusesWhatIsNone) {
  const auto refusal = [](const std::string& wkt, LayerKind kind = LayerKind::kLines) {
    return lines_in("a.csv", csv(wkt), kind);
  };
  EXPECT_EQ(refusal("LINESTRING (1 2,4 5)"), "10 20 0 40 50 0 | without heights");
  EXPECT_EQ(refusal("POLYGON ((0 0,1 0,1 1,0 0))", LayerKind::kAreas),
            "0 0 0 10 0 0 10 10 0 0 0 0 | without heights");
  EXPECT_NE(refusal("POINT Z (1 2 3)").find("this is a POINT, not a line"), std::string::npos);
  EXPECT_NE(refusal("LINESTRING Z (1 2 3,4 5 6)", LayerKind::kAreas).find("not a polygon"),
            std::string::npos);
  EXPECT_NE(refusal("CIRCULARSTRING Z (0 0 1,1 1 1,2 0 1)").find("straight sides"),
            std::string::npos);
  EXPECT_NE(refusal("LINESTRING Z (1 2 1e300,4 5 6)").find("infinite or"), std::string::npos);
  EXPECT_NE(refusal("LINESTRING Z EMPTY").find("there is no line in layer"), std::string::npos);
  EXPECT_NE(lines_in("a.txt", "nothing").find("no vector data"), std::string::npos);
}

constexpr const char* kHead =
    "<?xml version=\"1.0\"?><LandXML xmlns=\"http://www.landxml.org/schema/LandXML-1.2\">"
    "<CoordinateSystem epsgCode=\"25832\"/><Surfaces>";
constexpr const char* kOne =
    "<Surface name=\"one\"><SourceData><Boundaries><Boundary bndType=\"outer\">"
    "<PntList3D>0 0 5 0 9 5 9 9 5</PntList3D></Boundary></Boundaries>"
    "<Breaklines><Breakline brkType=\"standard\"><PntList3D>20 10 3\n50 40 "
    "6</PntList3D></Breakline>"
    "</Breaklines></SourceData></Surface>";
constexpr const char* kTail = "</Surfaces></LandXML>";

TEST(LineFile, ReadsLandXmlWithNorthingBeforeEasting) {
  const std::string xml = std::string(kHead) + kOne + kTail;
  EXPECT_EQ(lines_in("a.xml", xml), "100 200 30 400 500 60 | EPSG:25832");
  EXPECT_EQ(lines_in("a.XML", xml, LayerKind::kAreas),
            "0 0 50 90 0 50 90 90 50 0 0 50 | EPSG:25832");
}

TEST(LineFile, RefusesLandXmlWithoutLinesOrWithThoseOfSeveralSurfaces) {
  std::string other(kOne);
  other.replace(other.find("one"), 3, "two");
  const std::string two = std::string(kHead) + kOne + other + kTail;
  EXPECT_NE(lines_in("a.xml", two).find("'one', 'two'; name one with --option"), std::string::npos);
  EXPECT_EQ(lines_in("a.xml", two, LayerKind::kLines, "two"), "100 200 30 400 500 60 | EPSG:25832");
  EXPECT_NE(lines_in("a.xml", two, LayerKind::kLines, "three").find("there is no Breakline"),
            std::string::npos);
  EXPECT_NE(lines_in("a.xml", std::string(kHead) + kTail).find("there is no Breakline"),
            std::string::npos);
  std::string flat(kOne);
  flat.replace(flat.find("<PntList3D>20 10 3\n50 40 6</PntList3D>"), 38,
               "<PntList2D>2 1</PntList2D>");
  EXPECT_EQ(lines_in("a.xml", std::string(kHead) + flat + kTail),
            "10 20 0 | EPSG:25832without heights");
  std::string odd(kOne);
  odd.replace(odd.find("20 10 3"), 7, "20 10");
  EXPECT_NE(lines_in("a.xml", std::string(kHead) + odd + kTail).find("has 5 numbers"),
            std::string::npos);
}

}  // namespace
}  // namespace ptin
