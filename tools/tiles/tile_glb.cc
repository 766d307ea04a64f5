// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/tiles/tile_glb.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include <nlohmann/json.hpp>

#include "engine/check.h"
#include "tools/formats/glb_mesh.h"
#include "tools/tiles/tile_bytes.h"

namespace ptin::tools {

namespace {

using GlbVector = std::array<float, 3>;

/// Earth-centred, or around the origin, with y up.
Vec3 turned_up(const Vec3& p) { return {p.x, p.z, -p.y}; }

struct LocalPositions {
  Vec3 origin;                      ///< Earth-centred.
  std::vector<GlbVector> vertices;  ///< Around it, y up.
  GlbVector low{}, high{};
};

LocalPositions local_positions_of(const TileMesh& mesh, const TileGlbTarget& target) {
  const TileBox box = TileGrid::box_of(target.tile);
  const double step = target.position_step;
  const auto rounded = [step](const Vec3& p) {
    return Vec3{std::round(p.x / step) * step, std::round(p.y / step) * step,
                std::round(p.z / step) * step};
  };
  std::vector<Vec3> at;
  at.reserve(mesh.vertices.size());
  for (const TileMesh::Vertex& v : mesh.vertices) {
    at.push_back(rounded(ecef_of(target.grid.globe_point(
        target.tile.level, {box.min_u + v.at.u, box.min_v + v.at.v}, v.height))));
  }
  Vec3 low = at.front(), high = at.front();
  for (const Vec3& p : at) {
    low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
    high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
  }
  PTIN_CHECK(std::max({high.x - low.x, high.y - low.y, high.z - low.z}) < step * 0x1p24);
  LocalPositions local;
  local.origin = rounded(0.5 * (low + high));
  for (std::size_t i = 0; i < at.size(); ++i) {
    const Vec3 p = turned_up(at[i] - local.origin);
    const GlbVector f{static_cast<float>(p.x), static_cast<float>(p.y), static_cast<float>(p.z)};
    if (i == 0) local.low = local.high = f;
    for (std::size_t k = 0; k < 3; ++k) {
      local.low[k] = std::min(local.low[k], f[k]);
      local.high[k] = std::max(local.high[k], f[k]);
    }
    local.vertices.push_back(f);
  }
  return local;
}

nlohmann::json scene_of(const LocalPositions& local, const GlbMeshFacts& facts) {
  const Vec3 origin = turned_up(local.origin);
  nlohmann::json json;
  json["asset"] = {{"version", "2.0"}, {"generator", "ptin"}};
  json["scene"] = 0;
  json["scenes"] = {{{"nodes", {0}}}};
  json["nodes"] = {{{"mesh", 0}, {"translation", {origin.x, origin.y, origin.z}}}};
  describe_mesh(json, facts);
  return json;
}

std::string buffer_of(const TileMesh& mesh, const LocalPositions& local, GlbType index_type) {
  TileBytes out;
  for (const GlbVector& p : local.vertices) out.add(p);
  for (const TileMesh::Vertex& v : mesh.vertices) {
    const Vec3 n = turned_up(v.normal);
    out.add(GlbVector{static_cast<float>(n.x), static_cast<float>(n.y), static_cast<float>(n.z)});
  }
  for (const auto& triangle : mesh.triangles) {
    for (const std::uint32_t v : triangle) {
      if (index_type == GlbType::kUnsignedInt) {
        out.add(v);
      } else {
        out.add(static_cast<std::uint16_t>(v));
      }
    }
  }
  out.align(4);
  return out.take();
}

std::string glb_of(const nlohmann::json& json, const std::string& buffer) {
  std::string text = json.dump();
  text.resize((text.size() + 3) / 4 * 4, ' ');
  const std::size_t total = 12 + 8 + text.size() + (buffer.empty() ? 0 : 8 + buffer.size());
  TileBytes out;
  out.add_text("glTF");
  out.add(std::uint32_t{2});
  out.add(static_cast<std::uint32_t>(total));
  out.add(static_cast<std::uint32_t>(text.size()));
  out.add_text("JSON");
  out.add_text(text);
  if (!buffer.empty()) {
    out.add(static_cast<std::uint32_t>(buffer.size()));
    out.add_text(std::string_view("BIN\0", 4));
    out.add_text(buffer);
  }
  return out.take();
}

}  // namespace

std::string tile_glb(const TileMesh& mesh, const TileGlbTarget& target) {
  if (mesh.triangles.empty()) {
    return glb_of({{"asset", {{"version", "2.0"}, {"generator", "ptin"}}},
                   {"scene", 0},
                   {"scenes", nlohmann::json::array({nlohmann::json::object()})}},
                  {});
  }
  const LocalPositions local = local_positions_of(mesh, target);
  // 65535 is no index: it ends a strip.
  const GlbMeshFacts facts{
      local.vertices.size(), mesh.triangles.size() * 3,
      mesh.vertices.size() > 65535 ? GlbType::kUnsignedInt : GlbType::kUnsignedShort, local.low,
      local.high};
  return glb_of(scene_of(local, facts), buffer_of(mesh, local, facts.index_type));
}

}  // namespace ptin::tools
