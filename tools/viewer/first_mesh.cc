// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/viewer/first_mesh.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <string_view>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

#include "engine/query/questions.h"

namespace ptin::tools {

namespace {

/// With so many vertices a picture tells the terrain, in some ten kilobytes.
constexpr std::size_t kEnoughVertices = 900;
/// A mesh of more is not worth waiting for: a preview takes its place, of so many squares along the
/// longer side.
constexpr std::size_t kMostVertices = 6000;
constexpr std::int64_t kPreviewSquares = 32;
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

/// The picture that is drawn first, heights as whole numbers.
struct Picture {
  std::vector<std::array<std::int64_t, 3>> vertices;
  std::vector<bool> has_height;
  std::vector<std::array<std::int64_t, 3>> triangles;
  std::vector<bool> is_void;
};

/// The mesh of the stream itself.
Picture picture_of(const Tin& tin, const WholeHeights& heights, const HeightEncoding& encoding) {
  Picture picture;
  for (std::size_t v = 0; v < tin.vertices.size(); ++v) {
    const Vertex& vertex = tin.vertices[v];
    const bool has_height = tin.has_height[v] != 0;
    picture.vertices.push_back({vertex.position.x, vertex.position.y,
                                has_height ? heights.of(vertex.height, encoding) : 0});
    picture.has_height.push_back(has_height);
  }
  for (std::size_t t = 0; t < tin.triangles.size(); ++t) {
    const Triangle& triangle = tin.triangles[t];
    picture.triangles.push_back({triangle.v[0], triangle.v[1], triangle.v[2]});
    picture.is_void.push_back(tin.classes[t] == TriangleClass::kVoid);
  }
  return picture;
}

/// Places of a lattice over the bounds, with what a mesh is there.
class Preview {
 public:
  explicit Preview(const GridBox& bounds);
  /// Takes the heights of the places that a triangle covers. Cost: the places around it.
  void cover(const std::array<std::array<std::int64_t, 3>, 3>& corners, bool is_void);
  /// Squares of the lattice as two triangles each; a triangle with a corner in a void is void.
  [[nodiscard]] Picture picture() const;

 private:
  enum class Cover : std::uint8_t { kNone, kVoid, kSurface };
  struct Place {
    Cover cover = Cover::kNone;
    std::int64_t height = 0;
  };
  [[nodiscard]] static std::vector<std::int64_t> lines(std::int64_t least, std::int64_t most,
                                                       std::int64_t longest);
  void add_triangle(Picture& picture, const std::array<std::size_t, 3>& corners) const;

  std::vector<std::int64_t> xs_, ys_;
  std::vector<Place> places_;  ///< Row by row, from the least x and y.
};

Preview::Preview(const GridBox& bounds) {
  const std::int64_t width = std::int64_t{bounds.max_x} - bounds.min_x;
  const std::int64_t height = std::int64_t{bounds.max_y} - bounds.min_y;
  xs_ = lines(bounds.min_x, bounds.max_x, std::max(width, height));
  ys_ = lines(bounds.min_y, bounds.max_y, std::max(width, height));
  places_.resize(xs_.size() * ys_.size());
}

std::vector<std::int64_t> Preview::lines(std::int64_t least, std::int64_t most,
                                         std::int64_t longest) {
  const std::int64_t extent = most - least;
  const std::int64_t steps = std::clamp<std::int64_t>(
      kPreviewSquares * extent / std::max<std::int64_t>(longest, 1), 1, kPreviewSquares);
  std::vector<std::int64_t> all;
  for (std::int64_t i = 0; i <= steps; ++i) all.push_back(least + extent * i / steps);
  return all;
}

void Preview::cover(const std::array<std::array<std::int64_t, 3>, 3>& corners, bool is_void) {
  const auto& [a, b, c] = corners;
  const auto [left, right] = std::minmax({a[0], b[0], c[0]});
  const auto [low, high] = std::minmax({a[1], b[1], c[1]});
  // A picture alone: what floating point rounds is no matter.
  const auto cross = [](const auto& p, const auto& q, double x, double y) {
    return static_cast<double>(q[0] - p[0]) * (y - static_cast<double>(p[1])) -
           static_cast<double>(q[1] - p[1]) * (x - static_cast<double>(p[0]));
  };
  const double area = cross(a, b, static_cast<double>(c[0]), static_cast<double>(c[1]));
  if (!(area > 0)) return;
  for (auto y = std::lower_bound(ys_.begin(), ys_.end(), low); y != ys_.end() && *y <= high; ++y) {
    for (auto x = std::lower_bound(xs_.begin(), xs_.end(), left); x != xs_.end() && *x <= right;
         ++x) {
      const double at_x = static_cast<double>(*x), at_y = static_cast<double>(*y);
      const double u = cross(b, c, at_x, at_y) / area, v = cross(c, a, at_x, at_y) / area;
      const double w = 1.0 - u - v;
      // On an edge that rounds to neither side both of its triangles take the place, not none.
      if (std::min({u, v, w}) < -1e-12) continue;
      Place& place = places_[static_cast<std::size_t>(y - ys_.begin()) * xs_.size() +
                             static_cast<std::size_t>(x - xs_.begin())];
      if (place.cover == Cover::kSurface) continue;
      place.cover = is_void ? Cover::kVoid : Cover::kSurface;
      if (is_void) continue;
      place.height = std::llround(u * static_cast<double>(a[2]) + v * static_cast<double>(b[2]) +
                                  w * static_cast<double>(c[2]));
    }
  }
}

void Preview::add_triangle(Picture& picture, const std::array<std::size_t, 3>& corners) const {
  const auto least =
      std::min({places_[corners[0]].cover, places_[corners[1]].cover, places_[corners[2]].cover});
  if (least == Cover::kNone) return;
  picture.triangles.push_back({static_cast<std::int64_t>(corners[0]),
                               static_cast<std::int64_t>(corners[1]),
                               static_cast<std::int64_t>(corners[2])});
  picture.is_void.push_back(least == Cover::kVoid);
}

Picture Preview::picture() const {
  Picture picture;
  for (std::size_t i = 0; i < places_.size(); ++i) {
    picture.vertices.push_back({xs_[i % xs_.size()], ys_[i / xs_.size()], places_[i].height});
    picture.has_height.push_back(places_[i].cover == Cover::kSurface);
  }
  for (std::size_t row = 0; row + 1 < ys_.size(); ++row) {
    for (std::size_t column = 0; column + 1 < xs_.size(); ++column) {
      const std::size_t here = row * xs_.size() + column, above = here + xs_.size();
      add_triangle(picture, {here, here + 1, above + 1});
      add_triangle(picture, {here, above + 1, above});
    }
  }
  return picture;
}

/// A mesh that is too large to lie in a page, as a preview.
Picture preview_of(const Picture& whole, const GridBox& bounds) {
  Preview preview(bounds);
  for (std::size_t t = 0; t < whole.triangles.size(); ++t) {
    const auto& [a, b, c] = whole.triangles[t];
    preview.cover(
        {whole.vertices[static_cast<std::size_t>(a)], whole.vertices[static_cast<std::size_t>(b)],
         whole.vertices[static_cast<std::size_t>(c)]},
        whole.is_void[t]);
  }
  return preview.picture();
}

void add_vertices(Packed& packed, const Picture& picture) {
  std::array<std::int64_t, 3> before{};
  for (std::size_t v = 0; v < picture.vertices.size(); ++v) {
    std::array<std::int64_t, 3> now = picture.vertices[v];
    if (!picture.has_height[v]) now[2] = before[2];
    packed.add_step(now[0] - before[0], picture.has_height[v]);
    packed.add_step(now[1] - before[1]);
    packed.add_step(now[2] - before[2]);
    before = now;
  }
}

void add_triangles(Packed& packed, const Picture& picture) {
  std::int64_t before = 0;
  for (std::size_t t = 0; t < picture.triangles.size(); ++t) {
    const auto& [first, second, third] = picture.triangles[t];
    packed.add_step(first - before, picture.is_void[t]);
    packed.add_step(second - first);
    packed.add_step(third - first);
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
  Picture picture = picture_of(reader.tin(), heights, reader.facts().heights);
  const bool is_preview =
      picture.vertices.size() > kMostVertices || !std::isfinite(reader.certificate().error);
  if (is_preview) picture = preview_of(picture, reader.facts().bounds);
  if (picture.triangles.empty()) return {};
  Packed packed;
  add_vertices(packed, picture);
  add_triangles(packed, picture);
  const double rounding = heights.is_float ? heights.step / 2 : 0.0;
  // Nothing is known of a preview: null.
  nlohmann::json error, deviation;
  if (!is_preview) {
    error = reader.certificate().error + rounding;
    deviation = reader.certificate().deviation + rounding;
  }
  const nlohmann::json all = {{"facts", facts_of(reader.facts(), heights)},
                              {"metadata", reader.metadata()},
                              {"error", error},
                              {"deviation", deviation},
                              {"vertices", picture.vertices.size()},
                              {"triangles", picture.triangles.size()},
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
  // Splits at borders of voids come first, and until all of them are there no error is finite. A
  // preview then takes whatever there is, for shape between the voids.
  const auto is_enough = [&] {
    const std::size_t vertices = reader.tin().vertices.size();
    return vertices >= kEnoughVertices && vertices <= kMostVertices &&
           std::isfinite(reader.certificate().error);
  };
  while (!beginning.empty() && !reader.is_complete() && !is_enough()) {
    beginning = beginning.subspan(reader.feed_frame(beginning));
  }
  if (!reader.has_mesh()) return {};
  return element_of(reader);
}

bool is_preview(std::string_view element) {
  // In a string of JSON quotation marks are escaped: this is the member itself.
  return element.find(R"("error":null)") != std::string_view::npos;
}

}  // namespace ptin::tools
