// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/tools/mesh_reader.h"

#include <cstring>
#include <map>
#include <sstream>
#include <stdexcept>

namespace ptin::tools::testing {

namespace {

void require(bool fact, const char* what) {
  if (!fact) throw std::runtime_error(what);
}

template <typename T>
T value_at(const std::string& bytes, std::size_t at) {
  require(at + sizeof(T) <= bytes.size(), "cut short");
  T value;
  std::memcpy(&value, bytes.data() + at, sizeof value);
  return value;
}

std::vector<std::string> words_of(const std::string& line) {
  std::istringstream in(line);
  std::vector<std::string> words;
  for (std::string word; in >> word;) words.push_back(word);
  return words;
}

}  // namespace

ReadMesh read_ply(const std::string& content) {
  ReadMesh mesh;
  std::size_t at = 0;
  std::size_t vertices = 0;
  std::size_t faces = 0;
  do {
    const std::size_t end = content.find('\n', at);
    require(end != std::string::npos, "no end_header");
    mesh.header.push_back(content.substr(at, end - at));
    at = end + 1;
    const auto words = words_of(mesh.header.back());
    require(!words.empty(), "an empty header line");
    if (words[0] == "element") (words[1] == "vertex" ? vertices : faces) = std::stoul(words[2]);
  } while (mesh.header.back() != "end_header");
  require(mesh.header[0] == "ply" && mesh.header[1] == "format binary_little_endian 1.0",
          "not binary PLY");
  for (std::size_t i = 0; i < vertices; ++i, at += 24) {
    mesh.vertices.push_back({value_at<double>(content, at), value_at<double>(content, at + 8),
                             value_at<double>(content, at + 16)});
  }
  for (std::size_t i = 0; i < faces; ++i, at += 13) {
    require(value_at<std::uint8_t>(content, at) == 3, "a face that is no triangle");
    mesh.triangles.push_back({value_at<std::uint32_t>(content, at + 1),
                              value_at<std::uint32_t>(content, at + 5),
                              value_at<std::uint32_t>(content, at + 9)});
  }
  require(at == content.size(), "bytes behind the last face");
  return mesh;
}

ReadMesh read_obj(const std::string& content) {
  ReadMesh mesh;
  std::istringstream in(content);
  for (std::string line; std::getline(in, line);) {
    const auto words = words_of(line);
    require(!words.empty(), "an empty line");
    if (words[0][0] == '#') {
      mesh.header.push_back(line);
    } else if (words[0] == "v") {
      require(words.size() == 4, "a vertex has three coordinates");
      mesh.vertices.push_back({std::stod(words[1]), std::stod(words[2]), std::stod(words[3])});
    } else {
      require(words[0] == "f" && words.size() == 4, "neither v nor f");
      std::array<std::uint32_t, 3> triangle{};
      for (std::size_t i = 0; i < 3; ++i)
        triangle[i] = static_cast<std::uint32_t>(std::stoul(words[i + 1]) - 1);
      mesh.triangles.push_back(triangle);
    }
  }
  return mesh;
}

ReadMesh read_2dm(const std::string& content) {
  ReadMesh mesh;
  std::istringstream in(content);
  std::string line;
  std::getline(in, line);
  require(line == "MESH2D", "not 2DM");
  std::map<std::size_t, std::size_t> node_of_id;
  std::vector<std::array<std::size_t, 3>> elements;
  while (std::getline(in, line)) {
    const auto words = words_of(line);
    if (words.at(0) == "ND") {
      require(words.size() == 5, "ND id x y z");
      node_of_id[std::stoul(words[1])] = mesh.vertices.size();
      mesh.vertices.push_back({std::stod(words[2]), std::stod(words[3]), std::stod(words[4])});
    } else {
      require(words[0] == "E3T" && words.size() == 6, "E3T id a b c material");
      require(std::stoul(words[1]) == elements.size() + 1, "element ids count from 1");
      elements.push_back({std::stoul(words[2]), std::stoul(words[3]), std::stoul(words[4])});
    }
  }
  for (const auto& e : elements) {
    mesh.triangles.push_back({static_cast<std::uint32_t>(node_of_id.at(e[0])),
                              static_cast<std::uint32_t>(node_of_id.at(e[1])),
                              static_cast<std::uint32_t>(node_of_id.at(e[2]))});
  }
  return mesh;
}

ReadMesh read_glb(const std::string& content) {
  ReadMesh mesh;
  require(content.substr(0, 4) == "glTF" && value_at<std::uint32_t>(content, 4) == 2, "not GLB 2");
  require(value_at<std::uint32_t>(content, 8) == content.size(),
          "the length in the header is wrong");
  const auto json_bytes = value_at<std::uint32_t>(content, 12);
  require(value_at<std::uint32_t>(content, 16) == 0x4E4F534A && json_bytes % 4 == 0,
          "the first chunk is JSON, padded to 4");
  mesh.json = nlohmann::json::parse(content.substr(20, json_bytes));
  require(mesh.json.at("asset").at("version") == "2.0", "version 2.0");
  require(mesh.json.at("scenes").at(0).at("nodes").at(0) == 0, "a scene of one node");
  if (!mesh.json.contains("meshes")) {
    require(content.size() == 20 + json_bytes, "bytes without a mesh");
    return mesh;
  }
  const std::size_t chunk = 20 + json_bytes;
  const auto binary_bytes = value_at<std::uint32_t>(content, chunk);
  require(value_at<std::uint32_t>(content, chunk + 4) == 0x004E4942 && binary_bytes % 4 == 0,
          "the second chunk is BIN");
  require(chunk + 8 + binary_bytes == content.size(), "bytes behind the last chunk");
  require(mesh.json.at("buffers").at(0).at("byteLength") == binary_bytes, "the buffer's length");
  const auto& primitive = mesh.json.at("meshes").at(0).at("primitives").at(0);
  const auto view = [&](const nlohmann::json& accessor, std::size_t item_bytes) {
    const auto& v = mesh.json.at("bufferViews").at(accessor.at("bufferView").get<std::size_t>());
    const auto offset = v.at("byteOffset").get<std::size_t>();
    require(v.at("byteLength") == accessor.at("count").get<std::size_t>() * item_bytes,
            "the view's length");
    require(offset + v.at("byteLength").get<std::size_t>() <= binary_bytes && offset % 4 == 0,
            "the view's place");
    return chunk + 8 + offset;
  };
  const auto& positions =
      mesh.json.at("accessors").at(primitive.at("attributes").at("POSITION").get<std::size_t>());
  require(positions.at("componentType") == 5126 && positions.at("type") == "VEC3",
          "float positions");
  std::array<float, 3> low{1e30F, 1e30F, 1e30F};
  std::array<float, 3> high{-1e30F, -1e30F, -1e30F};
  const std::size_t at = view(positions, 12);
  for (std::size_t i = 0; i < positions.at("count"); ++i) {
    std::array<double, 3> p{};
    for (std::size_t k = 0; k < 3; ++k) {
      const auto c = value_at<float>(content, at + 12 * i + 4 * k);
      low[k] = std::min(low[k], c);
      high[k] = std::max(high[k], c);
      p[k] = c;
    }
    mesh.vertices.push_back(p);
  }
  for (std::size_t k = 0; k < 3; ++k) {
    require(positions.at("min").at(k).get<float>() == low[k] &&
                positions.at("max").at(k).get<float>() == high[k],
            "min and max are those of the positions");
  }
  const auto& indices = mesh.json.at("accessors").at(primitive.at("indices").get<std::size_t>());
  require(indices.at("componentType") == 5125 && indices.at("type") == "SCALAR", "32-bit indices");
  const std::size_t first = view(indices, 4);
  for (std::size_t i = 0; i + 2 < indices.at("count"); i += 3) {
    mesh.triangles.push_back({value_at<std::uint32_t>(content, first + 4 * i),
                              value_at<std::uint32_t>(content, first + 4 * i + 4),
                              value_at<std::uint32_t>(content, first + 4 * i + 8)});
  }
  return mesh;
}

}  // namespace ptin::tools::testing
