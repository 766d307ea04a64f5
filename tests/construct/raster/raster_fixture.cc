// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/construct/raster/raster_fixture.h"

#include <cmath>
#include <tuple>

#include <gdal_priv.h>
#include <ogr_spatialref.h>

#include "engine/construct/grid/source_options.h"
#include "tests/construct/task_runs.h"

namespace ptin::raster_fixture {

std::string write(const Made& made) {
  GDALAllRegister();
  char** creation = nullptr;
  for (const std::string& option : made.creation) {
    creation = CSLAddString(creation, option.c_str());
  }
  const int bands = made.alpha.empty() ? made.bands : 2;
  GDALDriver* driver = GetGDALDriverManager()->GetDriverByName("GTiff");
  GDALDatasetUniquePtr data(
      driver->Create(made.name.c_str(), made.columns, made.rows, bands, made.type, creation));
  CSLDestroy(creation);
  if (made.geotransform) {
    auto t = *made.geotransform;
    data->SetGeoTransform(t.data());
  }
  if (!made.srs.empty()) {
    OGRSpatialReference srs;
    srs.SetFromUserInput(made.srs.c_str());
    data->SetSpatialRef(&srs);
  }
  GDALRasterBand* band = data->GetRasterBand(1);
  if (made.nodata) band->SetNoDataValue(*made.nodata);
  if (made.scale != 1.0) band->SetScale(made.scale);
  if (made.offset != 0.0) band->SetOffset(made.offset);
  if (!made.unit.empty()) band->SetUnitType(made.unit.c_str());
  auto values = made.values;
  EXPECT_EQ(band->RasterIO(GF_Write, 0, 0, made.columns, made.rows, values.data(), made.columns,
                           made.rows, GDT_Float64, 0, 0, nullptr),
            CE_None);
  if (!made.alpha.empty()) {
    auto alpha = made.alpha;
    data->GetRasterBand(2)->SetColorInterpretation(GCI_AlphaBand);
    EXPECT_EQ(
        data->GetRasterBand(2)->RasterIO(GF_Write, 0, 0, made.columns, made.rows, alpha.data(),
                                         made.columns, made.rows, GDT_Byte, 0, 0, nullptr),
        CE_None);
  }
  return made.name;
}

Made small() {
  Made made;
  made.columns = 3;
  made.rows = 2;
  made.values = {1, 2, 3, 4, 5, 6};
  return made;
}

RasterSource open(const Made& made, const SourceOptions& options) {
  return RasterSource::open({write(made)}, options);
}

Heights heights_of(const RasterSource& source) {
  const auto n = static_cast<std::size_t>(source.width() * source.height());
  std::vector<HeightBits> bits(n);
  std::vector<std::uint8_t> valid(n);
  source.read({0, 0, source.width(), source.height()}, bits, valid);
  Heights heights;
  for (std::size_t i = 0; i < n; ++i) {
    heights.push_back(valid[i] ? source.frame().heights.height(bits[i])
                               : std::numeric_limits<double>::quiet_NaN());
    EXPECT_TRUE(valid[i] || bits[i] == 0);
  }
  return heights;
}

void expect_heights(const RasterSource& source, const Heights& expected) {
  const Heights found = heights_of(source);
  ASSERT_EQ(found.size(), expected.size());
  for (std::size_t i = 0; i < found.size(); ++i) {
    if (std::isnan(expected[i])) {
      EXPECT_TRUE(std::isnan(found[i])) << i;
    } else {
      EXPECT_EQ(found[i], expected[i]) << i;
    }
  }
}

Error open_error(const std::vector<std::string>& paths, std::stop_token stop) {
  return error_of(
      [&] { std::ignore = RasterSource::open(paths, {}, test::on_threads(1, 0, stop)); });
}

void expect_refused(const Made& made, const std::string& word, const SourceOptions& options) {
  const Error e = error_of([&] { open(made, options); });
  EXPECT_EQ(e.code(), ErrorCode::invalid_argument) << e.what();
  EXPECT_NE(e.message().find(word), std::string::npos) << e.what();
  EXPECT_EQ(e.context(), made.name);
}

}  // namespace ptin::raster_fixture
