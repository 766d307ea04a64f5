// SPDX-License-Identifier: GPL-3.0-or-later
//
// LandXML, DXF and STL of a TIN: read back by ptin build, by GDAL, and from the bytes.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <set>

#include <gdal_priv.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <ogrsf_frmts.h>

#include "tests/tools/mesh_reader.h"
#include "tests/tools/program.h"

namespace ptin::tools {
namespace {

using testing::answer_of;
using testing::expect_done;
using testing::Outcome;
using testing::read_file;
using testing::run_ptin;
using testing::TestFolder;
using Point = std::array<double, 3>;
using Facet = std::array<Point, 3>;

Facet from_least(Facet f) {
  std::rotate(f.begin(), std::min_element(f.begin(), f.end()), f.end());
  return f;
}

std::multiset<Facet> ply_facets(const std::string& path) {
  const testing::ReadMesh mesh = testing::read_ply(read_file(path));
  std::multiset<Facet> facets;
  for (const auto& t : mesh.triangles) {
    facets.insert(
        from_least({mesh.vertices.at(t[0]), mesh.vertices.at(t[1]), mesh.vertices.at(t[2])}));
  }
  return facets;
}

/// The faces of the only layer of a DXF, as GDAL reads it.
std::multiset<Facet> dxf_facets(const std::string& path) {
  GDALAllRegister();
  std::multiset<Facet> facets;
  const GDALDatasetUniquePtr dataset(GDALDataset::Open(path.c_str(), GDAL_OF_VECTOR));
  EXPECT_TRUE(dataset);
  if (!dataset) return facets;
  for (const auto& feature : *dataset->GetLayer(0)) {
    EXPECT_STREQ(feature->GetFieldAsString("Layer"), "TIN");
    const OGRGeometry* geometry = feature->GetGeometryRef();
    EXPECT_EQ(geometry->getGeometryType(), wkbPolygon25D);
    const OGRLinearRing* ring = geometry->toPolygon()->getExteriorRing();
    EXPECT_EQ(ring->getNumPoints(), 4);
    Facet f;
    for (int i = 0; i < 3; ++i) f[i] = {ring->getX(i), ring->getY(i), ring->getZ(i)};
    facets.insert(from_least(f));
  }
  return facets;
}

struct Stl {
  std::string header;
  std::vector<Facet> facets;
  std::vector<Point> normals;
};

Stl read_stl(const std::string& path) {
  const std::string bytes = read_file(path);
  Stl stl;
  std::uint32_t count = 0;
  EXPECT_GE(bytes.size(), 84U);
  std::memcpy(&count, bytes.data() + 80, 4);
  EXPECT_EQ(bytes.size(), 84 + 50 * std::size_t{count});
  stl.header = bytes.substr(0, 80);
  for (std::size_t i = 0; i < count && bytes.size() == 84 + 50 * std::size_t{count}; ++i) {
    std::array<float, 12> numbers{};
    std::memcpy(numbers.data(), bytes.data() + 84 + 50 * i, sizeof numbers);
    stl.normals.push_back({numbers[0], numbers[1], numbers[2]});
    Facet f;
    for (std::size_t k = 0; k < 9; ++k) f[k / 3][k % 3] = numbers[3 + k];
    stl.facets.push_back(f);
  }
  return stl;
}

class CadFormats : public ::testing::Test {
 protected:
  [[nodiscard]] std::string file(const std::string& name) const { return folder_.file(name); }

  /// Two islands, one of them with a lagoon, on a grid of hundredths.
  [[nodiscard]] std::string islands() const {
    testing::RasterRecipe recipe;
    recipe.width = 40;
    recipe.nodata = -9999.0;
    recipe.value = [](int column, int row) {
      const bool is_gap = column > 18 && column < 22;
      const bool is_lagoon = column > 5 && column < 11 && row > 10 && row < 20;
      return is_gap || is_lagoon ? -9999.0 : std::round(100 * testing::hills(column, row)) / 100;
    };
    return store_of(recipe);
  }
  [[nodiscard]] std::string store_of(const testing::RasterRecipe& recipe) const {
    testing::make_raster(file("dem.tif"), recipe);
    expect_done({"build", file("dem.tif"), "-o", file("dem.ptin"), "-q", "--overwrite"});
    return file("dem.ptin");
  }
  /// Runs `export` and `refine` and calls `look` at the output of each.
  template <typename Look>
  void written_both_ways(const std::string& store, const std::string& name,
                         const std::vector<std::string>& more, const Look& look) const {
    for (const char* command : {"export", "refine"}) {
      std::vector<std::string> arguments = {command, store, "-o", file(name), "-q", "--overwrite"};
      arguments.insert(arguments.end(), more.begin(), more.end());
      expect_done(arguments);
      look(file(name));
    }
  }
  TestFolder folder_;
};

TEST_F(CadFormats, LandXmlComesBackAsTheSameTin) {
  const std::string store = islands();
  for (const std::vector<std::string>& level : {std::vector<std::string>{}, {"--error", "3"}}) {
    std::vector<std::string> as_ply = {"export", store, "-o", file("a.ply"), "-q", "--overwrite"};
    as_ply.insert(as_ply.end(), level.begin(), level.end());
    expect_done(as_ply);
    const auto facets = ply_facets(file("a.ply"));
    EXPECT_GT(facets.size(), 100U);
    written_both_ways(store, "a.xml", level, [&](const std::string& path) {
      expect_done({"build", path, "-o", file("b.ptin"), "-q", "--overwrite"});
      expect_done({"export", file("b.ptin"), "-o", file("b.ply"), "-q", "--overwrite"});
      EXPECT_EQ(ply_facets(file("b.ply")), facets);
      const auto facts = answer_of({"info", file("b.ptin"), "--json"});
      EXPECT_EQ(facts.at("crs").at("code"), "EPSG:32611");
      EXPECT_EQ(facts.at("units").at("height"), "metre");
    });
  }
}

TEST_F(CadFormats, LandXmlIsThisTextForTwoTriangles) {
  testing::write_file(file("m.obj"),
                      "v 10 200 1.5\nv 14 200 2\nv 14 203 -3\nv 10 203 4\nf 1 2 3\nf 1 3 4\n");
  expect_done({"build", file("m.obj"), "-o", file("m.ptin"), "-q", "--a-srs", "EPSG:2226"});
  expect_done({"refine", file("m.ptin"), "-o", file("m.xml"), "-q"});
  const std::string text = read_file(file("m.xml"));
  EXPECT_TRUE(
      text.starts_with("<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
                       "<LandXML xmlns=\"http://www.landxml.org/schema/LandXML-1.2\""));
  EXPECT_NE(text.find("<Imperial areaUnit=\"squareFoot\" linearUnit=\"USSurveyFoot\""), text.npos);
  EXPECT_NE(text.find("epsgCode=\"2226\""), text.npos) << text;
  EXPECT_NE(text.find(">200 10 1.5</P>"), text.npos) << "northing before easting";
  EXPECT_NE(text.find("<Definition surfType=\"TIN\">"), text.npos);
  EXPECT_EQ(text.find("wktCode"), text.npos);
}

TEST_F(CadFormats, LandXmlNamesUnitsAndEscapesNames) {
  const auto text_of = [&](const std::string& unit, const std::string& crs) {
    testing::RasterRecipe recipe;
    recipe.width = recipe.height = 5;
    recipe.unit = unit;
    testing::make_raster(file("u.tif"), recipe);
    expect_done(
        {"build", file("u.tif"), "-o", file("u.ptin"), "-q", "--overwrite", "--a-srs", crs});
    expect_done({"export", file("u.ptin"), "-o", file("u.xml"), "-q", "--overwrite"});
    expect_done({"build", file("u.xml"), "-o", file("v.ptin"), "-q", "--overwrite"});
    const auto facts = answer_of({"info", file("v.ptin"), "--json"});
    EXPECT_EQ(facts.at("units").at("height"), unit == "ft" ? "foot" : "metre") << unit << crs;
    return read_file(file("u.xml"));
  };
  EXPECT_NE(text_of("ft", "EPSG:32611").find("pressureUnit=\"HPA\" elevationUnit=\"feet\"/>"),
            std::string::npos);
  EXPECT_NE(text_of("m", "EPSG:2227").find("pressureUnit=\"inHG\" elevationUnit=\"meter\"/>"),
            std::string::npos);
  EXPECT_EQ(text_of("m", "EPSG:32611").find("elevationUnit"), std::string::npos);
  const std::string own =
      text_of("m",
              "PROJCS[\"Up & <down>\",GEOGCS[\"WGS 84\",DATUM[\"WGS_1984\",SPHEROID[\"WGS 84\","
              "6378137,298.257223563]],PRIMEM[\"Greenwich\",0],UNIT[\"degree\",0.01745329252]],"
              "PROJECTION[\"Transverse_Mercator\"],PARAMETER[\"latitude_of_origin\",0],"
              "PARAMETER[\"central_meridian\",-117],PARAMETER[\"scale_factor\",1],"
              "PARAMETER[\"false_easting\",0],PARAMETER[\"false_northing\",0],"
              "UNIT[\"metre\",1]]");
  EXPECT_NE(own.find("name=\"Up &amp; &lt;down>\" ogcWktCode=\"PROJCRS[&quot;"), std::string::npos)
      << own.substr(0, 900);
}

TEST_F(CadFormats, DxfHasAFaceATriangle) {
  const std::string store = islands();
  expect_done({"export", store, "-o", file("a.ply"), "-q"});
  const auto facets = ply_facets(file("a.ply"));
  written_both_ways(store, "a.dxf", {}, [&](const std::string& path) {
    EXPECT_EQ(dxf_facets(path), facets);
    const std::string text = read_file(path);
    EXPECT_TRUE(text.starts_with("999\nwritten by ptin\n999\ncrs: EPSG:32611\n0\nSECTION\n"));
    EXPECT_TRUE(text.ends_with("0\nENDSEC\n0\nEOF\n"));
  });
}

TEST_F(CadFormats, StlStandsInTheFrameThatIsTold) {
  const std::string store = islands();
  expect_done({"export", store, "-o", file("a.ply"), "-q"});
  const auto facets = ply_facets(file("a.ply"));
  for (const char* command : {"export", "refine"}) {
    const auto answer = answer_of({command, store, "-o", file("a.stl"), "--json", "--overwrite"});
    const auto origin = answer.at("local_frame").at("origin").get<Point>();
    EXPECT_EQ(origin, (Point{500600, 3999505, 0}));  // the middle, rounded to whole metres
    EXPECT_EQ(answer.at("local_frame").at("scale").get<Point>(), (Point{1, 1, 1}));
    const Stl stl = read_stl(file("a.stl"));
    EXPECT_TRUE(stl.header.starts_with("ptin origin 500600 3999505 0 scale 1 1 1"));
    std::multiset<std::array<std::array<float, 3>, 3>> expected, found;
    for (const Facet& f : facets) {
      std::array<std::array<float, 3>, 3> local{};
      for (std::size_t i = 0; i < 9; ++i)
        local[i / 3][i % 3] = static_cast<float>(f[i / 3][i % 3] - origin[i % 3]);
      std::rotate(local.begin(), std::min_element(local.begin(), local.end()), local.end());
      expected.insert(local);
    }
    for (std::size_t t = 0; t < stl.facets.size(); ++t) {
      std::array<std::array<float, 3>, 3> local{};
      for (std::size_t i = 0; i < 9; ++i)
        local[i / 3][i % 3] = static_cast<float>(stl.facets[t][i / 3][i % 3]);
      std::rotate(local.begin(), std::min_element(local.begin(), local.end()), local.end());
      found.insert(local);
      const Point& n = stl.normals[t];
      EXPECT_NEAR(n[0] * n[0] + n[1] * n[1] + n[2] * n[2], 1.0, 1e-6);
      EXPECT_GT(n[2], 0.0);
      for (std::size_t i = 1; i < 3; ++i) {
        double along = 0.0;
        for (std::size_t k = 0; k < 3; ++k)
          along += n[k] * (stl.facets[t][i][k] - stl.facets[t][0][k]);
        EXPECT_NEAR(along, 0.0, 1e-2);
      }
    }
    EXPECT_EQ(found, expected);
  }
  const Outcome told = run_ptin({"refine", store, "-o", file("b.stl")});
  EXPECT_NE(
      told.out.find("frame      x = (easting - 500600), y = (northing - 3999505), z = height"),
      std::string::npos)
      << told.out;
  // A window has the same frame, so that parts fit together.
  const auto part = answer_of({"export", store, "-o", file("c.stl"), "--json", "--window", "500000",
                               "3999700", "500200", "4000000"});
  EXPECT_EQ(part.at("local_frame").at("origin").get<Point>(), (Point{500600, 3999505, 0}));
}

TEST_F(CadFormats, StlMakesDegreesAndFeetMetres) {
  testing::RasterRecipe recipe;
  recipe.epsg = 4326;
  recipe.west = 9.0;
  recipe.north = 60.0005;
  recipe.pixel = 0.001;
  recipe.unit = "ft";
  recipe.value = [](int column, int) { return 100.0 * column; };
  const auto answer = answer_of({"refine", store_of(recipe), "-o", file("a.stl"), "--json"});
  const auto scale = answer.at("local_frame").at("scale").get<Point>();
  EXPECT_NEAR(scale[0], 55826, 2);
  EXPECT_NEAR(scale[1], 111412, 2);
  EXPECT_EQ(scale[2], 0.3048);
  double least = INFINITY, most = -INFINITY, high = 0.0;
  for (const Facet& f : read_stl(file("a.stl")).facets) {
    for (const Point& p : f) {
      least = std::min(least, p[0]);
      most = std::max(most, p[0]);
      high = std::max(high, p[2]);
    }
  }
  EXPECT_NEAR(most - least, 0.032 * 55826, 0.5);
  EXPECT_NEAR(high, 3200 * 0.3048, 1e-3);
}

TEST_F(CadFormats, AreTheSameBytesWhateverTheMemory) {
  const std::string store = testing::built(folder_, "mountains_257.tif");
  for (const char* name : {"a.xml", "a.dxf", "a.stl"}) {
    std::string first;
    for (const char* memory : {"1G", "32M"}) {
      const auto answer = answer_of(
          {"export", store, "--memory", memory, "--json", "--overwrite", "-o", file(name)});
      EXPECT_EQ(answer.at("cells") == 1, first.empty());
      const std::string bytes = read_file(file(name));
      if (first.empty()) first = bytes;
      EXPECT_TRUE(bytes == first) << name;
    }
  }
}

TEST_F(CadFormats, RefuseWhatTheyCannotHold) {
  testing::RasterRecipe recipe;
  recipe.epsg = 4326;
  recipe.west = 9.0;
  recipe.north = 60.0;
  recipe.pixel = 0.001;
  const std::string store = store_of(recipe);
  for (const char* command : {"export", "refine"}) {
    const Outcome outcome = run_ptin({command, store, "-q", "-o", file("a.xml")});
    EXPECT_EQ(outcome.status, 2);
    EXPECT_NE(outcome.err.find("northing and easting in a plane"), std::string::npos)
        << outcome.err;
    const Outcome unknown = run_ptin({command, store, "-q", "-o", file("a.doc")});
    EXPECT_NE(unknown.err.find(".xml, .dxf, .stl"), std::string::npos) << unknown.err;
  }
  EXPECT_NE(run_ptin({"export", store, "-o", file("a.x"), "--format", "KML"})
                .err.find("PLY, OBJ, 2DM, LandXML, DXF, STL, GPKG, FlatGeobuf, GTiff, COG"),
            std::string::npos);
  EXPECT_EQ(folder_.names(), (std::vector<std::string>{"dem.ptin", "dem.tif"}));
  expect_done({"export", store, "-o", file("a.faces"), "--format", "dxf", "-q"});
  EXPECT_FALSE(dxf_facets(file("a.faces")).empty());
}

}  // namespace
}  // namespace ptin::tools
