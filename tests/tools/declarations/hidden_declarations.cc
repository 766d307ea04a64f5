// SPDX-License-Identifier: GPL-3.0-or-later
//
// Declarations of drawings: features that are no part of the ground, a CRS that is not read.
#include "tests/tools/declarations/declaration.h"

namespace ptin::tools::testing {

namespace {

std::string dxf_point(const std::string& x, const std::string& y, const std::string& z,
                      const std::string& layer = "0", const std::string& more = "") {
  return "0\nPOINT\n8\n" + layer + "\n" + more + "10\n" + x + "\n20\n" + y + "\n30\n" + z + "\n";
}

std::string dxf_layer(const std::string& name, const std::string& flags, const std::string& color) {
  return "0\nLAYER\n2\n" + name + "\n70\n" + flags + "\n62\n" + color + "\n6\nCONTINUOUS\n";
}

/// Four points of a DXF, and a fifth at this layer, with these groups.
Declaration hidden_in_dxf(const std::string& key, const std::string& layer,
                          const std::string& more = "") {
  return {key, [=](const TestFolder& folder, bool is_declared) -> std::vector<std::string> {
            write_file(
                folder.file("source.dxf"),
                "0\nSECTION\n2\nTABLES\n0\nTABLE\n2\nLAYER\n70\n3\n" + dxf_layer("0", "0", "7") +
                    dxf_layer("FROZEN", "1", "7") + dxf_layer("OFF", "0", "-7") +
                    "0\nENDTAB\n0\nENDSEC\n0\nSECTION\n2\nENTITIES\n" + dxf_point("0", "0", "7") +
                    dxf_point("9", "0", "7") + dxf_point("9", "9", "7") + dxf_point("0", "9", "7") +
                    (is_declared ? dxf_point("5", "5", "999", layer, more)
                                 : dxf_point("5", "5", "999")) +
                    "0\nENDSEC\n0\nEOF\n");
            return {folder.file("source.dxf")};
          }};
}

}  // namespace

std::vector<Declaration> hidden_declarations() {
  return {
      hidden_in_dxf("layer.dxf_paper_space", "0", "67\n1\n"),
      hidden_in_dxf("layer.dxf_frozen", "FROZEN"),
      hidden_in_dxf("layer.dxf_off", "OFF"),
      hidden_in_dxf("layer.dxf_invisible", "0", "60\n1\n"),
      {"layer.dxf_geodata",
       [](const TestFolder& folder, bool is_declared) -> std::vector<std::string> {
         write_file(folder.file("source.dxf"),
                    "0\nSECTION\n2\nENTITIES\n" + dxf_point("0", "0", "7") +
                        dxf_point("9", "0", "7") + dxf_point("9", "9", "7") +
                        "0\nENDSEC\n0\nSECTION\n2\nOBJECTS\n0\n" +
                        (is_declared ? "GEODATA" : "DICTIONARY") + "\n5\nA1\n0\nENDSEC\n0\nEOF\n");
         return {folder.file("source.dxf")};
       }},
      {"layer.kml_visibility",
       [](const TestFolder& folder, bool is_declared) -> std::vector<std::string> {
         std::string text =
             R"(<kml xmlns="http://www.opengis.net/kml/2.2"><Document><Folder><name>a</name>)";
         const auto add = [&](const std::string& place, const std::string& more = "") {
           text += "<Placemark>" + more +
                   "<Point><altitudeMode>absolute</altitudeMode><coordinates>" + place +
                   "</coordinates></Point></Placemark>";
         };
         for (const char* corner : {"0,0,7", "9,0,7", "9,9,7", "0,9,7"}) add(corner);
         add("5,5,999", is_declared ? "<visibility>0</visibility>" : "");
         write_file(folder.file("source.kml"), text + "</Folder></Document></kml>");
         return {folder.file("source.kml")};
       }},
  };
}

}  // namespace ptin::tools::testing
