// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/tools/small_terrains.h"

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <memory>
#include <sstream>
#include <stdexcept>

#include <gdal_priv.h>
#include <gdal_utils.h>
#include <ogr_spatialref.h>

#include "engine/construct/build.h"

namespace ptin::tools::testing {

std::string read_file(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  std::ostringstream content;
  content << in.rdbuf();
  return content.str();
}

void write_file(const std::string& path, const std::string& content) {
  std::ofstream(path, std::ios::binary) << content;
}

void make_raster(const std::string& path, const RasterRecipe& r) {
  GDALAllRegister();
  CPLStringList creation;
  for (const std::string& option : r.creation) creation.AddString(option.c_str());
  const std::unique_ptr<GDALDataset> data(GetGDALDriverManager()->GetDriverByName("GTiff")->Create(
      path.c_str(), r.width, r.height, 1, GDALGetDataTypeByName(r.type.c_str()), creation.List()));
  if (!data) throw std::runtime_error("cannot create " + path);
  double transform[6] = {r.west, r.pixel, 0, r.north, 0, -r.pixel};
  if (r.columns_go_west) {
    transform[0] += r.width * r.pixel;
    transform[1] = -r.pixel;
  }
  data->SetGeoTransform(transform);
  OGRSpatialReference srs;
  if (r.epsg != 0 && srs.importFromEPSG(r.epsg) == OGRERR_NONE) data->SetSpatialRef(&srs);
  GDALRasterBand& band = *data->GetRasterBand(1);
  if (r.nodata) band.SetNoDataValue(*r.nodata);
  if (!r.unit.empty()) band.SetUnitType(r.unit.c_str());
  std::vector<double> row(static_cast<std::size_t>(r.width));
  for (int y = 0; y < r.height; ++y) {
    for (int x = 0; x < r.width; ++x)
      row[static_cast<std::size_t>(x)] = r.value ? r.value(x, y) : hills(x, y);
    if (band.RasterIO(GF_Write, 0, y, r.width, 1, row.data(), r.width, 1, GDT_Float64, 0, 0,
                      nullptr) != CE_None) {
      throw std::runtime_error("cannot write " + path);
    }
  }
}

double hills(int column, int row) {
  return std::round(500.0 * (2.0 + std::sin(column * 0.21) * std::cos(row * 0.17) +
                             0.3 * std::sin(column * 0.73 + row * 0.41))) /
         10.0;
}

std::string test_data(const std::string& name) {
  return std::string(PTIN_TEST_DATA "/").append(name);
}

namespace {

#ifdef __SANITIZE_THREAD__
/// The terrain's north-western quarter: a build takes twenty times as long.
std::string source_of(const TestFolder& folder, const std::string& name) {
  GDALAllRegister();
  const std::string path = folder.file(name);
  const GDALDatasetUniquePtr whole(GDALDataset::Open(test_data(name).c_str(), GDAL_OF_RASTER));
  if (!whole) throw std::runtime_error("cannot open " + test_data(name));
  CPLStringList words;
  const int width = (whole->GetRasterXSize() + 1) / 2, height = (whole->GetRasterYSize() + 1) / 2;
  for (const std::string& word : {std::string("-srcwin"), std::string("0"), std::string("0"),
                                  std::to_string(width), std::to_string(height)}) {
    words.AddString(word.c_str());
  }
  const std::unique_ptr<GDALTranslateOptions, decltype(&GDALTranslateOptionsFree)> options(
      GDALTranslateOptionsNew(words.List(), nullptr), GDALTranslateOptionsFree);
  GDALClose(
      GDALTranslate(path.c_str(), GDALDataset::ToHandle(whole.get()), options.get(), nullptr));
  return path;
}
#else
std::string source_of(const TestFolder&, const std::string& name) { return test_data(name); }
#endif

/// The folder where the suites of a run share the stores of this program: named by the program's own
/// time, so that what another version built is not taken. A suite that runs alone has its own.
std::filesystem::path folder_of_stores() {
  static const TestFolder own;
  const char* const shared = std::getenv("PTIN_TEST_STORES");
  if (shared == nullptr) return own.path();
  namespace fs = std::filesystem;
  const fs::path program = fs::read_symlink("/proc/self/exe");
  const auto time = fs::last_write_time(program).time_since_epoch().count();
  const fs::path folder =
      fs::path(shared) / (program.filename().string() + "_" + std::to_string(time));
  fs::create_directories(folder);
  return folder;
}

}  // namespace

std::string built(const TestFolder& folder, const std::string& name,
                  const std::string& store_name) {
  static const std::filesystem::path stores = folder_of_stores();
  const std::filesystem::path store = stores / (name + ".ptin");
  if (!std::filesystem::exists(store)) {
    const TestFolder building(stores);  // Of two suites that build it at once the later one wins.
    const std::string fresh = building.file(name + ".ptin");
    build_terrain(source_of(building, name), fresh);
    std::filesystem::rename(fresh, store);
  }
  const std::string path = folder.file(store_name);
  std::filesystem::copy_file(store, path, std::filesystem::copy_options::overwrite_existing);
  return path;
}

std::string built(const TestFolder& folder, const std::string& name) {
  return built(folder, name, name + ".ptin");
}

void build_terrain(const std::string& input, const std::string& output,
                   const BuildOptions& options) {
  build({input}, output, options, {});
}

}  // namespace ptin::tools::testing
