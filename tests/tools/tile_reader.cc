// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/tools/tile_reader.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <stdexcept>

namespace ptin::tools::testing {

namespace {

void demand(bool holds, const char* what) {
  if (!holds) throw std::runtime_error(std::string("the tile is not valid: ") + what);
}

class TileInput {
 public:
  explicit TileInput(const std::string& bytes) : bytes_(bytes) {}
  template <class Value>
  Value next() {
    demand(at_ + sizeof(Value) <= bytes_.size(), "it ends too early");
    Value value;
    std::memcpy(&value, bytes_.data() + at_, sizeof(Value));
    at_ += sizeof(Value);
    return value;
  }
  std::string text(std::size_t count) {
    demand(at_ + count <= bytes_.size(), "it ends too early");
    at_ += count;
    return bytes_.substr(at_ - count, count);
  }
  void align(std::size_t step) {
    while (at_ % step != 0) demand(next<char>() == 0, "padding");
  }
  [[nodiscard]] bool at_end() const { return at_ == bytes_.size(); }

 private:
  const std::string& bytes_;
  std::size_t at_ = 0;
};

std::vector<std::uint16_t> zigzag(TileInput& in, std::size_t count) {
  std::vector<std::uint16_t> values;
  int value = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const int code = in.next<std::uint16_t>();
    value += (code & 1) != 0 ? -((code + 1) / 2) : code / 2;
    demand(value >= 0 && value <= 32767, "a coordinate is out of range");
    values.push_back(static_cast<std::uint16_t>(value));
  }
  return values;
}

std::uint32_t next_index(TileInput& in, std::size_t bytes) {
  return bytes == 4 ? in.next<std::uint32_t>() : in.next<std::uint16_t>();
}

std::vector<std::uint32_t> side(TileInput& in, std::size_t bytes, std::size_t vertices) {
  std::vector<std::uint32_t> indices(in.next<std::uint32_t>());
  for (std::uint32_t& i : indices) {
    i = next_index(in, bytes);
    demand(i < vertices, "a side names a vertex that is not there");
  }
  return indices;
}

void demand_three_corners(const std::array<std::uint32_t, 3>& t) {
  demand(t[0] != t[1] && t[1] != t[2] && t[2] != t[0], "a triangle has a corner twice");
}

void read_triangles(TileInput& in, std::size_t vertices, ReadTerrain& tile) {
  const auto count = in.next<std::uint32_t>();
  std::uint32_t highest = 0;
  for (std::uint32_t t = 0; t < count; ++t) {
    std::array<std::uint32_t, 3> triangle{};
    for (std::uint32_t& corner : triangle) {
      const std::uint32_t code = next_index(in, tile.index_bytes);
      demand(code <= highest, "an index is above the high water mark");
      corner = highest - code;
      if (code == 0) ++highest;
      demand(corner < vertices, "a triangle names a vertex that is not there");
    }
    demand_three_corners(triangle);
    tile.triangles.push_back(triangle);
  }
  demand(highest == vertices, "a vertex is not used");
}

}  // namespace

ReadTerrain read_terrain_tile(const std::string& bytes) {
  TileInput in(bytes);
  ReadTerrain tile;
  tile.centre = in.next<Ecef>();
  tile.least = in.next<float>();
  tile.most = in.next<float>();
  tile.sphere_centre = in.next<Ecef>();
  tile.radius = in.next<double>();
  tile.horizon = in.next<Ecef>();
  const std::size_t count = in.next<std::uint32_t>();
  tile.u = zigzag(in, count);
  tile.v = zigzag(in, count);
  tile.h = zigzag(in, count);
  tile.index_bytes = count > 65536 ? 4 : 2;
  in.align(tile.index_bytes);
  read_triangles(in, count, tile);
  tile.west = side(in, tile.index_bytes, count);
  tile.south = side(in, tile.index_bytes, count);
  tile.east = side(in, tile.index_bytes, count);
  tile.north = side(in, tile.index_bytes, count);
  while (!in.at_end()) {
    const auto extension = in.next<std::uint8_t>();
    const auto length = in.next<std::uint32_t>();
    demand(extension == 1 && length == 2 * count, "an extension that was not expected");
    for (std::size_t i = 0; i < count; ++i)
      tile.normals.push_back(in.next<std::array<std::uint8_t, 2>>());
  }
  return tile;
}

ReadGlb read_tile_glb(const std::string& bytes) {
  TileInput in(bytes);
  demand(in.text(4) == "glTF" && in.next<std::uint32_t>() == 2, "no glTF 2");
  demand(in.next<std::uint32_t>() == bytes.size() && bytes.size() % 4 == 0, "length");
  const auto text_bytes = in.next<std::uint32_t>();
  demand(in.text(4) == "JSON", "JSON");
  ReadGlb glb;
  glb.json = nlohmann::json::parse(in.text(text_bytes));
  if (in.at_end()) return glb;
  const auto buffer_bytes = in.next<std::uint32_t>();
  demand(in.text(4) == std::string("BIN\0", 4), "BIN");
  const std::string buffer = in.text(buffer_bytes);
  demand(in.at_end(), "more chunks");
  const auto& json = glb.json;
  const auto& node = json.at("nodes").at(0);
  const auto translation = node.at("translation").get<Ecef>();
  const auto& primitive = json.at("meshes").at(0).at("primitives").at(0);
  const auto part = [&](std::size_t accessor) {
    const auto& a = json.at("accessors").at(accessor);
    const auto& view = json.at("bufferViews").at(a.at("bufferView").get<std::size_t>());
    return std::pair(a, buffer.substr(view.at("byteOffset"), view.at("byteLength")));
  };
  const auto [position, position_bytes] = part(primitive.at("attributes").at("POSITION"));
  const auto [normal, normal_bytes] = part(primitive.at("attributes").at("NORMAL"));
  const auto [index, index_bytes] = part(primitive.at("indices"));
  TileInput positions(position_bytes), normals(normal_bytes), indices(index_bytes);
  for (std::size_t i = 0; i < position.at("count"); ++i) {
    const auto p = positions.next<std::array<float, 3>>();
    for (std::size_t k = 0; k < 3; ++k) {
      demand(p[k] >= position.at("min").at(k).get<float>() &&
                 p[k] <= position.at("max").at(k).get<float>(),
             "a position is beyond its accessor's bounds");
    }
    glb.positions.push_back(
        {translation[0] + p[0], -(translation[2] + p[2]), translation[1] + p[1]});
    const auto n = normals.next<std::array<float, 3>>();
    glb.normals.push_back({n[0], -n[2], n[1]});
  }
  for (std::size_t i = 0; i < index.at("count"); i += 3) {
    std::array<std::uint32_t, 3> triangle{};
    for (std::uint32_t& corner : triangle) {
      corner = index.at("componentType") == 5125 ? indices.next<std::uint32_t>()
                                                 : indices.next<std::uint16_t>();
      demand(corner < glb.positions.size(), "a triangle names a vertex that is not there");
    }
    demand_three_corners(triangle);
    glb.triangles.push_back(triangle);
  }
  return glb;
}

ReadSubtree read_subtree(const std::string& bytes, int levels) {
  TileInput in(bytes);
  demand(in.text(4) == "subt" && in.next<std::uint32_t>() == 1, "no subtree");
  const auto text_bytes = in.next<std::uint64_t>();
  const auto buffer_bytes = in.next<std::uint64_t>();
  demand(text_bytes % 8 == 0 && buffer_bytes % 8 == 0, "padding");
  const auto json = nlohmann::json::parse(in.text(text_bytes));
  const std::string buffer = in.text(buffer_bytes);
  demand(in.at_end(), "more bytes");
  const auto bits_of = [&](const nlohmann::json& told, std::size_t count) {
    if (told.contains("constant")) return std::vector<bool>(count, told.at("constant") == 1);
    const auto& view = json.at("bufferViews").at(told.at("bitstream").get<std::size_t>());
    const std::string part = buffer.substr(view.at("byteOffset"), view.at("byteLength"));
    demand(view.at("byteOffset").get<std::size_t>() % 8 == 0, "alignment");
    demand(part.size() == (count + 7) / 8, "length of the bits");
    std::vector<bool> bits;
    for (std::size_t i = 0; i < count; ++i)
      bits.push_back((static_cast<unsigned char>(part[i / 8]) >> (i % 8) & 1) != 0);
    demand(std::count(bits.begin(), bits.end(), true) == told.at("availableCount"), "count");
    return bits;
  };
  const std::size_t below = std::size_t{1} << (2 * levels);
  const std::size_t within = (below - 1) / 3;
  return {bits_of(json.at("tileAvailability"), within),
          bits_of(json.at("contentAvailability").at(0), within),
          bits_of(json.at("childSubtreeAvailability"), below)};
}

Ecef oct_decoded(const std::array<std::uint8_t, 2>& code) {
  double x = code[0] / 255.0 * 2.0 - 1.0;
  double y = code[1] / 255.0 * 2.0 - 1.0;
  const double z = 1.0 - std::abs(x) - std::abs(y);
  if (z < 0) {
    const double folded = (1.0 - std::abs(y)) * (x >= 0 ? 1.0 : -1.0);
    y = (1.0 - std::abs(x)) * (y >= 0 ? 1.0 : -1.0);
    x = folded;
  }
  const double length = std::sqrt(x * x + y * y + z * z);
  return {x / length, y / length, z / length};
}

}  // namespace ptin::tools::testing
