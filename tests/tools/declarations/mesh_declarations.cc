// SPDX-License-Identifier: GPL-3.0-or-later
//
// Declarations of TINs: PLY, OBJ, 2DM and LandXML.
#include "tests/tools/declarations/declaration.h"

namespace ptin::tools::testing {

namespace {

Declaration file(const std::string& key, const std::string& extension, const std::string& declared,
                 const std::string& undeclared) {
  return {key, [=](const TestFolder& folder, bool is_declared) -> std::vector<std::string> {
            const std::string path = folder.file("source" + extension);
            write_file(path, is_declared ? declared : undeclared);
            return {path};
          }};
}

std::string ply(const std::string& header, const std::string& elements = "") {
  return "ply\nformat ascii 1.0\n" + header +
         "element vertex 4\nproperty int x\nproperty int y\nproperty int z\nelement face 2\n"
         "property list uchar int vertex_index\n" +
         elements + "end_header\n0 0 1\n9 0 2\n9 9 3\n0 9 4\n3 0 1 2\n3 0 2 3\n";
}

const std::string kObj = "v 0 0 1\nv 9 0 2\nv 9 9 3\nv 0 9 4\nf 1 2 3\n";
const std::string kTwoDm = "ND 1 0 0 1\nND 2 9 0 2\nND 3 9 9 3\nE3T 1 1 2 3 1\n";
const std::string kPoints =
    "<P id='1'>0 0 1</P><P id='2'>0 9 2</P><P id='3'>9 9 3</P><P id='4'>9 0 4</P>";
const std::string kFaces = "<F>1 2 3</F><F>1 3 4</F>";

/// @param head  Before the surface.
std::string land_xml(const std::string& head, const std::string& definition = " surfType='TIN'",
                     const std::string& points = kPoints, const std::string& faces = kFaces,
                     const std::string& source = "", const std::string& state = "") {
  return "<LandXML version='1.2'>" + head + "<Surfaces><Surface name='s'" + state + ">" + source +
         "<Definition" + definition + "><Pnts>" + points + "</Pnts><Faces>" + faces +
         "</Faces></Definition></Surface></Surfaces></LandXML>";
}

Declaration xml(const std::string& key, const std::string& declared,
                const std::string& undeclared = land_xml("")) {
  return file(key, ".xml", declared, undeclared);
}

std::string units(const std::string& attributes) {
  return "<Units><Metric " + attributes + "/></Units>";
}

std::string system_of(const std::string& attributes) {
  return "<CoordinateSystem " + attributes + "/>";
}

/// Points, and beside them lines of LandXML by this option.
Declaration lines(const std::string& key, const std::string& option, const std::string& declared,
                  const std::string& undeclared) {
  return {key, [=](const TestFolder& folder, bool is_declared) -> std::vector<std::string> {
            write_file(folder.file("points.xyz"), "0 0 0\n9 0 0\n9 9 0\n0 9 0\n");
            write_file(folder.file("source.xml"),
                       "<LandXML><Surfaces><Surface name='s'><SourceData>" +
                           (is_declared ? declared : undeclared) +
                           "</SourceData></Surface></Surfaces></LandXML>");
            return {folder.file("points.xyz"), option, folder.file("source.xml")};
          }};
}

/// A strip of five quads, and a triangle at its western end, as OBJ.
std::string strip(const std::string& apex) {
  std::string text;
  for (int x = 0; x < 6; ++x) {
    for (int y = 0; y < 2; ++y) {
      text +=
          "v " + std::to_string(x) + " " + std::to_string(y) + " " + std::to_string(x + y) + "\n";
    }
  }
  text += "v " + apex + "\nf 1 2 13\n";
  for (int v = 1; v < 11; v += 2) {
    text += "f " + std::to_string(v) + " " + std::to_string(v + 2) + " " + std::to_string(v + 3) +
            " " + std::to_string(v + 1) + "\n";
  }
  return text;
}

/// A triangle of 2000 km a side, as OBJ.
std::string wide(const std::string& x) {
  return "v 0 0 1\nv 2000000 0 2\nv " + x + " 2000000 3\nf 1 2 3\n";
}

std::string breakline(const std::string& type) {
  return "<Breaklines><Breakline brkType='" + type +
         "'><PntList3D>2 2 1 5 5 2</PntList3D></Breakline></Breaklines>";
}

std::string boundary(const std::string& type) {
  return "<Boundaries><Boundary bndType='" + type +
         "'><PntList2D>1 1 1 8 8 8</PntList2D></Boundary></Boundaries>";
}

}  // namespace

std::vector<Declaration> mesh_declarations() {
  const std::string in_plane = land_xml(system_of("epsgCode='25832'"));
  return {
      file("mesh.ply_crs", ".ply", ply("comment crs: EPSG:25832\n"), ply("")),
      file("mesh.ply_vertical_crs", ".ply",
           ply("comment crs: EPSG:25832\ncomment vertical_crs: EPSG:5773\n"),
           ply("comment crs: EPSG:25832\n")),
      file("mesh.ply_units", ".ply", ply("comment units: ft\n"), ply("")),
      file("mesh.ply_height_units", ".ply", ply("comment height_units: ft\n"), ply("")),
      file("mesh.ply_shift", ".ply", ply("obj_info offset 500000 5200000 0\n"), ply("")),
      file("mesh.ply_strips", ".ply",
           ply("", "element tristrips 1\nproperty list int int vertex_indices\n"), ply("")),
      file("mesh.obj_crs", ".obj", "# crs: EPSG:25832\n" + kObj, kObj),
      file("mesh.obj_shift", ".obj", "# shift 500000 5200000 0\n" + kObj, kObj),
      file("mesh.obj_curves", ".obj", kObj + "surf 0 1 0 1 1 2 3\n", kObj),
      file("mesh.two_dm_element_values", ".2dm", "MESH2D\nNUM_MATERIALS_PER_ELEM 3\n" + kTwoDm,
           "MESH2D\n" + kTwoDm),
      file("mesh.encoding", ".obj", "\xFF\xFE" + kObj, kObj),
      file("mesh.no_height", ".obj", strip("-1 0.5 -9999"), strip("-1 0.5 3")),
      file("mesh.far_vertices", ".obj", strip("-500000 0.5 3"), strip("-1 0.5 3")),
      file("mesh.digits", ".obj", wide("1000000.1234"), wide("1000000.12")),
      file("mesh.turned_triangles", ".obj", kObj + "f 1 4 3\n", kObj + "f 1 3 4\n"),
      xml("mesh.landxml_epsg", in_plane),
      xml("mesh.landxml_wkt", land_xml(system_of("ogcWktCode='LOCAL_CS[&quot;site&quot;]'"))),
      xml("mesh.landxml_crs_in_words", land_xml(system_of("horizontalDatum='NAD83'"))),
      xml("mesh.landxml_vertical_code",
          land_xml(system_of("epsgCode='25832' verticalDatum='5773'")), in_plane),
      xml("mesh.landxml_vertical_in_words",
          land_xml(system_of("epsgCode='25832' verticalDatum='EGM96'")), in_plane),
      xml("mesh.landxml_rotation", land_xml(system_of("epsgCode='25832' rotationAngle='12.5'")),
          in_plane),
      xml("mesh.landxml_linear_unit", land_xml(units("linearUnit='foot'"))),
      xml("mesh.landxml_elevation_unit", land_xml(units("linearUnit='meter' elevationUnit='feet'")),
          land_xml(units("linearUnit='meter'"))),
      xml("mesh.landxml_hidden", land_xml("", "", kPoints, "<F>1 2 3</F><F i='1'>1 3 4</F>")),
      xml("mesh.landxml_state", land_xml("", "", kPoints, kFaces, "", " state='abandoned'")),
      xml("mesh.landxml_boundaries",
          land_xml(
              "", "", kPoints, kFaces,
              "<SourceData><Boundaries><Boundary bndType='outer'/></Boundaries></SourceData>")),
      lines("mesh.landxml_breakline", "--breaklines", breakline("wall"), breakline("standard")),
      lines("mesh.landxml_void", "--boundary", boundary("void"), boundary("outer")),
      xml("mesh.landxml_grid", land_xml("", " surfType='grid'")),
      xml("mesh.landxml_reference",
          land_xml("", "", "<P id='1' pntRef='CP1'/>" + kPoints.substr(kPoints.find("<P id='2'")))),
  };
}

}  // namespace ptin::tools::testing
