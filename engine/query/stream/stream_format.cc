// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/query/stream/stream_format.h"

#include <algorithm>
#include <cstring>
#include <numeric>
#include <vector>

#include "storage/file/checksum.h"

namespace ptin::stream {

std::uint64_t checksum_of_frame(const FrameHead& head, std::span<const std::byte> payload) {
  struct {
    std::array<std::byte, offsetof(FrameHead, checksum)> head;
    std::uint64_t payload;
  } both;
  std::memcpy(both.head.data(), &head, both.head.size());
  both.payload = checksum_of(payload);
  return checksum_of_object(both);
}

std::uint64_t digest_of(GridPoint position, HeightBits height, bool has_height) noexcept {
  const layout::T0Vertex v{position.x, position.y, has_height ? height : 0, has_height ? 1U : 0U};
  return checksum_of_object(v);
}

std::uint64_t digest_of(const Tin& tin) noexcept {
  std::uint64_t sum = 0;
  for (VertexId v = 0; v < tin.vertices.size(); ++v) {
    sum += digest_of(tin.position(v), tin.vertices[v].height, tin.has_height[v] != 0);
  }
  return sum;
}

Tin numbered_by_key(const Tin& tin) {
  std::vector<VertexId> order(tin.vertices.size());
  std::iota(order.begin(), order.end(), VertexId{0});
  std::sort(order.begin(), order.end(), [&](VertexId a, VertexId b) {
    return key_of(tin.position(a)) < key_of(tin.position(b));
  });
  Tin result;
  result.classes = tin.classes;
  result.triangles = tin.triangles;
  result.vertices.reserve(order.size());
  result.has_height.reserve(order.size());
  std::vector<VertexId> number(order.size());
  for (const VertexId v : order) {
    number[v] = static_cast<VertexId>(result.vertices.size());
    result.vertices.push_back(tin.vertices[v]);
    result.has_height.push_back(tin.has_height[v]);
  }
  for (Triangle& t : result.triangles) {
    for (VertexId& v : t.v) {
      v = number[v];
    }
  }
  return result;
}

}  // namespace ptin::stream
