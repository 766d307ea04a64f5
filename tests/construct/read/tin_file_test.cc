// SPDX-License-Identifier: GPL-3.0-or-later
//
// The readers of PLY, OBJ, 2DM and LandXML: what they take and what they refuse.
#include "engine/construct/read/tin_file.h"

#include <cstring>

#include <gtest/gtest.h>

#include "engine/error.h"
#include "tests/support/read_soup.h"

namespace ptin {
namespace {

using test::read_soup;
using test::TinSoup;

using Reader = TinReader*;

TinSoup parse(Reader reader, const std::string& content, const TinReading& reading = {}) {
  ByteReader in("file", content);
  return read_soup(*reader, in, reading);
}

std::string refusal_of(Reader reader, const std::string& content, const TinReading& reading = {}) {
  try {
    static_cast<void>(parse(reader, content, reading));
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ErrorCode::invalid_argument) << e.what();
    EXPECT_TRUE(e.context().starts_with("file")) << e.context();
    return e.what();
  }
  return "accepted";
}

::testing::AssertionResult says(const std::string& what, const std::string& words) {
  return what.find(words) != std::string::npos ? ::testing::AssertionSuccess()
                                               : ::testing::AssertionFailure() << what;
}

template <typename T>
std::string raw(T value, bool big) {
  std::string bytes(sizeof value, '\0');
  std::memcpy(bytes.data(), &value, sizeof value);
  return big ? std::string(bytes.rbegin(), bytes.rend()) : bytes;
}

std::string binary_ply(bool big) {
  std::string s = "ply\nformat binary_" + std::string(big ? "big" : "little") +
                  "_endian 1.0\ncomment crs: EPSG:32611\ncomment vertical_crs: EPSG:5773\n"
                  "element vertex 4\nproperty uchar red\nproperty float x\nproperty double y\n"
                  "property short z\nproperty list uchar int extra\n"
                  "element face 2\nproperty list uchar uint vertex_indices\nend_header\n";
  const float x[4] = {0.1F, 10, 10, 0};
  const double y[4] = {0, 0.5, 10, 10};
  for (int i = 0; i < 4; ++i) {
    s += raw<unsigned char>(7, big) + raw(x[i], big) + raw(y[i], big) +
         raw(static_cast<std::int16_t>(i - 1), big) + raw<unsigned char>(2, big) + raw(1, big) +
         raw(2, big);
  }
  for (const auto& t : {std::array<std::uint32_t, 3>{0, 1, 2}, {0, 2, 3}}) {
    s += raw<unsigned char>(3, big);
    for (const std::uint32_t v : t) s += raw(v, big);
  }
  return s;
}

const std::string kAsciiPly =
    "ply\r\nformat ascii 1.0\r\ncomment crs: EPSG:32611\nelement face 2\n"
    "property list uchar int vertex_index\nelement vertex 4\nproperty double z\n"
    "property double x\nproperty double y\nend_header\n"
    "3 0 1 2\n3 0 2 3\n-1 0.1 0\n0 10 0.5\n1 10 10\n\n2 0 10\n";

void expect_square(const TinSoup& soup) {
  ASSERT_EQ(soup.vertices.size(), 4U);
  EXPECT_EQ(soup.vertices[0].x, (Decimal{1, 1}));
  EXPECT_EQ(soup.vertices[0].z, (Decimal{-1, 0}));
  EXPECT_EQ(soup.vertices[1].y, (Decimal{5, 1}));
  EXPECT_EQ(soup.vertices[3].y, (Decimal{10, 0}));
  ASSERT_EQ(soup.triangles.size(), 2U);
  EXPECT_EQ(soup.triangles[1], (std::array<std::uint32_t, 3>{0, 2, 3}));
}

const std::string kObj =
    "v 0.1 0 -1 0.5 0.5 0.5\nv 10 0.5 0\nvn 0 0 1\nv 10 10 1\nf 1/1 2/2 3/3\n"
    "v 0 10 2 # the last\n#f 1 2\nf -4 -2//1 -1 # 4 3 4\n";
const std::string kTwoDm =
    "MESH2D\nMESHNAME \"m\"\nE3T 1 11 22 33 1\nND 11 0.1 0 -1\nND 22 10 0.5 0\n"
    "ND 33 10 10 1\nND 5 0 10 2\nE3T 2 11 33 5 1\nNS 11 22 -33\n";
std::string land_xml(const std::string& inside) {
  return "<?xml version=\"1.0\"?>\n<LandXML xmlns=\"http://www.landxml.org/schema/LandXML-1.2\">"
         "<CoordinateSystem epsgCode=\"3007\"/><Surfaces>" +
         inside + "</Surfaces></LandXML>";
}
const std::string kSurface =
    "<Surface name=\"top\"><Definition surfType=\"TIN\"><Pnts><P id=\"7\">0 0.1 -1</P>"
    "<P id=\"8\">0.5 10\n 0</P><P id=\"9\">10 10 1</P><P id=\"1\">10 0 2</P></Pnts>"
    "<Faces><F>7 8 9</F><F n=\"1 0 0\">7 9 1</F><F i=\"1\">7 8 "
    "1</F></Faces></Definition></Surface>";

TEST(TinSoup, EveryFormatGivesTheSame) {
  expect_square(parse(read_ply, kAsciiPly));
  expect_square(parse(read_ply, binary_ply(false)));
  expect_square(parse(read_ply, binary_ply(true)));
  expect_square(parse(read_obj, kObj));
  expect_square(parse(read_two_dm, kTwoDm));
  const TinSoup xml = parse(read_land_xml, land_xml(kSurface));
  expect_square(xml);
  EXPECT_EQ(xml.facts.hidden_triangles, 1U);
  EXPECT_EQ(xml.facts.crs, "EPSG:3007");
  EXPECT_EQ(parse(read_ply, kAsciiPly).facts.crs, "EPSG:32611");
  EXPECT_EQ(parse(read_ply, binary_ply(true)).facts.vertical_crs, "EPSG:5773");
}

TEST(TinSoup, KnowsTinsByTheirNames) {
  for (const char* name : {"a.ply", "b.OBJ", "c.2dm", "d.xml", "e.LandXML"})
    EXPECT_TRUE(is_tin_file(name));
  for (const char* name : {"a.tif", "ply", "a.ply.gz", "a.csv"}) EXPECT_FALSE(is_tin_file(name));
}

TEST(TinSoup, EveryTextMayEndItsLinesInCr) {
  const auto with_ends = [](const std::string& text, const std::string& end) {
    std::string all;
    for (const char c : text) {
      if (c == '\n') {
        all += end;
      } else if (c != '\r') {
        all += c;
      }
    }
    return all;
  };
  for (const char* end : {"\r", "\r\n", "\n\r"}) {
    expect_square(parse(read_ply, with_ends(kAsciiPly, end)));
    expect_square(parse(read_obj, with_ends(kObj, end)));
    expect_square(parse(read_two_dm, "\xEF\xBB\xBF" + with_ends(kTwoDm, end)));
  }
  for (TinReader* const read : {read_ply, read_obj, read_two_dm}) {
    EXPECT_TRUE(says(refusal_of(read, "\xFF\xFEv"), "UTF-16"));
  }
}

/// The first byte behind a header of CRs is an LF by chance.
TEST(Ply, EndsAHeaderOfCrsInItsCr) {
  std::string text =
      "ply\rformat binary_little_endian 1.0\relement vertex 3\rproperty uchar x\rproperty uchar y\r"
      "property uchar z\relement face 1\rproperty list uchar uchar vertex_index\rend_header\r";
  text += {'\n', 0, 0, 9, 0, 0, 0, 9, 0, 3, 0, 1, 2};
  const TinSoup soup = parse(read_ply, text);
  ASSERT_EQ(soup.vertices.size(), 3U);
  EXPECT_EQ(soup.vertices[0].x, (Decimal{10, 0}));
}

TEST(Ply, TakesNamesInCapitalsAndBlanksBehindThem) {
  expect_square(parse(read_ply,
                      "ply \t\nformat ascii 1.0 \ncomment made by hand\nelement vertex 4\n"
                      "property double X\nproperty double Y\nproperty double Z\n"
                      "element face 2\nproperty list uchar int Vertex_Indices\nend_header\n"
                      "0.1 0 -1\n10 0.5 0\n10 10 1\n0 10 2\n3 0 1 2\n3 0 2 3\n"));
  const std::string file =
      "ply\nformat ascii 1.0\ncomment EPSG: 2222\ncomment units: ft\nelement vertex 3\nproperty "
      "float x\nproperty float y\nproperty float z\nelement face 1\n"
      "property list uchar int vertex_index\nend_header\n0 0 0\n1 0 0\n0 1 0";
  const TinFileFacts facts = parse(read_ply, file + "\n3 0 1 2").facts;
  EXPECT_EQ(facts.crs, "EPSG:2222");
  EXPECT_EQ(facts.units, (DeclaredUnits{"", "foot"}));
  EXPECT_TRUE(says(refusal_of(read_ply, file + " 7\n3 0 1 2\n"), "more values"));
}

using Quads = std::vector<std::array<std::uint32_t, 4>>;
using Triangles = std::vector<std::array<std::uint32_t, 3>>;

TEST(TinSoup, HoldsQuads) {
  const std::string obj = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";
  EXPECT_EQ(parse(read_obj, obj + "f 1 2 3 4\n").quads, (Quads{{0, 1, 2, 3}}));
  EXPECT_EQ(parse(read_obj, obj + "f 1 2 3 3\n").triangles, (Triangles{{2, 0, 1}}));
  EXPECT_EQ(parse(read_obj, obj + "f 1 2\\\n  3 \\ \n4\nf 1 2 3").quads, (Quads{{0, 1, 2, 3}}));
  const std::string nodes =
      "mesh2d\nND 1 0 0 0\nND 2 1 0 0\nND 3 2 0 0\nND 4 2 1 0\nND 5 2 2 0\nND 6 1 2 0\nND 7 0 2 0\n"
      "ND 8 0 1 0\nND 9 1 1 0\nE2L 7 1 2 1\n";
  EXPECT_EQ(parse(read_two_dm, nodes + "E4Q 1 1 3 5 7 1\n").quads, (Quads{{0, 2, 4, 6}}));
  const TinSoup six = parse(read_two_dm, nodes + "E6T 1 1 2 3 9 7 8 1\n");
  EXPECT_EQ(six.triangles, (Triangles{{0, 1, 7}, {2, 8, 1}, {6, 7, 8}, {1, 8, 7}}));
  const TinSoup eight = parse(read_two_dm, nodes + "E8Q 1 1 2 3 4 5 6 7 8 1\n");
  EXPECT_EQ(eight.triangles, (Triangles{{0, 1, 7}, {2, 3, 1}, {4, 5, 3}, {6, 7, 5}}));
  EXPECT_EQ(eight.quads, (Quads{{1, 3, 5, 7}}));
  EXPECT_EQ(parse(read_two_dm, nodes + "E9Q 1 1 2 3 4 5 6 7 8 9 1\n").quads,
            (Quads{{0, 1, 8, 7}, {2, 3, 8, 1}, {4, 5, 8, 3}, {6, 7, 8, 5}}));
  const std::string ply =
      "ply\nformat ascii 1.0\nelement vertex 4\nproperty int x\nproperty int y\nproperty int z\n"
      "element face 1\nproperty list uchar int vertex_index\nend_header\n0 0 0\n1 0 0\n1 1 0\n0 1 "
      "0\n";
  EXPECT_EQ(parse(read_ply, ply + "4 0 1 2 3\n").quads, (Quads{{0, 1, 2, 3}}));
  EXPECT_TRUE(says(refusal_of(read_ply, ply + "5 0 1 2 3 3\n"), "face 0: a face has 5 corners"));
}

TEST(LandXml, NumbersPointsThatHaveNoId) {
  const auto with = [](const std::string& points) {
    return land_xml("<Surface name='s'><Definition><Pnts>" + points +
                    "</Pnts><Faces><F>1 2 3 4</F></Faces></Definition></Surface>");
  };
  EXPECT_EQ(
      parse(read_land_xml, with("<P>0 0 1</P><P>0 9 1</P><P>9 9 1</P><P id=''>9 0 1</P>")).quads,
      (Quads{{0, 1, 2, 3}}));
  EXPECT_TRUE(
      says(refusal_of(read_land_xml, with("<P>0 0 1</P><P id='2'>0 9 1</P>")), "has an id"));
  EXPECT_TRUE(
      says(refusal_of(read_land_xml, with("<P id='1'>0 0 1</P><P>0 9 1</P>")), "has no id"));
  EXPECT_TRUE(says(refusal_of(read_land_xml, with("<P id='1' pntRef='CP7'/>")), "'CP7' (pntRef)"));
  EXPECT_TRUE(says(refusal_of(read_land_xml, with("<P id='1'>0 0</P>")), "has 2 numbers"));
}

TEST(LandXml, NamesASurfaceByItsPlace) {
  const std::string two = land_xml(kSurface + "<Surface name='top'/>" + kSurface);
  expect_square(parse(read_land_xml, two, {"#1", {}, {}}));
  expect_square(parse(read_land_xml, two, {"#3", {}, {}}));
  EXPECT_TRUE(says(refusal_of(read_land_xml, two, {"top", {}, {}}), "as in --layer '#3'"));
  EXPECT_TRUE(says(refusal_of(read_land_xml, two), "as in --layer '#3'"));
  EXPECT_TRUE(says(refusal_of(read_land_xml, two, {"#4", {}, {}}), "no surface '#4'"));
  expect_square(
      parse(read_land_xml, land_xml("<Surface name='lines'><SourceData/></Surface>" + kSurface)));
}

TEST(LandXml, IsReadInTheEncodingThatItNames) {
  const auto in_encoding = [](const std::string& encoding, const std::string& name) {
    std::string text = land_xml(kSurface);
    text.replace(0, text.find('>') + 1, "<?xml version=\"1.0\" encoding=\"" + encoding + "\"?>");
    return text.replace(text.find("top"), 3, name);
  };
  const TinReading wanted{"Gel\u00e4nde \u20ac", {}, {}};
  expect_square(parse(read_land_xml, in_encoding("Windows-1252", "Gel\xE4nde \x80"), wanted));
  expect_square(parse(read_land_xml, in_encoding("ISO-8859-15", "Gel\xE4nde \xA4"), wanted));
  expect_square(
      parse(read_land_xml, in_encoding("Shift_JIS", "\x92\x6E\x8C\x60"), {"\u5730\u5f62", {}, {}}));
  EXPECT_TRUE(says(refusal_of(read_land_xml, in_encoding("no-such", "a")), "save it as UTF-8"));
}

std::vector<std::string> kinds_of(const TinFileFacts& facts) {
  std::vector<std::string> kinds;
  for (const SourceWarning& w : facts.warnings.all()) kinds.push_back(w.kind);
  return kinds;
}

TEST(LandXml, WarnsOfWhatIsToldInWords) {
  const auto with_system = [](const std::string& attributes) {
    std::string text = land_xml(kSurface);
    const std::size_t at = text.find("epsgCode=\"3007\"");
    return text.replace(at, 15, attributes);
  };
  const auto facts_of = [&](const std::string& attributes) {
    return parse(read_land_xml, with_system(attributes)).facts;
  };
  EXPECT_EQ(facts_of("epsgCode='EPSG:3007'").crs, "EPSG:3007");
  EXPECT_EQ(facts_of("ogcWktCode='LOCAL_CS[&quot;site&quot;]'").crs, "LOCAL_CS[\"site\"]");
  EXPECT_EQ(facts_of("epsgCode='3007' verticalDatum='5613'").vertical_crs, "EPSG:5613");
  EXPECT_EQ(kinds_of(facts_of("horizontalDatum='NAD83'")),
            std::vector<std::string>{"crs_in_words"});
  EXPECT_EQ(kinds_of(facts_of("epsgCode='3007' verticalDatum='NAVD88'")),
            std::vector<std::string>{"vertical_crs_in_words"});
  EXPECT_EQ(kinds_of(facts_of("epsgCode='3007' rotationAngle='12.5'")),
            std::vector<std::string>{"turned_coordinates"});
  EXPECT_EQ(kinds_of(facts_of("epsgCode='3007' rotationAngle='0.0'")), std::vector<std::string>{});
}

TEST(LandXml, NamesItsUnits) {
  const struct {
    const char* units;
    DeclaredUnits expected;
  } cases[] = {
      {R"(<Metric linearUnit="meter" areaUnit="squareMeter"/>)", {"metre", "metre"}},
      {R"(<Metric linearUnit="millimeter" elevationUnit="meter"/>)", {"millimetre", "metre"}},
      {R"(<Imperial linearUnit="foot" elevationUnit="feet"/>)", {"foot", "foot"}},
      {R"(<Imperial linearUnit="USSurveyFoot"/>)", {"US survey foot", "US survey foot"}},
      {R"(<Imperial linearUnit="USSurveyFoot" elevationUnit="feet"/>)",
       {"US survey foot", "US survey foot"}},
      {R"(<Imperial linearUnit="mile" elevationUnit="meter"/>)", {"Statute mile", "metre"}},
      {R"(<Imperial areaUnit="acre"/>)", {"", ""}}};
  for (const auto& c : cases) {
    const std::string text = land_xml(kSurface);
    const std::size_t at = text.find("<CoordinateSystem");
    const std::string with =
        text.substr(0, at) + "<Units>" + c.units + "</Units>" + text.substr(at);
    EXPECT_EQ(parse(read_land_xml, with).facts.units, c.expected) << c.units;
  }
  EXPECT_EQ(parse(read_land_xml, land_xml(kSurface)).facts.units, DeclaredUnits());
}

/// A file cut anywhere is refused, or lacks nothing that matters.
TEST(TinSoup, RefusesFilesThatAreCutShort) {
  for (const std::string& whole : {binary_ply(false), binary_ply(true)}) {
    for (std::size_t n = 0; n < whole.size(); ++n) {
      EXPECT_NE(refusal_of(read_ply, whole.substr(0, n)), "accepted") << n;
    }
  }
  for (std::size_t n = 0; n + 8 < kAsciiPly.size(); ++n) {
    EXPECT_NE(refusal_of(read_ply, kAsciiPly.substr(0, n)), "accepted") << n;
  }
  const std::string xml = land_xml(kSurface);
  for (std::size_t n = 0; n < xml.size(); ++n) {
    EXPECT_NE(refusal_of(read_land_xml, xml.substr(0, n)), "accepted") << n;
  }
}

TEST(TinSoup, DoesNotBelieveCounts) {
  const auto with_counts = [](const std::string& vertices, const std::string& faces,
                              const std::string& format) {
    return "ply\nformat " + format + " 1.0\nelement vertex " + vertices +
           "\nproperty double x\nproperty double y\nproperty double z\nelement face " + faces +
           "\nproperty list uchar int vertex_indices\nend_header\n";
  };
  for (const char* format : {"ascii", "binary_little_endian"}) {
    for (const char* count : {"9223372036854775807", "4294967296", "1000000000"}) {
      EXPECT_TRUE(says(refusal_of(read_ply, with_counts(count, "1", format)), "claims"));
      EXPECT_TRUE(says(refusal_of(read_ply, with_counts("0", count, format)), "claims"));
    }
    EXPECT_TRUE(says(refusal_of(read_ply, with_counts("-1", "1", format)), "negative"));
    EXPECT_TRUE(says(refusal_of(read_ply, with_counts("18446744073709551616", "1", format)),
                     "whole number"));
  }
}

TEST(TinSoup, RefusesWhatIsNoTriangleMesh) {
  EXPECT_TRUE(says(refusal_of(read_ply, "plx\n"), "begins with"));
  EXPECT_TRUE(says(refusal_of(read_ply,
                              "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty "
                              "float y\nend_header\n1 2\n"),
                   "no property z"));
  EXPECT_TRUE(says(refusal_of(read_obj, "v 0 0 0\nv 1 0 0\nf 1 2\n"), "2 corners"));
  EXPECT_TRUE(
      says(refusal_of(read_obj, "v 0 0 0\nf 1 1 1 1 1\n"), "5 corners; triangles and quads"));
  EXPECT_TRUE(says(refusal_of(read_obj, "v 0 0 0\nsurf 0 1 0 1 1 1\n"), "surface of curves"));
  EXPECT_TRUE(says(refusal_of(read_obj, "v 0 0 0\nf 1 2 3\n"), "vertex 1, which is not there"));
  EXPECT_TRUE(says(refusal_of(read_obj, "v 0 0 0\nf -1 -2 1\n"), "which is not there"));
  EXPECT_TRUE(says(refusal_of(read_obj, "v 0 0 0\nf 0 1 1\n"), "numbered from 1"));
  EXPECT_TRUE(says(refusal_of(read_obj, "v 0 nan 0\n"), "not a finite number"));
  EXPECT_TRUE(says(refusal_of(read_obj, "v 0 1e30 0\n"), "10^18"));
  EXPECT_TRUE(says(refusal_of(read_obj, "v 0 x 0\n"), "where a number belongs"));
  EXPECT_TRUE(says(refusal_of(read_obj, "v 0 0 0\n"), "no triangle"));
  EXPECT_TRUE(says(refusal_of(read_obj, ""), "no vertex"));
  EXPECT_TRUE(says(refusal_of(read_obj, std::string(70'000, 'v')), "64 KiB"));
  EXPECT_TRUE(says(refusal_of(read_two_dm, "MESH2D\nE4Q 1 1 2 3\n"), "an id and 4 nodes"));
  EXPECT_TRUE(says(refusal_of(read_two_dm, "MESH2D\nND 1 0 0 0\nND 1 1 0 0\n"),
                   "two vertices have the id 1"));
  EXPECT_TRUE(says(refusal_of(read_two_dm, "ND 1 0 0 0\n"), "MESH2D"));
}

TEST(TinSoup, ChoosesAmongSurfaces) {
  std::string second = kSurface;
  second.replace(second.find("top"), 3, "low");
  const std::string both = land_xml(kSurface + second);
  EXPECT_TRUE(says(refusal_of(read_land_xml, both), "--layer"));
  expect_square(parse(read_land_xml, both, {"low", {}, {}}));
  EXPECT_TRUE(says(refusal_of(read_land_xml, both, {"mid", {}, {}}), "'top', 'low'"));
  EXPECT_TRUE(says(refusal_of(read_land_xml, land_xml("")), "no surface"));
  EXPECT_TRUE(
      says(refusal_of(read_land_xml,
                      land_xml("<Surface name='g'><Definition surfType='grid'/></Surface>")),
           "grid"));
}

TEST(TinSoup, HasNoEntitiesAndNoDepths) {
  const std::string bomb =
      "<?xml version=\"1.0\"?><!DOCTYPE l [<!ENTITY a \"aaaaaaaaaa\"><!ENTITY b \"&a;&a;&a;\">]>"
      "<LandXML>&b;</LandXML>";
  EXPECT_TRUE(says(refusal_of(read_land_xml, bomb), "document type"));
  EXPECT_TRUE(
      says(refusal_of(read_land_xml, "<!DOCTYPE l SYSTEM \"file:///etc/passwd\"><LandXML/>"),
           "document type"));
  std::string deep = "<LandXML>";
  for (int i = 0; i < 100'000; ++i) deep += "<a>";
  EXPECT_TRUE(says(refusal_of(read_land_xml, deep), "64 deep"));
  EXPECT_TRUE(says(
      refusal_of(read_land_xml, land_xml("<Surface><Pnts><P id=\"1\">" + std::string(5000, '1'))),
      "more text"));
  EXPECT_TRUE(
      says(refusal_of(read_land_xml, "<LandXML a=\"" + std::string(3 << 20, 'x')), "mebibyte"));
  EXPECT_TRUE(says(refusal_of(read_land_xml, "<html/>"), "not LandXML"));
}

}  // namespace
}  // namespace ptin
