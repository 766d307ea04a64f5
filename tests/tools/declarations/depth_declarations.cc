// SPDX-License-Identifier: GPL-3.0-or-later
//
// Sources that declare depths where heights belong.
#include <stdexcept>

#include <cpl_conv.h>
#include <gdal_priv.h>
#include <ogrsf_frmts.h>

#include "tests/tools/declarations/declaration.h"

namespace ptin::tools::testing {

namespace {

/// A raster whose band has this element where it declares.
Declaration of_depth_band(const std::string& key, const std::string& element) {
  return {key, [=](const TestFolder& folder, bool is_declared) -> std::vector<std::string> {
            RasterRecipe recipe;
            recipe.value = hills;
            make_raster(folder.file("base.tif"), recipe);
            write_file(folder.file("source.vrt"),
                       R"(<VRTDataset rasterXSize="33" rasterYSize="33"><SRS>EPSG:32611</SRS>)"
                       "<GeoTransform>500000, 30, 0, 4000000, 0, -30</GeoTransform>"
                       R"(<VRTRasterBand dataType="Float32" band="1">)" +
                           (is_declared ? element : "") +
                           R"(<SimpleSource><SourceFilename relativeToVRT="1">base.tif)"
                           "</SourceFilename></SimpleSource></VRTRasterBand></VRTDataset>");
            return {folder.file("source.vrt")};
          }};
}

std::string item(const std::string& key, const std::string& value) {
  return "<Metadata><MDI key=\"" + key + "\">" + value + "</MDI></Metadata>";
}

/// Four soundings of a nautical chart, in metres.
void write_chart(const std::string& path) {
  GDALAllRegister();
  GDALDriver* const driver = GetGDALDriverManager()->GetDriverByName("S57");
  const GDALDatasetUniquePtr chart(driver->Create(path.c_str(), 0, 0, 0, GDT_Unknown, nullptr));
  if (chart == nullptr) throw std::runtime_error("cannot write " + path);
  const auto add = [&](const char* name, const std::vector<std::pair<const char*, int>>& numbers,
                       const std::vector<std::pair<const char*, const char*>>& lists,
                       const char* wkt) {
    OGRLayer* const layer = chart->GetLayerByName(name);
    OGRFeature feature(layer->GetLayerDefn());
    for (const auto& [field, value] : numbers) feature.SetField(field, value);
    for (const auto& [field, value] : lists) feature.SetField(field, value);
    OGRGeometry* geometry = nullptr;
    if (wkt != nullptr) OGRGeometryFactory::createFromWkt(wkt, nullptr, &geometry);
    feature.SetGeometryDirectly(geometry);
    if (layer->CreateFeature(&feature) != OGRERR_NONE) throw std::runtime_error(name);
  };
  add("IsolatedNode", {{"RCNM", 110}, {"RCID", 1}, {"RVER", 1}, {"RUIN", 1}}, {},
      "MULTIPOINT Z ((10 45 3.5),(10.1 45 12),(10 45.1 20),(10.1 45.1 7))");
  add("SOUNDG",
      {{"RCID", 1},
       {"PRIM", 1},
       {"GRUP", 2},
       {"OBJL", 129},
       {"RVER", 1},
       {"AGEN", 540},
       {"FIDN", 1},
       {"FIDS", 1}},
      {{"NAME_RCNM", "(1:110)"},
       {"NAME_RCID", "(1:1)"},
       {"ORNT", "(1:255)"},
       {"USAG", "(1:255)"},
       {"MASK", "(1:255)"}},
      nullptr);
}

/// Four points in a layer of this name, of which an attribute has another one.
std::vector<std::string> points_named(const TestFolder& folder, const std::string& layer,
                                      const std::string& attribute) {
  std::string text = R"({"type":"FeatureCollection","name":")" + layer +
                     R"(","crs":{"type":"name","properties":{"name":"EPSG:2154"}},"features":[)";
  for (const char* corner : {"0,0", "9,0", "9,9", "0,9"}) {
    text += std::string(text.back() == '[' ? "" : ",") + R"({"type":"Feature","properties":{")" +
            attribute + R"(":5},"geometry":{"type":"Point","coordinates":[)" + corner + ",7]}}";
  }
  write_file(folder.file("source.geojson"), text + "]}");
  return {folder.file("source.geojson")};
}

}  // namespace

std::vector<Declaration> depth_declarations() {
  return {
      of_depth_band("raster.positive_down", item("positive", "down")),
      of_depth_band("raster.standard_name_of_depths",
                    item("standard_name", "sea_floor_depth_below_geoid")),
      of_depth_band("raster.name_of_depths", "<Description>Depth (m)</Description>"),
      {"layer.soundings",
       [](const TestFolder& folder, bool is_declared) -> std::vector<std::string> {
         if (!is_declared) return points_named(folder, "tops", "h");
         write_chart(folder.file("source.000"));
         return {folder.file("source.000")};
       }},
      {"layer.name_of_depths",
       [](const TestFolder& folder, bool is_declared) {
         return points_named(folder, is_declared ? "Soundings_2019" : "tops", "h");
       }},
      {"layer.attribute_of_depths",
       [](const TestFolder& folder, bool is_declared) {
         const std::string name = is_declared ? "DEPTH" : "h";
         std::vector<std::string> arguments = points_named(folder, "tops", name);
         arguments.insert(arguments.end(), {"--z-field", name});
         return arguments;
       }},
  };
}

}  // namespace ptin::tools::testing
