// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/python/array_source.h"

#include <algorithm>
#include <atomic>
#include <bit>
#include <cmath>
#include <memory>
#include <mutex>
#include <string_view>

#include <cpl_vsi.h>
#include <gdal_priv.h>
#include <ogrsf_frmts.h>

#include "engine/error.h"

namespace ptin::python {

namespace {

/// The name of the files that hold points ends so; the driver below knows them by it.
constexpr std::string_view kPointsEnd = ".xyz_float64";
constexpr std::size_t kNumbersOfPoint = 3;

/// The points of such a file as a layer.
class PointLayer final : public OGRLayer {
 public:
  PointLayer(const double* numbers, std::int64_t points)
      : numbers_(numbers), points_(points), definition_(new OGRFeatureDefn("points")) {
    definition_->Reference();
    definition_->SetGeomType(wkbPoint25D);
    SetDescription("points");
  }
  ~PointLayer() override { definition_->Release(); }
  PointLayer(const PointLayer&) = delete;
  PointLayer& operator=(const PointLayer&) = delete;

  void ResetReading() override { next_ = 0; }
  OGRFeature* GetNextFeature() override {
    if (next_ == points_) return nullptr;
    const double* const at = numbers_ + static_cast<std::size_t>(next_) * kNumbersOfPoint;
    auto feature = std::make_unique<OGRFeature>(definition_);
    // Without a place or a height it has no geometry, and a build counts it among those that it
    // leaves out.
    if (std::none_of(at, at + kNumbersOfPoint, [](double n) { return std::isnan(n); })) {
      feature->SetGeometryDirectly(new OGRPoint(at[0], at[1], at[2]));
    }
    feature->SetFID(next_++);
    return feature.release();
  }
  OGRFeatureDefn* GetLayerDefn() override { return definition_; }
  GIntBig GetFeatureCount(int) override { return points_; }
  int TestCapability(const char* what) override {
    return static_cast<int>(std::string_view(what) == OLCFastFeatureCount);
  }

 private:
  const double* numbers_;
  std::int64_t points_, next_ = 0;
  OGRFeatureDefn* definition_;
};

class PointDataset final : public GDALDataset {
 public:
  PointDataset(const double* numbers, std::int64_t points) : layer_(numbers, points) {}
  int GetLayerCount() override { return 1; }
  OGRLayer* GetLayer(int) override { return &layer_; }

 private:
  PointLayer layer_;
};

int is_points(GDALOpenInfo* info) {
  return static_cast<int>(std::string_view(info->pszFilename).ends_with(kPointsEnd));
}

GDALDataset* open_points(GDALOpenInfo* info) {
  if (is_points(info) == 0 || info->eAccess == GA_Update) return nullptr;
  vsi_l_offset bytes = 0;
  const void* const numbers = VSIGetMemFileBuffer(info->pszFilename, &bytes, FALSE);
  if (numbers == nullptr) return nullptr;
  return new PointDataset(static_cast<const double*>(numbers),
                          static_cast<std::int64_t>(bytes / (kNumbersOfPoint * sizeof(double))));
}

/// Has GDAL know the driver of such points. It is none for files on a disk.
void register_driver() {
  static std::once_flag once;
  std::call_once(once, [] {
    GDALAllRegister();
    auto driver = std::make_unique<GDALDriver>();
    driver->SetDescription("ptin points in memory");
    driver->SetMetadataItem(GDAL_DCAP_VECTOR, "YES");
    driver->pfnIdentify = is_points;
    driver->pfnOpen = open_points;
    GetGDALDriverManager()->RegisterDriver(driver.release());
  });
}

/// A folder of GDAL's memory file system that nobody else has.
std::string new_folder() {
  static std::atomic<std::uint64_t> next = 0;
  return "/vsimem/ptin-arrays/" + std::to_string(next++) + "/";
}

/// How GDAL is told of a raster whose numbers lie in a file without a header.
std::string vrt_of(const GridArray& grid, const std::string& file) {
  std::string steps;
  for (const double number : grid.geotransform) {
    steps += (steps.empty() ? "" : ", ") + std::string(CPLSPrintf("%.17g", number));
  }
  const std::string columns = std::to_string(grid.columns);
  const std::string line = std::to_string(grid.columns * grid.bytes_of_number);
  return "<VRTDataset rasterXSize=\"" + columns + "\" rasterYSize=\"" + std::to_string(grid.rows) +
         "\"><GeoTransform>" + steps + "</GeoTransform><VRTRasterBand dataType=\"" + grid.type +
         "\" band=\"1\" subClass=\"VRTRawRasterBand\"><SourceFilename relativeToVRT=\"1\">" + file +
         "</SourceFilename><ImageOffset>0</ImageOffset><PixelOffset>" +
         std::to_string(grid.bytes_of_number) + "</PixelOffset><LineOffset>" + line +
         "</LineOffset><ByteOrder>" + (std::endian::native == std::endian::little ? "LSB" : "MSB") +
         "</ByteOrder></VRTRasterBand></VRTDataset>";
}

}  // namespace

ArraySource::ArraySource(const GridArray& grid)
    : folder_(new_folder()), name_(folder_ + "array.vrt"), text_(vrt_of(grid, "array.bin")) {
  put(folder_ + "array.bin", grid.numbers, grid.columns * grid.rows * grid.bytes_of_number);
  put(name_, text_.data(), text_.size());
}

ArraySource::ArraySource(const double* numbers, std::size_t points)
    : folder_(new_folder()), name_(folder_ + "points" + std::string(kPointsEnd)) {
  register_driver();
  put(name_, numbers, points * kNumbersOfPoint * sizeof(double));
}

ArraySource::~ArraySource() { VSIRmdirRecursive(folder_.c_str()); }

void ArraySource::put(const std::string& file, const void* bytes, std::size_t size) {
  // GDAL is lent the memory to read, but takes no pointer to what may not change.
  auto* const lent = static_cast<GByte*>(const_cast<void*>(bytes));
  VSILFILE* const opened = VSIFileFromMemBuffer(file.c_str(), lent, size, FALSE);
  if (opened == nullptr) {
    throw Error(ErrorCode::internal, "GDAL takes no file in memory", file);
  }
  VSIFCloseL(opened);
}

}  // namespace ptin::python
