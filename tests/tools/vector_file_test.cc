// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/formats/vector_file.h"

#include <cmath>
#include <cstdint>
#include <memory>
#include <set>
#include <string>
#include <tuple>
#include <vector>

#include <gdal_priv.h>
#include <gtest/gtest.h>
#include <ogr_geometry.h>
#include <ogrsf_frmts.h>

#include "tests/tools/program.h"

namespace ptin::tools {
namespace {

using Type = VectorFile::FieldType;

/// Numbers of lines beyond 8 digits, beyond 32 bits, and as many digits as a shapefile has.
TEST(VectorFile, KeepsWholeNumbersOfAnySize) {
  GDALAllRegister();
  const std::int64_t numbers[] = {0, 99'999'999, 100'000'000, std::int64_t{1} << 33,
                                  999'999'999'999'999};
  for (const char* name : {"a.gpkg", "a.fgb", "a.geojson", "a.shp"}) {
    SCOPED_TRACE(name);
    const testing::TestFolder folder;
    VectorFile file(folder.file(name), false,
                    {"lines",
                     GeometryKind::kPoint,
                     {{"ID", Type::kInteger}, {"flag", Type::kFlag}, {"elev", Type::kReal}},
                     {}});
    for (const std::int64_t number : numbers) {
      const VectorFile::Value values[] = {number, number % 2, 0.5};
      file.add(point_geometry({static_cast<double>(number % 7), 1.0}), values);
    }
    file.publish();
    const std::unique_ptr<GDALDataset> read(
        GDALDataset::Open(folder.file(name).c_str(), GDAL_OF_VECTOR));
    ASSERT_TRUE(read);
    std::multiset<std::int64_t> found;  // FlatGeobuf has an order of its own
    for (const auto& feature : *read->GetLayer(0)) {
      const std::int64_t number = feature->GetFieldAsInteger64("ID");
      found.insert(number);
      EXPECT_EQ(feature->GetFieldAsInteger("flag"), number % 2);
      EXPECT_EQ(feature->GetFieldAsDouble("elev"), 0.5);
    }
    EXPECT_EQ(found, std::multiset<std::int64_t>(std::begin(numbers), std::end(numbers)));
  }
}

/// A layer of one feature with a field of each type, read again.
struct ReadLayer {
  ReadLayer(const std::string& path, GeometryKind kind, const Geometry& geometry) {
    CrsFacts crs;
    crs.code = "EPSG:32611";
    VectorFile file(path, false,
                    {"a \"layer\"",
                     kind,
                     {{"real", Type::kReal},
                      {"unknown", Type::kReal},
                      {"text", Type::kText},
                      {"truth", Type::kBoolean}},
                     crs});
    file.add(geometry, std::vector<VectorFile::Value>{3.0, std::nan(""), "a \"b\"\n\xC3\xA9",
                                                      std::int64_t{1}});
    file.publish();
    data.reset(GDALDataset::Open(path.c_str(), GDAL_OF_VECTOR));
    feature.reset(data->GetLayer(0)->GetNextFeature());
  }
  [[nodiscard]] std::string wkt() const {
    OGRWktOptions exact;
    exact.variant = wkbVariantIso;
    exact.precision = 17;
    return feature->GetGeometryRef()->exportToWkt(exact);
  }
  std::unique_ptr<GDALDataset> data;
  std::unique_ptr<OGRFeature> feature;
};

TEST(VectorFile, WritesGeoJsonThatIsReadAsItWasGiven) {
  GDALAllRegister();
  const testing::TestFolder folder;
  const double third = 1.0 / 3, height = 2.0;
  const std::vector<MapPoint> points = {{third, 1e-9}, {5e5, -4e6 - third}};
  Geometry lines = line_geometry(points, &height);
  lines.points.insert(lines.points.end(), points.rbegin(), points.rend());
  lines.heights.insert(lines.heights.end(), {1.5, 2.5});
  lines.end_path();
  Geometry areas;
  areas.points = {{0, 0}, {9, 0}, {0, 9},  {0, 0},  {1, 1},  {1, 2},
                  {2, 1}, {1, 1}, {20, 0}, {29, 0}, {20, 9}, {20, 0}};
  areas.paths = {4, 8, 12};
  areas.polygons = {2, 3};
  const std::tuple<GeometryKind, Geometry, int> cases[] = {
      {GeometryKind::kPoint, point_geometry(points[1]), 0},
      {GeometryKind::kPointZ, point_geometry(points[1], third), 1},
      {GeometryKind::kLine, line_geometry(points, nullptr), 2},
      {GeometryKind::kLineZ, line_geometry(points, &height), 3},
      {GeometryKind::kMultiLineZ, lines, 4},
      {GeometryKind::kMultiPolygon, areas, 5}};
  for (const auto& [kind, geometry, number] : cases) {
    SCOPED_TRACE(number);
    const std::string name = folder.file(std::to_string(number));
    const ReadLayer ours(name + ".geojson", kind, geometry), ogr(name + ".gpkg", kind, geometry);
    EXPECT_EQ(ours.wkt(), ogr.wkt());
    OGRFeature& feature = *ours.feature;
    EXPECT_EQ(feature.GetFieldDefnRef(0)->GetType(), OFTReal);
    EXPECT_EQ(feature.GetFieldAsDouble("real"), 3.0);
    EXPECT_EQ(feature.IsFieldNull(1), TRUE);
    EXPECT_STREQ(feature.GetFieldAsString("text"), "a \"b\"\n\xC3\xA9");
    EXPECT_EQ(feature.GetFieldDefnRef(3)->GetSubType(), OFSTBoolean);
    EXPECT_STREQ(ours.data->GetLayer(0)->GetName(), "a \"layer\"");
    EXPECT_STREQ(ours.data->GetLayer(0)->GetSpatialRef()->GetAuthorityCode(nullptr), "32611");
  }
}

/// An index or a CRS of the shapefile that was replaced would be believed.
TEST(VectorFile, LeavesNothingOfAShapefileThatItReplaces) {
  GDALAllRegister();
  const testing::TestFolder folder;
  for (const char* name : {"a.shp", "a.shx", "a.dbf", "a.prj", "a.qix", "a.sbn", "a.qml"}) {
    testing::write_file(folder.file(name), "of the old one");
  }
  {
    VectorFile file(folder.file("a.shp"), true,
                    {"points", GeometryKind::kPoint, {{"ID", Type::kInteger}}, {}});
    const VectorFile::Value values[] = {std::int64_t{1}};
    file.add(point_geometry({2.0, 1.0}), values);
    file.publish();
  }
  const std::vector<std::string> expected = {"a.dbf", "a.qml", "a.shp", "a.shx"};
  std::vector<std::string> names = folder.names();
  std::erase(names, "a.cpg");  // as GDAL likes
  EXPECT_EQ(names, expected);
  const std::unique_ptr<GDALDataset> read(
      GDALDataset::Open(folder.file("a.shp").c_str(), GDAL_OF_VECTOR));
  ASSERT_TRUE(read);
  EXPECT_EQ(read->GetLayer(0)->GetFeatureCount(), 1);
  EXPECT_EQ(read->GetLayer(0)->GetSpatialRef(), nullptr);
}

}  // namespace
}  // namespace ptin::tools
