// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/formats/glb_mesh.h"

#include <nlohmann/json.hpp>

namespace ptin::tools {

namespace {

constexpr std::size_t kVectorBytes = 3 * sizeof(float);
constexpr int kArrayBuffer = 34962, kElementArrayBuffer = 34963, kTriangles = 4;

std::size_t index_bytes(const GlbMeshFacts& facts) noexcept {
  return facts.indices * (facts.index_type == GlbType::kUnsignedInt ? 4 : 2);
}

}  // namespace

std::size_t glb_bytes(const GlbMeshFacts& facts) noexcept {
  return 2 * facts.vertices * kVectorBytes + index_bytes(facts);
}

void describe_mesh(nlohmann::json& json, const GlbMeshFacts& facts) {
  const std::size_t bytes = facts.vertices * kVectorBytes;
  const int number = static_cast<int>(GlbType::kFloat);
  json["materials"] = {{{"pbrMetallicRoughness",
                         {{"baseColorFactor", {0.72, 0.7, 0.62, 1.0}},
                          {"metallicFactor", 0.0},
                          {"roughnessFactor", 1.0}}},
                        {"doubleSided", true}}};
  json["meshes"] = {{{"primitives",
                      {{{"attributes", {{"POSITION", 0}, {"NORMAL", 1}}},
                        {"indices", 2},
                        {"material", 0},
                        {"mode", kTriangles}}}}}};
  json["accessors"] = {
      {{"bufferView", 0},
       {"componentType", number},
       {"count", facts.vertices},
       {"type", "VEC3"},
       {"min", facts.low},
       {"max", facts.high}},
      {{"bufferView", 1}, {"componentType", number}, {"count", facts.vertices}, {"type", "VEC3"}},
      {{"bufferView", 2},
       {"componentType", static_cast<int>(facts.index_type)},
       {"count", facts.indices},
       {"type", "SCALAR"}}};
  json["bufferViews"] = {
      {{"buffer", 0}, {"byteOffset", 0}, {"byteLength", bytes}, {"target", kArrayBuffer}},
      {{"buffer", 0}, {"byteOffset", bytes}, {"byteLength", bytes}, {"target", kArrayBuffer}},
      {{"buffer", 0},
       {"byteOffset", 2 * bytes},
       {"byteLength", index_bytes(facts)},
       {"target", kElementArrayBuffer}}};
  json["buffers"] = {{{"byteLength", glb_bytes(facts)}}};
}

}  // namespace ptin::tools
