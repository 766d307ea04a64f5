// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/viewer/first_mesh.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <string_view>
#include <utility>

#include <nlohmann/json.hpp>

#include "engine/query/questions.h"

namespace ptin::tools {

namespace {

/// With so many vertices a picture tells the terrain, in some ten kilobytes.
constexpr std::size_t kEnoughVertices = 900;
/// A frame that brings more than so many is not worth waiting for.
constexpr std::size_t kMostVertices = 6000;
constexpr std::uint64_t kReaderMemory = std::uint64_t{64} << 20;

/// Whole numbers in as few bytes as they need, seven bits a byte, the lowest first.
class Packed {
 public:
  void add(std::uint64_t number) {
    for (; number >= 128; number >>= 7) bytes_ += static_cast<char>(number | 128);
    bytes_ += static_cast<char>(number);
  }
  /// A difference from what was added before, of either sign, with a flag.
  void add_step(std::int64_t step, bool flag) { add(2 * folded(step) + (flag ? 1 : 0)); }
  void add_step(std::int64_t step) { add(folded(step)); }
  [[nodiscard]] std::string base64() const;

 private:
  static std::uint64_t folded(std::int64_t step) {
    return step < 0 ? 2 * static_cast<std::uint64_t>(-(step + 1)) + 1
                    : 2 * static_cast<std::uint64_t>(step);
  }
  std::string bytes_;
};

std::string Packed::base64() const {
  constexpr std::string_view kDigits =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  for (std::size_t at = 0; at < bytes_.size(); at += 3) {
    std::uint32_t three = 0;
    const std::size_t there = std::min<std::size_t>(3, bytes_.size() - at);
    for (std::size_t i = 0; i < 3; ++i) {
      three = three << 8 | (i < there ? static_cast<unsigned char>(bytes_[at + i]) : 0U);
    }
    for (std::size_t i = 0; i < 4; ++i) {
      text += i <= there ? kDigits[three >> (18 - 6 * i) & 63U] : '=';
    }
  }
  return text;
}

/// Heights as whole numbers: those of the stream, or floats in steps that are a power of two, so that
/// a height of 0 stays 0.
struct WholeHeights {
  bool is_float;
  double step, offset;

  [[nodiscard]] std::int64_t of(HeightBits bits, const HeightEncoding& encoding) const {
    const double code = encoding.code(bits);
    return std::llround(is_float ? (encoding.offset + encoding.step * code) / step : code);
  }
};

WholeHeights whole_heights(const StoreFacts& facts) {
  const HeightEncoding& encoding = facts.heights;
  if (encoding.type != HeightType::float32) return {false, encoding.step, encoding.offset};
  const double relief = std::max(facts.max_height - facts.min_height, 1e-6);
  return {true, std::exp2(std::ceil(std::log2(relief / 65535.0))), 0.0};
}

void add_vertices(Packed& packed, const StreamReader& reader, const WholeHeights& heights) {
  const Tin& tin = reader.tin();
  std::array<std::int64_t, 3> before{};
  for (std::size_t v = 0; v < tin.vertices.size(); ++v) {
    const Vertex& vertex = tin.vertices[v];
    const bool has_height = tin.has_height[v] != 0;
    const std::array<std::int64_t, 3> now = {
        vertex.position.x, vertex.position.y,
        has_height ? heights.of(vertex.height, reader.facts().heights) : before[2]};
    packed.add_step(now[0] - before[0], has_height);
    packed.add_step(now[1] - before[1]);
    packed.add_step(now[2] - before[2]);
    before = now;
  }
}

void add_triangles(Packed& packed, const Tin& tin) {
  std::int64_t before = 0;
  for (std::size_t t = 0; t < tin.triangles.size(); ++t) {
    const Triangle& triangle = tin.triangles[t];
    const std::int64_t first = triangle.v[0];
    packed.add_step(first - before, tin.classes[t] == TriangleClass::kVoid);
    packed.add_step(triangle.v[1] - first);
    packed.add_step(triangle.v[2] - first);
    before = first;
  }
}

/// In the order of ptin-decoder's facts.
nlohmann::json facts_of(const StoreFacts& f, const WholeHeights& heights) {
  return {f.map.origin_x, f.map.origin_y, f.map.step_x,   f.map.step_y,   0,
          heights.step,   heights.offset, f.bounds.min_x, f.bounds.min_y, f.bounds.max_x,
          f.bounds.max_y, f.min_height,   f.max_height,   f.base_error,   f.base_deviation};
}

std::string element_of(const StreamReader& reader) {
  const WholeHeights heights = whole_heights(reader.facts());
  Packed packed;
  add_vertices(packed, reader, heights);
  add_triangles(packed, reader.tin());
  const double rounding = heights.is_float ? heights.step / 2 : 0.0;
  const nlohmann::json all = {{"facts", facts_of(reader.facts(), heights)},
                              {"metadata", reader.metadata()},
                              {"error", reader.certificate().error + rounding},
                              {"deviation", reader.certificate().deviation + rounding},
                              {"vertices", reader.tin().vertices.size()},
                              {"triangles", reader.tin().triangles.size()},
                              {"mesh", packed.base64()}};
  std::string element = R"(<script type="application/json" id="first-mesh">)";
  // In a string of JSON, where alone it may stand, `<` can be written so that HTML does not read it.
  for (const char c : all.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace)) {
    if (c == '<')
      element += "\\u003c";
    else
      element += c;
  }
  return element + "</script>";
}

}  // namespace

std::string first_mesh_element(std::span<const std::byte> beginning) {
  StreamReader reader("the stream", {{kReaderMemory, {}}});
  while (!beginning.empty() && !reader.is_complete() &&
         reader.tin().vertices.size() < kEnoughVertices) {
    beginning = beginning.subspan(reader.feed_frame(beginning));
  }
  const std::size_t vertices = reader.tin().vertices.size();
  if (!reader.has_mesh() || vertices > kMostVertices) return {};
  if (!std::isfinite(reader.certificate().error)) return {};
  return element_of(reader);
}

}  // namespace ptin::tools
