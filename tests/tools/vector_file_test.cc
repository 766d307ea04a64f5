// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/formats/vector_file.h"

#include <cstdint>
#include <memory>
#include <set>

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
                     wkbPoint,
                     {{"ID", Type::kInteger}, {"flag", Type::kFlag}, {"elev", Type::kReal}},
                     ""});
    for (const std::int64_t number : numbers) {
      const VectorFile::Value values[] = {number, number % 2, 0.5};
      file.add(std::make_unique<OGRPoint>(static_cast<double>(number % 7), 1.0), values);
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

/// An index or a CRS of the shapefile that was replaced would be believed.
TEST(VectorFile, LeavesNothingOfAShapefileThatItReplaces) {
  GDALAllRegister();
  const testing::TestFolder folder;
  for (const char* name : {"a.shp", "a.shx", "a.dbf", "a.prj", "a.qix", "a.sbn", "a.qml"}) {
    testing::write_file(folder.file(name), "of the old one");
  }
  {
    VectorFile file(folder.file("a.shp"), true, {"points", wkbPoint, {{"ID", Type::kInteger}}, ""});
    const VectorFile::Value values[] = {std::int64_t{1}};
    file.add(std::make_unique<OGRPoint>(2.0, 1.0), values);
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
