// SPDX-License-Identifier: GPL-3.0-or-later
//
// glTF 2.0 binary. Positions are float32, in which coordinates of millions of metres would jitter:
// so they stand around a local origin, the middle of the mesh. The origin is in `extras` of the
// node (x, y, z of the CRS, as doubles). It is not in the node's translation, because several
// programs add that in float32 again. glTF is y-up: (x, y, z) becomes (x, z, -y). glTF units are
// metres: degrees and feet become metres by their lengths at the origin. `extras.scale` has the
// factors: crs = origin + local / scale.
#include <cmath>

#include <nlohmann/json.hpp>

#include "engine/error.h"
#include "tools/formats/glb_mesh.h"
#include "tools/formats/mesh_writer.h"

namespace ptin::tools {

namespace {

using Vec3f = std::array<float, 3>;

/// A position in the local frame, turned so that y is up.
Vec3f turned_up(const LocalFrame& frame, const std::array<double, 3>& p) {
  const std::array<double, 3> local = frame.to_local(p);
  return {static_cast<float>(local[0]), static_cast<float>(local[2]),
          -static_cast<float>(local[1])};
}

LocalFrame frame_of(const Mesh& mesh) {
  if (mesh.vertices.empty()) return {};
  return {middle_of(mesh), mesh.metres_per_unit};
}

/// Area-weighted vertex normals, so that viewers shade smoothly.
std::vector<Vec3f> normals_of(const std::vector<Vec3f>& points, const Mesh& mesh) {
  std::vector<Vec3f> normals(points.size(), Vec3f{0, 0, 0});
  for (const auto& t : mesh.triangles) {
    const Vec3f& a = points[t[0]];
    const Vec3f& b = points[t[1]];
    const Vec3f& c = points[t[2]];
    const Vec3f u{b[0] - a[0], b[1] - a[1], b[2] - a[2]};
    const Vec3f v{c[0] - a[0], c[1] - a[1], c[2] - a[2]};
    const Vec3f n{u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]};
    for (const std::uint32_t corner : t) {
      for (std::size_t i = 0; i < 3; ++i) normals[corner][i] += n[i];
    }
  }
  for (Vec3f& n : normals) {
    const float length = std::sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
    n = length > 0 ? Vec3f{n[0] / length, n[1] / length, n[2] / length} : Vec3f{0, 1, 0};
  }
  return normals;
}

GlbMeshFacts facts_of(const std::vector<Vec3f>& points, const Mesh& mesh) {
  GlbMeshFacts facts{points.size(), mesh.triangles.size() * 3, GlbType::kUnsignedInt, points[0],
                     points[0]};
  for (const Vec3f& p : points) {
    for (std::size_t i = 0; i < 3; ++i) {
      facts.low[i] = std::min(facts.low[i], p[i]);
      facts.high[i] = std::max(facts.high[i], p[i]);
    }
  }
  return facts;
}

nlohmann::json scene_of(const Mesh& mesh, const LocalFrame& frame) {
  nlohmann::json extras = {
      {"origin", frame.origin}, {"scale", frame.scale}, {"axes", "x east, y up, z south"}};
  if (!mesh.crs.horizontal_text().empty()) extras["crs"] = mesh.crs.horizontal_text();
  if (!mesh.crs.vertical_text().empty()) extras["vertical_crs"] = mesh.crs.vertical_text();
  if (mesh.crs.vertical_unit != "unknown") extras["height_unit"] = mesh.crs.vertical_unit;
  nlohmann::json json;
  json["asset"] = {{"version", "2.0"}, {"generator", "ptin"}};
  json["scene"] = 0;
  json["scenes"] = {{{"nodes", {0}}}};
  json["nodes"] = {{{"name", "terrain"}, {"extras", extras}}};
  return json;
}

void write_chunk_header(ByteSink& out, std::uint64_t bytes, std::uint32_t type) {
  out.write_value(static_cast<std::uint32_t>(bytes));
  out.write_value(type);
}

}  // namespace

void write_glb(const Mesh& mesh, ByteSink& out) {
  const LocalFrame frame = frame_of(mesh);
  std::vector<Vec3f> points;
  points.reserve(mesh.vertices.size());
  for (const auto& vertex : mesh.vertices) points.push_back(turned_up(frame, vertex));
  const std::vector<Vec3f> normals = normals_of(points, mesh);

  nlohmann::json json = scene_of(mesh, frame);
  std::uint64_t binary = 0;
  if (!mesh.triangles.empty()) {
    const GlbMeshFacts facts = facts_of(points, mesh);
    json["nodes"][0]["mesh"] = 0;
    describe_mesh(json, facts);
    binary = glb_bytes(facts);
  }
  std::string text = json.dump();
  text.resize((text.size() + 3) / 4 * 4, ' ');
  const std::uint64_t total = 12 + 8 + text.size() + (binary > 0 ? 8 + binary : 0);
  if (total > UINT32_MAX) {
    refuse("GLB holds at most 4 GiB; write .ply, or ask for a window or an error");
  }
  out.write("glTF");
  out.write_value(std::uint32_t{2});
  out.write_value(static_cast<std::uint32_t>(total));
  write_chunk_header(out, text.size(), 0x4E4F534A);
  out.write(text);
  if (binary == 0) return;
  write_chunk_header(out, binary, 0x004E4942);
  out.write(points.data(), points.size() * sizeof(Vec3f));
  out.write(normals.data(), normals.size() * sizeof(Vec3f));
  out.write(mesh.triangles.data(), mesh.triangles.size() * sizeof(mesh.triangles[0]));
}

}  // namespace ptin::tools
