// SPDX-License-Identifier: GPL-3.0-or-later
//
// Windows as GeoTIFF and COG over HTTP.
#include <memory>
#include <string>

#include <cpl_vsi.h>
#include <gdal_priv.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

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
      in("mountains", "coverage?crs=native&error=20&pixel-size=70,90&bbox=") + window_text(w);
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
  refused("vertices=1", 400, "vertices");
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
