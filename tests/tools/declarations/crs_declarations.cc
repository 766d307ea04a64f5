// SPDX-License-Identifier: GPL-3.0-or-later
//
// Declarations of a CRS, in sources of all kinds, that GDAL alone does not tell.
#include <array>
#include <cstring>
#include <stdexcept>
#include <utility>

#include <cpl_conv.h>
#include <gdal_priv.h>
#include <ogrsf_frmts.h>

#include "tests/support/las_file.h"
#include "tests/tools/declarations/declaration.h"

namespace ptin::tools::testing {

namespace {

using Options = std::vector<std::string>;
using KeyEntry = std::array<std::uint16_t, 4>;

constexpr const char* kSiteMetres =
    R"(LOCAL_CS["site",UNIT["metre",1],AXIS["x",EAST],AXIS["y",NORTH]])";
constexpr const char* kSiteUnknown =
    R"(LOCAL_CS["site",UNIT["unknown",1],AXIS["x",EAST],AXIS["y",NORTH]])";
constexpr const char* kNameless =
    R"(LOCAL_CS["unnamed",UNIT["metre",1],AXIS["x",EAST],AXIS["y",NORTH]])";

/// ESRI's text of a compound CRS whose heights are shifted.
std::string shifted_heights(const std::string& shift) {
  return R"(PROJCS["WGS_1984_UTM_Zone_33N",GEOGCS["GCS_WGS_1984",DATUM["D_WGS_1984",)"
         R"(SPHEROID["WGS_1984",6378137.0,298.257223563]],PRIMEM["Greenwich",0.0],)"
         R"(UNIT["Degree",0.0174532925199433]],PROJECTION["Transverse_Mercator"],)"
         R"(PARAMETER["False_Easting",500000.0],PARAMETER["False_Northing",0.0],)"
         R"(PARAMETER["Central_Meridian",15.0],PARAMETER["Scale_Factor",0.9996],)"
         R"(PARAMETER["Latitude_Of_Origin",0.0],UNIT["Meter",1.0]],)"
         R"(VERTCS["NAVD_1988",VDATUM["North_American_Vertical_Datum_1988"],)"
         R"(PARAMETER["Vertical_Shift",)" +
         shift + R"(],PARAMETER["Direction",1.0],UNIT["Meter",1.0]])";
}

/// A raster with these elements beside its band.
Options vrt_with(const TestFolder& folder, const std::string& srs, const std::string& metadata) {
  RasterRecipe recipe;
  recipe.value = hills;
  make_raster(folder.file("base.tif"), recipe);
  write_file(folder.file("source.vrt"),
             R"(<VRTDataset rasterXSize="33" rasterYSize="33">)" +
                 (srs.empty() ? srs : "<SRS>" + srs + "</SRS>") +
                 "<GeoTransform>50, 1, 0, 40, 0, -1</GeoTransform>" +
                 (metadata.empty() ? metadata : "<Metadata>" + metadata + "</Metadata>") +
                 R"(<VRTRasterBand dataType="Float32" band="1"><SimpleSource>)"
                 R"(<SourceFilename relativeToVRT="1">base.tif</SourceFilename></SimpleSource>)"
                 "</VRTRasterBand></VRTDataset>");
  return {folder.file("source.vrt")};
}

Declaration of_srs(const std::string& key, const std::string& without, const std::string& with) {
  return {key, [=](const TestFolder& folder, bool is_declared) {
            return vrt_with(folder, is_declared ? with : without, "");
          }};
}

Declaration of_items(const std::string& key, const std::string& srs, const std::string& items) {
  return {key, [=](const TestFolder& folder, bool is_declared) {
            return vrt_with(folder, srs, is_declared ? items : "");
          }};
}

/// A grid as text beside a .prj of this content; without one where it is empty.
Declaration of_prj(const std::string& key, const std::string& without, const std::string& with) {
  return {key, [=](const TestFolder& folder, bool is_declared) -> Options {
            write_file(folder.file("source.asc"),
                       "ncols 3\nnrows 2\nxllcorner 500000\nyllcorner 4000000\ncellsize 30\n"
                       "NODATA_value -9999\n1 2 3\n2 3 5\n");
            const std::string& text = is_declared ? with : without;
            if (!text.empty()) write_file(folder.file("source.prj"), text);
            return {folder.file("source.asc")};
          }};
}

std::string directory_of(const std::vector<KeyEntry>& entries) {
  std::vector<std::uint16_t> words = {1, 1, 0, static_cast<std::uint16_t>(entries.size())};
  for (const KeyEntry& e : entries) words.insert(words.end(), e.begin(), e.end());
  return {reinterpret_cast<const char*>(words.data()), words.size() * 2};
}

/// A TIFF of 2 x 2 floats with GeoTIFF keys.
std::string tiff_with(const std::vector<KeyEntry>& entries, const std::string& text) {
  std::string data, file;
  const auto put = [](std::string& to, auto value) {
    to.append(reinterpret_cast<const char*>(&value), sizeof value);
  };
  std::vector<std::array<std::uint32_t, 4>> tags = {
      {256, 3, 1, 2}, {257, 3, 1, 2}, {258, 3, 1, 32}, {259, 3, 1, 1}, {262, 3, 1, 1}};
  const auto add = [&](std::uint32_t tag, std::uint32_t type, std::size_t count,
                       const std::string& content) {
    tags.push_back({tag, type, static_cast<std::uint32_t>(count),
                    8 + static_cast<std::uint32_t>(data.size())});
    data += content;
    data.resize((data.size() + 7) / 8 * 8);
  };
  std::string pixels, scale, tiepoint;
  for (const float v : {1.0F, 2.0F, 3.0F, 5.0F}) put(pixels, v);
  for (const double v : {30.0, 30.0, 0.0}) put(scale, v);
  for (const double v : {0.0, 0.0, 0.0, 500000.0, 4000000.0, 0.0}) put(tiepoint, v);
  tags.push_back({273, 4, 1, 8});
  data += pixels;
  tags.push_back({277, 3, 1, 1});
  tags.push_back({278, 3, 1, 2});
  tags.push_back({279, 4, 1, 16});
  tags.push_back({339, 3, 1, 3});
  add(33550, 12, 3, scale);
  add(33922, 12, 6, tiepoint);
  const std::string directory = directory_of(entries);
  add(34735, 3, directory.size() / 2, directory);
  if (!text.empty()) add(34737, 2, text.size() + 1, text + '\0');
  file = "II*";
  file.resize(4);
  put(file, static_cast<std::uint32_t>(8 + data.size()));
  file += data;
  put(file, static_cast<std::uint16_t>(tags.size()));
  for (const auto& [tag, type, count, value] : tags) {
    put(file, static_cast<std::uint16_t>(tag));
    put(file, static_cast<std::uint16_t>(type));
    put(file, count);
    put(file, value);
  }
  put(file, std::uint32_t{0});
  return file;
}

const KeyEntry kModel = {1024, 0, 1, 1}, kZone11 = {3072, 0, 1, 32611};

Declaration of_tiff_keys(const std::string& key, const std::vector<KeyEntry>& more,
                         const std::string& text) {
  return {key, [=](const TestFolder& folder, bool is_declared) -> Options {
            std::vector<KeyEntry> entries = {kModel, kZone11};
            if (is_declared) entries.insert(entries.end(), more.begin(), more.end());
            write_file(folder.file("source.tif"), tiff_with(entries, is_declared ? text : ""));
            return {folder.file("source.tif")};
          }};
}

/// DTED of one degree, whose heights are above the ellipsoid or above the geoid of 1996.
Options elevation_cell(const TestFolder& folder, bool is_declared) {
  RasterRecipe recipe;
  recipe.width = recipe.height = 121;
  recipe.type = "Int16";
  recipe.value = hills;
  recipe.epsg = 4326;
  recipe.west = 10 - 1 / 240.0;
  recipe.north = 46 + 1 / 240.0;
  recipe.pixel = 1 / 120.0;
  make_raster(folder.file("base.tif"), recipe);
  GDALAllRegister();
  {
    const GDALDatasetUniquePtr base(GDALDataset::Open(folder.file("base.tif").c_str()));
    GDALDriver* const driver = GetGDALDriverManager()->GetDriverByName("DTED");
    GDALClose(driver->CreateCopy(folder.file("source.dt0").c_str(), base.get(), FALSE, nullptr,
                                 nullptr, nullptr));
  }
  std::string bytes = read_file(folder.file("source.dt0"));
  bytes.replace(221, 3, is_declared ? "MSL" : "WGS");
  write_file(folder.file("source.dt0"), bytes);
  return {folder.file("source.dt0")};
}

std::vector<Declaration> of_raster_texts() {
  return {
      of_prj("raster.crs.not_understood", "", "not a projection"),
      of_srs("raster.crs.nameless", kSiteMetres, kNameless),
      of_srs("raster.crs.unit_unknown", kSiteMetres, kSiteUnknown),
      of_items("raster.crs.degrees", "",
               R"(<MDI key="x#units">degrees_east</MDI><MDI key="y#units">degrees_north</MDI>)"),
      {"raster.crs.vertical.dted", &elevation_cell},
      of_tiff_keys("raster.crs.vertical.unknown", {{4096, 0, 1, 12345}}, ""),
      of_tiff_keys("raster.crs.vertical.in_words", {{4097, 34737, 7, 0}}, "NAVD88|"),
      of_items("raster.crs.vertical.of_netcdf", "EPSG:4326",
               R"(<MDI key="crs#geoid_name">NAVD88</MDI>)"),
      of_prj("raster.crs.vertical.shift", shifted_heights("0.0"), shifted_heights("100.0")),
      of_prj("raster.unit.zunits",
             "Projection UTM\nZone 11\nDatum NAD27\nUnits METERS\nParameters\n",
             "Projection UTM\nZone 11\nDatum NAD27\nZunits FEET\nUnits METERS\nParameters\n"),
  };
}

Declaration of_las_records(const std::string& key, const std::vector<LasRecord>& without,
                           const std::vector<LasRecord>& with, const char* user = nullptr) {
  return {key, [=](const TestFolder& folder, bool is_declared) -> Options {
            LasFileMaker las;
            for (int i = 0; i < 25; ++i)
              las.points.push_back({1000 * (i % 5), 1000 * (i / 5), 100 * (i % 5 + i / 5)});
            las.records = is_declared ? with : without;
            std::string bytes = las.bytes();
            if (user != nullptr && is_declared) {
              std::string name = user;
              name.resize(15);
              bytes.replace(bytes.find("LASF_Projection"), 15, name);
            }
            write_file(folder.file("source.las"), bytes);
            return {folder.file("source.las")};
          }};
}

LasRecord las_keys(const std::vector<KeyEntry>& entries) { return {34735, directory_of(entries)}; }

std::vector<Declaration> of_las_keys() {
  const LasRecord zone = las_keys({kModel, kZone11});
  const KeyEntry own = {1024, 0, 1, 32767}, own_plane = {3072, 0, 1, 32767},
                 citation = {1026, 34737, 5, 0}, metres = {3076, 0, 1, 9001};
  return {
      of_las_records("las.crs_of_liblas", {}, {{2112, "EPSG:32611"}}, "liblas"),
      of_las_records("las.crs_code_unknown", {}, {las_keys({kModel, {3072, 0, 1, 29999}})}),
      of_las_records("las.crs_without_model", {}, {las_keys({{1024, 0, 1, 0}, kZone11})}),
      of_las_records("las.crs_unit_unknown",
                     {las_keys({own, citation, own_plane, metres}), {34737, "site|"}},
                     {las_keys({own, citation, own_plane}), {34737, "site|"}}),
      of_las_records("las.vertical_in_words", {zone},
                     {las_keys({kModel, kZone11, {4097, 34737, 7, 0}}), {34737, "NAVD88|"}}),
      of_las_records("las.vertical_shift", {{2112, shifted_heights("0.0")}},
                     {{2112, shifted_heights("-3.5 ")}}),
  };
}

/// Four points as a shapefile beside this .prj.
Declaration of_shapefile(const std::string& key, const std::string& without,
                         const std::string& with) {
  return {key, [=](const TestFolder& folder, bool is_declared) -> Options {
            GDALAllRegister();
            GDALDriver* const driver = GetGDALDriverManager()->GetDriverByName("ESRI Shapefile");
            const std::string path = folder.file("source.shp");
            {
              const GDALDatasetUniquePtr data(
                  driver->Create(path.c_str(), 0, 0, 0, GDT_Unknown, nullptr));
              OGRLayer* const layer = data->CreateLayer("source", nullptr, wkbPoint25D, nullptr);
              for (const double x : {500000.0, 500100.0}) {
                for (const double y : {5000000.0, 5000100.0}) {
                  OGRFeature feature(layer->GetLayerDefn());
                  OGRPoint point(x, y, (x + y) / 1e6);
                  feature.SetGeometry(&point);
                  if (layer->CreateFeature(&feature) != OGRERR_NONE) throw std::runtime_error(path);
                }
              }
            }
            const std::string& text = is_declared ? with : without;
            if (!text.empty()) write_file(folder.file("source.prj"), text);
            return {path};
          }};
}

Options geojson_in(const TestFolder& folder, const std::string& crs) {
  std::string text = R"({"type":"FeatureCollection","crs":{"type":"name","properties":{"name":")" +
                     crs + R"("}},"features":[)";
  for (const char* corner : {"0,0", "9,0", "9,9", "0,9"}) {
    text += std::string(text.back() == '[' ? "" : ",") +
            R"({"type":"Feature","properties":{},"geometry":{"type":"Point","coordinates":[)" +
            corner + ",7]}}";
  }
  write_file(folder.file("source.geojson"), text + "]}");
  return {folder.file("source.geojson")};
}

Options gml_in(const TestFolder& folder, const std::string& crs) {
  std::string text =
      R"(<?xml version="1.0"?><ogr:FeatureCollection xmlns:ogr="http://ogr.maptools.org/" )"
      R"(xmlns:gml="http://www.opengis.net/gml/3.2">)";
  for (const char* corner : {"0 0", "0 100", "100 100", "100 0"}) {
    text += R"(<gml:featureMember><ogr:t gml:id="t"><ogr:geom><gml:Point gml:id="p" srsName=")" +
            crs + R"(" srsDimension="3"><gml:pos>)" + corner +
            " 7</gml:pos></gml:Point></ogr:geom></ogr:t></gml:featureMember>";
  }
  write_file(folder.file("source.gml"), text + "</ogr:FeatureCollection>");
  return {folder.file("source.gml")};
}

std::vector<Declaration> of_layer_texts() {
  return {
      {"layer.crs_not_understood",
       [](const TestFolder& folder, bool is_declared) {
         return geojson_in(folder, is_declared ? "urn:ogc:def:crs:EPSG::999999" : "EPSG:2154");
       }},
      of_shapefile("layer.crs_not_understood_beside", "", "garbage prj"),
      of_shapefile("layer.vertical_shift", shifted_heights("0.0"), shifted_heights("100.0")),
      {"layer.vertical_crs_of_gml",
       [](const TestFolder& folder, bool is_declared) {
         return gml_in(folder, is_declared ? "urn:ogc:def:crs,crs:EPSG::25832,crs:EPSG::7837"
                                           : "urn:ogc:def:crs:EPSG::25832");
       }},
      {"mesh.landxml_code_as_name",
       [](const TestFolder& folder, bool is_declared) -> Options {
         write_file(folder.file("source.xml"),
                    std::string(R"(<LandXML><Units><Metric linearUnit="meter"/></Units>)") +
                        (is_declared ? R"(<CoordinateSystem horizontalDatum="EPSG:2056"/>)" : "") +
                        R"(<Surfaces><Surface name="a"><Definition surfType="TIN"><Pnts>)"
                        R"(<P id="1">0 0 1</P><P id="2">0 9 2</P><P id="3">9 9 3</P>)"
                        "</Pnts><Faces><F>1 2 3</F></Faces></Definition></Surface></Surfaces>"
                        "</LandXML>");
         return {folder.file("source.xml")};
       }},
  };
}

}  // namespace

std::vector<Declaration> crs_declarations() {
  std::vector<Declaration> all = of_raster_texts();
  for (const std::vector<Declaration>& more : {of_las_keys(), of_layer_texts()}) {
    all.insert(all.end(), more.begin(), more.end());
  }
  return all;
}

}  // namespace ptin::tools::testing
