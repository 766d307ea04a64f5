// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/region/mesh_crs.h"

#include <cmath>

#include <nlohmann/json.hpp>

#include "engine/crs/ground.h"
#include "tools/formats/mesh_writer.h"
#include "tools/formats/number_text.h"

namespace ptin::tools {

namespace {

/// Metres in a unit of x, of y and of heights.
std::array<double, 3> metres_per_unit_at(MapPoint place, const CrsFacts& crs) {
  const Ground ground = ground_of(crs);
  const MapPoint heights = ground.per_map_unit(place);
  return {heights.x * ground.metres_per_height, heights.y * ground.metres_per_height,
          ground.metres_per_height};
}

}  // namespace

void set_crs(Mesh& mesh, const CrsFacts& crs, const StoreFacts& facts) {
  mesh.crs = crs;
  mesh.frame = frame_of(facts, crs);
  if (mesh.vertices.empty()) return;
  const std::array<double, 3> middle = middle_of(mesh);
  mesh.metres_per_unit = metres_per_unit_at({middle[0], middle[1]}, crs);
}

LocalFrame frame_of(const StoreFacts& facts, const CrsFacts& crs) {
  const GridBox& b = facts.bounds;
  const MapPoint low = facts.map.to_map(b.min_x, b.min_y);
  const MapPoint high = facts.map.to_map(b.max_x, b.max_y);
  const MapPoint middle{low.x + (high.x - low.x) / 2, low.y + (high.y - low.y) / 2};
  // Whole map units, or some ten metres in degrees.
  const double unit = crs.geographic ? 1e4 : 1.0;
  const MapPoint origin{std::round(middle.x * unit) / unit, std::round(middle.y * unit) / unit};
  return {{origin.x, origin.y, 0.0}, metres_per_unit_at(origin, crs)};
}

bool has_frame(const std::string& path) { return mesh_format_of(path).make == make_stl; }

nlohmann::json frame_json(const LocalFrame& frame) {
  return {{"origin", frame.origin}, {"scale", frame.scale}};
}

std::string frame_text(const LocalFrame& frame) {
  const auto axis = [&](const char* local, const char* map, std::size_t i) {
    std::string text = std::string(local) + " = ";
    if (frame.origin[i] == 0) {
      text += map;
    } else {
      text.append("(").append(map).append(frame.origin[i] < 0 ? " + " : " - ");
      append_number(text, std::abs(frame.origin[i]));
      text += ')';
    }
    if (frame.scale[i] == 1) return text;
    append_number(text += " * ", frame.scale[i]);
    return text;
  };
  return axis("x", "easting", 0) + ", " + axis("y", "northing", 1) + ", " + axis("z", "height", 2);
}

}  // namespace ptin::tools
