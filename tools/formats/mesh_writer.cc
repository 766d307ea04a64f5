// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/formats/mesh_writer.h"

#include <array>

#include "engine/error.h"
#include "tools/output/file_name.h"
#include "tools/output/output_file.h"

namespace ptin::tools {

namespace {

constexpr std::array<MeshFormat, 7> kMeshFormats = {{
    {"ply", "PLY, binary, double coordinates (QGIS, Blender, MeshLab)", write_ply, nullptr},
    {"obj", "Wavefront OBJ, text", nullptr, make_obj},
    {"2dm", "SMS 2DM, text (QGIS, hydraulic models)", nullptr, make_two_dm},
    {"glb", "glTF 2.0 binary, around a local origin (viewers, Blender, web)", write_glb, nullptr},
    {"xml", "LandXML 1.2, a TIN surface (CAD, machine control)", nullptr, make_land_xml},
    {"dxf", "DXF, a 3DFACE a triangle (CAD)", nullptr, make_dxf},
    {"stl", "STL, binary, around a local origin (3D printing)", nullptr, make_stl},
}};

}  // namespace

std::span<const MeshFormat> mesh_formats() noexcept { return kMeshFormats; }

const MeshFormat& mesh_format_of(const std::string& path) {
  std::string extension = lower_extension(path);
  if (!extension.empty()) extension.erase(0, 1);
  std::string known;
  for (const MeshFormat& format : kMeshFormats) {
    if (format.extension == extension) return format;
    known.append(known.empty() ? "." : ", .").append(format.extension);
  }
  std::string what = "the name has no extension";
  if (!extension.empty()) what = std::string("unknown extension .").append(extension);
  refuse(what.append("; known are ").append(known), path);
}

void write_in_pieces(const Mesh& mesh, MeshStream& stream) {
  for (const auto& vertex : mesh.vertices) stream.add_vertex(vertex);
  for (const auto& t : mesh.triangles) {
    stream.add_triangle(
        {{{t[0], mesh.vertices[t[0]]}, {t[1], mesh.vertices[t[1]]}, {t[2], mesh.vertices[t[2]]}}});
  }
  stream.publish();
}

void write_mesh(const Mesh& mesh, const std::string& path, bool overwrite) {
  const MeshFormat& format = mesh_format_of(path);
  if (format.make != nullptr) {
    write_in_pieces(mesh, *format.make({path, overwrite, mesh.crs, mesh.frame}));
    return;
  }
  OutputFile out(path, overwrite);
  format.write(mesh, out);
  out.publish();
}

}  // namespace ptin::tools
