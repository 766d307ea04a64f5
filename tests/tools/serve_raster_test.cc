// SPDX-License-Identifier: GPL-3.0-or-later
//
// Windows as GeoTIFF and COG over HTTP.
#include <algorithm>
#include <array>
#include <cstddef>
#include <memory>
#include <string>

#include <cpl_vsi.h>
#include <gdal_priv.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <ogr_spatialref.h>

#include "tests/tools/raster_reader.h"
#include "tests/tools/serve_fixture.h"
#include "tests/tools/whole_raster.h"

namespace ptin::tools::testing {
namespace {

using nlohmann::json;

/// A raster that came over HTTP, as GDAL opens it.
struct Received {
  explicit Received(const HttpAnswer& answer) {
    EXPECT_EQ(answer.status, 200) << answer.body.substr(0, 300);
    write_file(path(), answer.body);
    dataset.reset(GDALDataset::Open(path().c_str(), GDAL_OF_RASTER));
    EXPECT_TRUE(dataset) << "GDAL opens it";
  }
  [[nodiscard]] std::string path() const { return folder.file("a.tif"); }
  [[nodiscard]] std::string item(const char* name, const char* domain = "") const {
    const char* text = dataset ? dataset->GetMetadataItem(name, domain) : nullptr;
    return text != nullptr ? text : "";
  }
  TestFolder folder;
  GDALDatasetUniquePtr dataset;
};

void expect_nothing_left() {
  char** files = VSIReadDir("/vsimem/ptin-serve");
  EXPECT_EQ(CSLCount(files), 0);
  CSLDestroy(files);
}

TEST_F(Serve, GivesTheSourceBitForBitAsGeoTiff) {
  for (const char* format : {"geotiff", "cog"}) {
    const HttpAnswer answer = get(in("mountains", "coverage?f=") + format);
    EXPECT_EQ(answer.header("ptin-certified-error"), "0");
    EXPECT_EQ(answer.header("content-type").ends_with("; profile=cloud-optimized"),
              format == std::string("cog"));
    EXPECT_EQ(answer.header("ptin-exact"), "true");
    EXPECT_EQ(answer.header("content-crs"), "<http://www.opengis.net/def/crs/EPSG/0/32611>");
    const Received made(answer);
    expect_same_raster(made.path(), test_data("mountains_257.tif"));
    EXPECT_EQ(made.item("LAYOUT", "IMAGE_STRUCTURE"), format == std::string("cog") ? "COG" : "");
    EXPECT_EQ(made.item("PTIN_EXACT"), "true");
  }
  expect_nothing_left();
}

TEST_F(Serve, GivesAWindowAtALevelWithItsCertificate) {
  const Window w = middle_of_bounds(*mountains_, 0.3);
  const std::string target =
      in("mountains", "coverage?bbox-crs=native&error=20&pixel-size=70,90&bbox=") + window_text(w);
  const HttpAnswer answer = get(target);
  EXPECT_EQ(answer.header("content-type"), "image/tiff; application=geotiff");
  const Received made(answer);
  const ReadRaster raster = read_raster(made.path());
  EXPECT_EQ(made.item("PTIN_CERTIFIED_ERROR"), answer.header("ptin-certified-error"));
  EXPECT_EQ(made.item("PTIN_EXACT"), "false");
  EXPECT_LE(std::stod(answer.header("ptin-certified-error")), 20.001);
  ASSERT_GT(raster.width, 10);
  LocateRequest request;
  request.detail.tolerance = 20.0;
  for (const int i : {0, 5, static_cast<int>(raster.values.size()) - 1}) {
    const int column = i % raster.width, row = i / raster.width;
    const MapPoint centre{raster.transform[0] + (column + 0.5) * raster.transform[1],
                          raster.transform[3] + (row + 0.5) * raster.transform[5]};
    const double height = mountains_->locate(std::vector{centre}, request).points[0].height;
    EXPECT_EQ(raster.values[static_cast<std::size_t>(i)], static_cast<float>(height)) << i;
  }
  const HttpAnswer again = get(target, "If-None-Match: " + answer.header("etag") + "\r\n");
  EXPECT_EQ(again.status, 304);
  const HttpAnswer part = get(target, "Range: bytes=0-3\r\n");
  EXPECT_EQ(part.status, 206);
  EXPECT_EQ(part.body, answer.body.substr(0, 4));
  expect_nothing_left();
}

TEST_F(Serve, GivesARasterInAnotherCrs) {
  const std::string window = window_text(middle_of_bounds(*mountains_, 0.3));
  for (const std::string crs : {"EPSG:3857", "CRS84"}) {
    const HttpAnswer answer =
        get(in("mountains", "coverage?error=20&bbox-crs=native&crs=") + crs + "&bbox=" + window);
    const Received made(answer);
    const ReadRaster raster = read_raster(made.path());
    EXPECT_TRUE(answer.header("content-crs").ends_with(crs == "CRS84" ? "/CRS84>" : "/3857>"));
    EXPECT_EQ(made.item("PTIN_CERTIFIED_ERROR"), answer.header("ptin-certified-error"));
    OGRSpatialReference there, own;
    own.importFromEPSG(32611);
    own.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
    there.importFromEPSG(crs == "CRS84" ? 4326 : 3857);
    there.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
    EXPECT_TRUE(made.dataset->GetSpatialRef()->IsSame(&there));
    const std::unique_ptr<OGRCoordinateTransformation> way(
        OGRCreateCoordinateTransformation(&there, &own));
    LocateRequest request;
    request.detail.tolerance = 20.0;
    ASSERT_GT(raster.width, 20);
    std::size_t surface = 0;
    for (std::size_t i = 0; i < raster.values.size(); i += raster.values.size() / 50) {
      const auto width = static_cast<std::size_t>(raster.width);
      MapPoint p{
          raster.transform[0] + (static_cast<double>(i % width) + 0.5) * raster.transform[1],
          raster.transform[3] + (static_cast<double>(i / width) + 0.5) * raster.transform[5]};
      ASSERT_TRUE(way->Transform(1, &p.x, &p.y));
      const LocatedPoint found = mountains_->locate(std::vector{p}, request).points[0];
      if (found.state != PointState::kSurface) continue;
      ++surface;
      EXPECT_NEAR(raster.values[i], found.height, 1e-3) << crs << " " << i;
    }
    EXPECT_GT(surface, 40U);
  }
  expect_nothing_left();
}

TEST_F(Serve, TakesTheWindowAndThePixelsOfARasterAsOgcWritesThem) {
  const auto body_of = [](const std::string& query) {
    const HttpAnswer answer = get(in("mountains", "coverage?error=20") + query);
    EXPECT_EQ(answer.status, 200) << query << answer.body.substr(0, 300);
    return answer.body;
  };
  const std::string box = "-118.31,34.34,-118.3,34.35";
  EXPECT_EQ(body_of("&subset=Lat(34.34:34.35),Lon(-118.31:-118.3)"), body_of("&bbox=" + box));
  EXPECT_EQ(body_of("&subset=e(*:*)&subset-crs=native"), body_of(""));
  // A window beyond the terrain gives what they have in common.
  EXPECT_EQ(body_of("&bbox=-180,-90,180,90"), body_of(""));
  for (const std::string crs : {"native", "EPSG:3857"}) {
    const HttpAnswer answer =
        get(in("mountains", "coverage?error=20&width=30&height=20&crs=" + crs + "&bbox=" + box));
    const Received made(answer);
    EXPECT_EQ(made.dataset->GetRasterXSize(), 30);
    EXPECT_EQ(made.dataset->GetRasterYSize(), 20);
    EXPECT_EQ(answer.body, get(in("mountains", "coverage?error=20&scale-size=Lon(30),Lat(20)&crs=" +
                                                   crs + "&bbox=" + box))
                               .body);
  }
  const Received narrow(get(in("mountains", "coverage?crs=EPSG:3857&width=30&bbox=" + box)));
  std::array<double, 6> transform{};
  narrow.dataset->GetGeoTransform(transform.data());
  EXPECT_NEAR(transform[1], -transform[5], transform[1] * 0.02);
}

// The terrain's outline is turned against degrees: a window at its corner lies within its extent, and a part
// of it beside the terrain.
TEST_F(Serve, GivesTheWindowThatWasAskedForInTheCrsOfTheRaster) {
  const json box = get("/collections/mountains").json()["extent"]["spatial"]["bbox"][0];
  const double west = box[0], south = box[1], size = 0.004;
  const std::string corner = json(west + 1e-6).dump() + "," + json(south + 1e-6).dump() + "," +
                             json(west + size).dump() + "," + json(south + size).dump();
  const std::string query = "coverage?crs=CRS84&bbox=" + corner;
  const HttpAnswer answer = get(in("mountains", query + "&scale-size=Lon(40),Lat(40)"));
  const Received made(answer);
  const ReadRaster raster = read_raster(made.path());
  ASSERT_EQ(raster.values.size(), 1600U);
  EXPECT_NEAR(raster.transform[0], west + 1e-6, 1e-12);
  EXPECT_NEAR(raster.transform[3], south + size, 1e-12);
  EXPECT_NEAR(raster.transform[1], (size - 1e-6) / 40, 1e-12);
  const auto beside = static_cast<std::size_t>(
      std::count(raster.values.begin(), raster.values.end(), raster.nodata));
  EXPECT_GT(beside, 10U);
  EXPECT_LT(beside, 1500U);
  for (std::size_t i = 0; i < raster.values.size(); i += 37) {
    const double lon =
        raster.transform[0] + (static_cast<double>(i % 40) + 0.5) * raster.transform[1];
    const double lat =
        raster.transform[3] + (static_cast<double>(i / 40) + 0.5) * raster.transform[5];
    const json point = get(in("mountains", "position?f=json&coords=POINT(" + json(lon).dump() +
                                               "%20" + json(lat).dump() + ")"))
                           .json()["points"][0];
    if (point["height"].is_null()) {
      EXPECT_EQ(raster.values[i], raster.nodata) << i;
    } else {
      EXPECT_NEAR(raster.values[i], point["height"].get<double>(), 1e-3) << i;
    }
  }
  // As GDAL's driver OGCAPI asks.
  const std::string as_gdal = "coverage?bbox=" + corner + "&scaleSize=Lat(40),Long(40)";
  EXPECT_EQ(get(in("mountains", as_gdal)).body, answer.body);
  EXPECT_NE(get(in("mountains", as_gdal + "&crs=native")).body, answer.body);
  expect_nothing_left();
}

TEST_F(Serve, SaysWhichRasterItDoesNotGive) {
  const auto refused = [](const std::string& query, int status, const std::string& parameter) {
    const HttpAnswer answer = get(in("mountains", "coverage?") + query);
    EXPECT_EQ(answer.status, status) << query << answer.body.substr(0, 300);
    EXPECT_EQ(answer.json().value("parameter", ""), parameter) << answer.body;
    return answer.json().value("limit", "");
  };
  refused("pixel-size=0", 400, "pixel-size");
  refused("pixel-size=1,2,3", 400, "pixel-size");
  refused("pixel-size=1e9", 400, "pixel-size");
  refused("f=png", 400, "f");
  refused("bbox=1,2,3,4", 400, "bbox");
  refused("bbox=34.3,-118.3,34.4,-118.2", 400, "bbox");
  refused("vertices=1", 400, "vertices");
  refused("subset=Time(1:2)", 400, "subset");
  refused("subset=Lat(34.3)", 400, "subset");
  refused("subset=Lat(34.3:34.4),Lat(34.3:34.4)", 400, "subset");
  refused("scale-size=Lat(0)", 400, "scale-size");
  refused("scaleSize=Lat(0)", 400, "scaleSize");
  refused("width=0", 400, "width");
  refused("width=10&pixel-size=60", 400, "width");
  refused("crs=EPSG:99999", 400, "crs");
  EXPECT_EQ(refused("width=100000&height=100000", 413, "pixel-size"), "pixels");
  EXPECT_EQ(refused("pixel-size=0.1", 413, "pixel-size"), "pixels");
  expect_nothing_left();
}

TEST(ServeRaster, KeepsToItsMemory) {
  TestFolder folder;
  serve::ServeOptions options = serve_options(folder);
  options.question.question_memory = std::uint64_t{1} << 20;
  ServedTerrains served(options);
  const HttpAnswer answer = served.get("/collections/mountains/coverage?pixel-size=10");
  EXPECT_EQ(answer.status, 413);
  EXPECT_EQ(answer.json().at("limit"), "question_memory");
}

TEST_F(Serve, DescribesTheValuesOfItsCoverage) {
  const json schema = get(in("mountains", "schema")).json();
  EXPECT_EQ(schema["properties"]["height"]["type"], "number");
  EXPECT_EQ(schema["properties"]["height"]["x-ogc-nilValues"][0], -9999.0);
  bool is_linked = false;
  const json collection = get("/collections/mountains").json();
  for (const json& link : collection["links"]) {
    is_linked = is_linked || link["rel"] == "http://www.opengis.net/def/rel/ogc/1.0/coverage";
  }
  EXPECT_TRUE(is_linked);
}

}  // namespace
}  // namespace ptin::tools::testing
