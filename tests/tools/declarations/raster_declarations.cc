// SPDX-License-Identifier: GPL-3.0-or-later
//
// Declarations of rasters.
#include <cfloat>
#include <stdexcept>
#include <utility>

#include <cpl_conv.h>
#include <cpl_string.h>
#include <gdal_priv.h>

#include "tests/tools/declarations/declaration.h"

namespace ptin::tools::testing {

namespace {

using Arguments = std::vector<std::string>;

constexpr const char* kPlace = "<GeoTransform>500000, 30, 0, 4000000, 0, -30</GeoTransform>";
constexpr const char* kDegrees = "<GeoTransform>7, 0.01, 0, 46, 0, -0.01</GeoTransform>";
constexpr const char* kUtmSrs = "<SRS>EPSG:32611</SRS>";

/// The parts of a VRT over base.tif, which holds hills of a type, but for (5, 5).
struct Vrt {
  std::string place = kPlace;
  std::string crs = kUtmSrs;
  std::string of_file{};
  std::string type = "Float32";
  std::string of_band{};
  std::string more_bands{};
};

std::string source_of(const std::string& name) {
  return R"(<SimpleSource><SourceFilename relativeToVRT="1">)" + name +
         "</SourceFilename><SourceBand>1</SourceBand></SimpleSource>";
}

/// 0 at (5, 5), else 255.
void make_mask(const std::string& path) {
  RasterRecipe mask;
  mask.type = "Byte";
  mask.value = [](int x, int y) { return x == 5 && y == 5 ? 0.0 : 255.0; };
  make_raster(path, mask);
}

Arguments written(const TestFolder& folder, const Vrt& vrt, double odd = 60.0) {
  RasterRecipe base;
  base.type = "Float64";
  base.value = [odd](int x, int y) { return x == 5 && y == 5 ? odd : hills(x, y); };
  make_raster(folder.file("base.tif"), base);
  make_mask(folder.file("mask.tif"));
  const std::string source = folder.file("source.vrt");
  write_file(source, R"(<VRTDataset rasterXSize="33" rasterYSize="33">)" + vrt.crs + vrt.place +
                         vrt.of_file + R"(<VRTRasterBand dataType=")" + vrt.type +
                         R"(" band="1">)" + vrt.of_band + source_of("base.tif") +
                         "</VRTRasterBand>" + vrt.more_bands + "</VRTDataset>");
  return {source};
}

/// A row whose source is a VRT, of which `declare` sets what is declared.
Declaration of_vrt(const char* key, void (*declare)(Vrt& vrt), double odd = 60.0) {
  return {key, [declare, odd](const TestFolder& folder, bool is_declared) {
            Vrt vrt;
            if (is_declared) declare(vrt);
            return written(folder, vrt, odd);
          }};
}
/// A row of two VRTs, one with the declaration and one without, that `make` writes.
Declaration of_vrts(const char* key, void (*make)(Vrt& vrt, bool is_declared)) {
  return {key, [make](const TestFolder& folder, bool is_declared) {
            Vrt vrt;
            make(vrt, is_declared);
            return written(folder, vrt);
          }};
}

std::string metadata(const char* domain, const char* items) {
  return std::string("<Metadata domain=\"") + domain + "\">" + items + "</Metadata>";
}

/// No place and no CRS.
void nowhere(Vrt& vrt) { vrt.place = vrt.crs = ""; }

/// The VRT as a GeoTIFF.
Arguments as_geotiff(const TestFolder& folder, const Vrt& vrt, const CPLStringList& options) {
  const GDALDatasetUniquePtr data(GDALDataset::Open(written(folder, vrt).front().c_str()));
  const std::string path = folder.file("source.tif");
  GDALDriver* driver = GetGDALDriverManager()->GetDriverByName("GTiff");
  GDALDatasetH made = driver->CreateCopy(path.c_str(), data.get(), FALSE,
                                         const_cast<char**>(options.List()), nullptr, nullptr);
  if (made == nullptr) throw std::runtime_error("cannot write " + path);
  GDALClose(made);
  return {path};
}

/// GeoTIFF 1.0, whose vertical part GDAL does not tell by itself.
Arguments old_geotiff(const TestFolder& folder, bool is_declared) {
  Vrt vrt;
  if (is_declared) vrt.crs = "<SRS>EPSG:32611+5773</SRS>";
  CPLStringList options;
  options.AddString("GEOTIFF_VERSION=1.0");
  return as_geotiff(folder, vrt, options);
}

/// One tiepoint, of a pixel's centre or of its corner.
Arguments pixel_is_point(const TestFolder& folder, bool is_declared) {
  const CPLConfigOptionSetter as_given("GTIFF_POINT_GEO_IGNORE", "YES", false);
  Vrt vrt;
  if (is_declared) vrt.of_file = R"(<Metadata><MDI key="AREA_OR_POINT">Point</MDI></Metadata>)";
  return as_geotiff(folder, vrt, {});
}

Arguments pages(const TestFolder& folder, bool is_declared) {
  Arguments made = as_geotiff(folder, {}, {});
  if (is_declared) {
    CPLStringList options;
    options.AddString("APPEND_SUBDATASET=YES");
    as_geotiff(folder, {}, options);
  }
  return made;
}

Arguments largest_float(const TestFolder& folder, bool is_declared) {
  return written(folder, {}, is_declared ? -double{FLT_MAX} : 60.0);
}

Arguments undeclared(const TestFolder& folder, bool is_declared) {
  return written(folder, {}, is_declared ? -9999.0 : 60.0);
}

Arguments with_nodata(const TestFolder& folder, bool is_declared) {
  RasterRecipe recipe;
  recipe.value = [](int x, int y) { return x == 5 && y == 5 ? -32768.0 : hills(x, y); };
  if (is_declared) recipe.nodata = -32768.0;
  make_raster(folder.file("source.tif"), recipe);
  return {folder.file("source.tif")};
}

std::vector<Declaration> of_validity() {
  return {
      {"raster.nodata", &with_nodata},
      of_vrt(
          "raster.nodata.digits",
          [](Vrt& v) { v.of_band = "<NoDataValue>-9999.9</NoDataValue><Scale>0.5</Scale>"; },
          -9999.9),
      of_vrt("raster.nodata.other_type",
             [](Vrt& v) {
               v.type = "Int16";
               v.of_band = "<NoDataValue>100000</NoDataValue>";
             }),
      of_vrt(
          "raster.nodata.dataset",
          [](Vrt& v) { v.of_file = R"(<Metadata><MDI key="NODATA_VALUES">60</MDI></Metadata>)"; }),
      {"raster.nodata.undeclared", &undeclared},
      {"raster.largest_float", &largest_float},
      of_vrt("raster.mask",
             [](Vrt& v) {
               v.more_bands = R"(<MaskBand><VRTRasterBand dataType="Byte">)" +
                              source_of("mask.tif") + "</VRTRasterBand></MaskBand>";
             }),
      of_vrt(
          "raster.alpha",
          [](Vrt& v) {
            v.more_bands =
                R"(<VRTRasterBand dataType="Float32" band="2"><ColorInterp>Alpha</ColorInterp>)" +
                source_of("mask.tif") + "</VRTRasterBand>";
          }),
  };
}

std::vector<Declaration> of_heights() {
  return {
      of_vrt("raster.scale", [](Vrt& v) { v.of_band = "<Scale>0.1</Scale>"; }),
      of_vrt("raster.offset", [](Vrt& v) { v.of_band = "<Offset>-500</Offset>"; }),
      of_vrt("raster.unit", [](Vrt& v) { v.of_band = "<UnitType>ft</UnitType>"; }),
      of_vrt("raster.unit.unknown", [](Vrt& v) { v.of_band = "<UnitType>cubit</UnitType>"; }),
      of_vrts("raster.unit.beside_vertical_crs",
              [](Vrt& v, bool is_declared) {
                v.crs = "<SRS>EPSG:32611+5773</SRS>";
                if (is_declared) v.of_band = "<UnitType>ft</UnitType>";
              }),
      of_vrt("raster.palette",
             [](Vrt& v) {
               v.type = "Byte";
               v.of_band =
                   R"(<ColorInterp>Palette</ColorInterp><ColorTable><Entry c1="0" c2="0" c3="0" )"
                   R"(c4="255"/><Entry c1="9" c2="9" c3="9" c4="255"/></ColorTable>)";
             }),
      of_vrt("raster.categories",
             [](Vrt& v) {
               v.of_band =
                   "<CategoryNames><Category>water</Category><Category>wood</Category>"
                   "</CategoryNames>";
             }),
      of_vrt("raster.complex", [](Vrt& v) { v.type = "CFloat32"; }),
      of_vrt("raster.bands",
             [](Vrt& v) {
               v.more_bands = R"(<VRTRasterBand dataType="Float32" band="2">)" +
                              source_of("base.tif") + "</VRTRasterBand>";
             }),
      {"raster.subdatasets", &pages},
  };
}

std::vector<Declaration> of_place() {
  return {
      of_vrt(
          "raster.geotransform",
          [](Vrt& v) { v.place = "<GeoTransform>500000, 10, 0, 4000000, 0, -20</GeoTransform>"; }),
      of_vrt(
          "raster.geotransform.rotated",
          [](Vrt& v) { v.place = "<GeoTransform>500000, 30, 3, 4000000, 3, -30</GeoTransform>"; }),
      of_vrt("raster.geotransform.none", &nowhere),
      of_vrt("raster.geotransform.none_beside_crs", [](Vrt& v) { v.place = ""; }),
      of_vrt(
          "raster.gcps",
          [](Vrt& v) {
            nowhere(v);
            v.of_file =
                R"(<GCPList Projection="EPSG:32611"><GCP Id="1" Pixel="0" Line="0" X="0" Y="99"/>)"
                R"(<GCP Id="2" Pixel="33" Line="0" X="99" Y="99"/>)"
                R"(<GCP Id="3" Pixel="0" Line="33" X="0" Y="0"/></GCPList>)";
          }),
      of_vrt("raster.rpc",
             [](Vrt& v) {
               nowhere(v);
               v.of_file = metadata("RPC", R"(<MDI key="LINE_OFF">4</MDI>)");
             }),
      of_vrt("raster.geolocation",
             [](Vrt& v) {
               nowhere(v);
               v.of_file = metadata("GEOLOCATION", R"(<MDI key="X_DATASET">lon.tif</MDI>)");
             }),
      {"raster.area_or_point", &pixel_is_point},
  };
}

std::vector<Declaration> of_raster_crs() {
  return {
      of_vrt("raster.crs", [](Vrt& v) { v.crs = "<SRS>EPSG:26911</SRS>"; }),
      of_vrt("raster.crs.local",
             [](Vrt& v) {
               v.crs =
                   R"(<SRS>LOCAL_CS["site",UNIT["metre",1],AXIS["x",EAST],AXIS["y",NORTH]]</SRS>)";
             }),
      of_vrts("raster.crs.bound",
              [](Vrt& v, bool is_declared) {
                v.crs = std::string("<SRS>+proj=utm +zone=11 +ellps=bessel ") +
                        (is_declared ? "+towgs84=598,73,418 " : "") + "+type=crs</SRS>";
              }),
      of_vrt("raster.crs.vertical", [](Vrt& v) { v.crs = "<SRS>EPSG:32611+5773</SRS>"; }),
      {"raster.crs.vertical.geotiff10", &old_geotiff},
      of_vrt("raster.crs.vertical.depth", [](Vrt& v) { v.crs = "<SRS>EPSG:32611+5831</SRS>"; }),
      of_vrts("raster.crs.axis_order",
              [](Vrt& v, bool is_declared) {
                v.place = kDegrees;
                v.crs = std::string(R"(<SRS dataAxisToSRSAxisMapping=")") +
                        (is_declared ? "1,2" : "2,1") + R"(">EPSG:4326</SRS>)";
              }),
      of_vrt("raster.crs.axis_direction", [](Vrt& v) { v.crs = "<SRS>EPSG:2046</SRS>"; }),
      of_vrts("raster.crs.epoch",
              [](Vrt& v, bool is_declared) {
                v.place = kDegrees;
                v.crs = std::string(R"(<SRS dataAxisToSRSAxisMapping="2,1")") +
                        (is_declared ? R"( coordinateEpoch="2021.3")" : "") + ">EPSG:9000</SRS>";
              }),
  };
}

}  // namespace

std::vector<Declaration> raster_declarations() {
  GDALAllRegister();
  std::vector<Declaration> all = of_validity();
  for (const std::vector<Declaration>& more : {of_heights(), of_place(), of_raster_crs()}) {
    all.insert(all.end(), more.begin(), more.end());
  }
  return all;
}

}  // namespace ptin::tools::testing
