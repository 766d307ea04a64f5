// SPDX-License-Identifier: GPL-3.0-or-later
//
// Declarations of layers that OGR reads.
#include "tests/tools/declarations/declaration.h"

namespace ptin::tools::testing {

namespace {

constexpr const char* kCorners[] = {"0,0", "9,0", "9,9", "0,9"};

/// Four points as GeoJSON, and a fifth feature with this geometry and these attributes.
std::string geojson(const std::string& crs, const std::string& geometry,
                    const std::string& properties = "{}") {
  std::string text = R"({"type":"FeatureCollection",)" + crs + R"("features":[)";
  for (const char* corner : kCorners) {
    text += std::string(R"({"type":"Feature","properties":{"h":1,"h_ft":1},"geometry":)") +
            R"({"type":"Point","coordinates":[)" + corner + ",7]}},";
  }
  return text + R"({"type":"Feature","properties":)" + properties + R"(,"geometry":)" + geometry +
         "}]}";
}

std::string point(const std::string& coordinates) {
  return R"({"type":"Point","coordinates":[)" + coordinates + "]}";
}

const char* const kPlane = R"("crs":{"type":"name","properties":{"name":"EPSG:2154"}},)";

/// Points of a DXF whose header has this.
Declaration dxf(const std::string& key, const std::string& variable) {
  return {key, [=](const TestFolder& folder, bool is_declared) -> std::vector<std::string> {
            std::string text = "0\nSECTION\n2\nHEADER\n" + (is_declared ? variable : "") +
                               "0\nENDSEC\n0\nSECTION\n2\nENTITIES\n";
            for (const char* corner : kCorners) {
              text += std::string("0\nPOINT\n8\n0\n10\n") + corner[0] + "\n20\n" + corner[2] +
                      "\n30\n7\n";
            }
            write_file(folder.file("source.dxf"), text + "0\nENDSEC\n0\nEOF\n");
            return {folder.file("source.dxf")};
          }};
}

Declaration layer(const std::string& key, const std::string& declared,
                  const std::string& undeclared, const std::vector<std::string>& options = {}) {
  return {key, [=](const TestFolder& folder, bool is_declared) {
            write_file(folder.file("source.geojson"), is_declared ? declared : undeclared);
            std::vector<std::string> arguments = {folder.file("source.geojson")};
            arguments.insert(arguments.end(), options.begin(), options.end());
            return arguments;
          }};
}

}  // namespace

std::vector<Declaration> layer_declarations() {
  const std::string plain = geojson(kPlane, point("5,5,3"));
  return {
      layer("layer.crs", plain, geojson("", point("5,5,3"))),
      layer("layer.no_value", geojson(kPlane, point("5,5,-1.7e38")), plain),
      layer("layer.no_height", geojson(kPlane, point("5,5")), plain),
      layer("layer.lines",
            geojson(kPlane, R"({"type":"LineString","coordinates":[[1,1,1],[2,2,2]]})"), plain),
      dxf("layer.dxf_unit", "9\n$INSUNITS\n70\n2\n"),
      dxf("layer.dxf_inches", "9\n$INSUNITS\n70\n1\n"),
      {"layer.several_geometries",
       [](const TestFolder& folder, bool is_declared) -> std::vector<std::string> {
         write_file(folder.file("points.csv"), "x,y,z\n0,0,1\n9,0,2\n9,9,3\n0,9,4\n");
         const auto field = [](const std::string& name) {
           return "<GeometryField name='" + name +
                  "' encoding='PointFromColumns' x='x' y='y' z='z'/>";
         };
         write_file(folder.file("source.vrt"),
                    "<OGRVRTDataSource><OGRVRTLayer name='points'><SrcDataSource relativeToVRT='1'>"
                    "points.csv</SrcDataSource>" +
                        field("a") + (is_declared ? field("b") : "") +
                        "</OGRVRTLayer></OGRVRTDataSource>");
         return {folder.file("source.vrt"), "--layer", "points"};
       }},
      {"layer.unit_of_attribute",
       [](const TestFolder& folder, bool is_declared) -> std::vector<std::string> {
         write_file(folder.file("source.geojson"),
                    geojson(kPlane, point("5,5"), R"({"h":2,"h_ft":2})"));
         return {folder.file("source.geojson"), "--z-field", is_declared ? "h_ft" : "h"};
       }},
      {"layer.altitude_mode",
       [](const TestFolder& folder, bool is_declared) -> std::vector<std::string> {
         std::string text =
             R"(<kml xmlns="http://www.opengis.net/kml/2.2"><Document><Folder><name>a</name>)";
         for (const char* corner : kCorners) {
           text += std::string("<Placemark><Point><altitudeMode>") +
                   (is_declared ? "relativeToGround" : "absolute") +
                   "</altitudeMode><coordinates>" + corner + ",7</coordinates></Point></Placemark>";
         }
         write_file(folder.file("source.kml"), text + "</Folder></Document></kml>");
         return {folder.file("source.kml")};
       }},
  };
}

}  // namespace ptin::tools::testing
