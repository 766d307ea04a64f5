// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/formats/solid_stream.h"

#include <algorithm>
#include <cstdio>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

#include "engine/error.h"
#include "tools/formats/mesh_writer.h"

namespace ptin::tools {

namespace {

/// An edge of one triangle, in the direction in which that runs along it.
struct DirectedEdge {
  std::uint64_t from, to;
  auto operator<=>(const DirectedEdge&) const = default;
};

struct EdgeHash {
  std::size_t operator()(const DirectedEdge& e) const noexcept {
    return static_cast<std::size_t>((e.from * 0x9E3779B97F4A7C15U) ^ (e.to * 0xC2B2AE3D27D4EB4FU));
  }
};

class Solid final : public MeshStream {
 public:
  Solid(std::unique_ptr<MeshStream> inner, double base, std::uint64_t most_bytes)
      : inner_(std::move(inner)), base_(base), most_open_(most_bytes / kOpenEdgeBytes) {}

  void add_vertex(const Point& point) override {
    if (!(point[2] > base_)) {
      std::array<char, 32> height{};
      std::snprintf(height.data(), height.size(), "%.7g", point[2]);
      throw Error(
          ErrorCode::invalid_argument,
          std::string("the base must be below all that is written, and there is a height of ") +
              height.data() + "; give a lower one",
          "--solid");
    }
    inner_->add_vertex(point);
    inner_->add_vertex(below(point));
  }

  void add_triangle(const std::array<Corner, 3>& corners) override {
    std::array<Corner, 3> top{}, bottom{};
    for (std::size_t i = 0; i < 3; ++i) {
      top[i] = on_top(corners[i]);
      bottom[2 - i] = at_base(corners[i]);
    }
    inner_->add_triangle(top);
    inner_->add_triangle(bottom);
    for (std::size_t i = 0; i < 3; ++i) note_edge(corners[i], corners[(i + 1) % 3]);
  }

  void publish() override {
    std::vector<std::pair<DirectedEdge, std::array<Point, 2>>> borders(open_.begin(), open_.end());
    std::sort(borders.begin(), borders.end(),
              [](const auto& a, const auto& b) { return a.first < b.first; });
    for (const auto& [edge, points] : borders) {
      const Corner from{edge.from, points[0]}, to{edge.to, points[1]};
      inner_->add_triangle({on_top(to), on_top(from), at_base(from)});
      inner_->add_triangle({on_top(to), at_base(from), at_base(to)});
    }
    inner_->publish();
  }

 private:
  static constexpr std::uint64_t kOpenEdgeBytes = 112;

  [[nodiscard]] Point below(const Point& p) const { return {p[0], p[1], base_}; }
  static Corner on_top(const Corner& c) { return {2 * c.number, c.point}; }
  [[nodiscard]] Corner at_base(const Corner& c) const { return {2 * c.number + 1, below(c.point)}; }

  void note_edge(const Corner& from, const Corner& to) {
    if (open_.erase({to.number, from.number}) > 0) return;
    if (open_.size() >= most_open_) {
      throw Error(ErrorCode::resource_exhausted,
                  "the border of what is written does not fit the memory given; raise --memory, or "
                  "ask for a window or an error");
    }
    open_.emplace(DirectedEdge{from.number, to.number}, std::array<Point, 2>{from.point, to.point});
  }

  std::unique_ptr<MeshStream> inner_;
  double base_;
  std::uint64_t most_open_;
  std::unordered_map<DirectedEdge, std::array<Point, 2>, EdgeHash> open_;
};

/// Keeps what comes as a mesh.
class Collector final : public MeshStream {
 public:
  explicit Collector(Mesh& mesh) : mesh_(mesh) {}
  void add_vertex(const Point& point) override { mesh_.vertices.push_back(point); }
  void add_triangle(const std::array<Corner, 3>& corners) override {
    const auto id = [&](std::size_t i) { return static_cast<std::uint32_t>(corners[i].number); };
    mesh_.triangles.push_back({id(0), id(1), id(2)});
  }
  void publish() override {}

 private:
  Mesh& mesh_;
};

}  // namespace

std::unique_ptr<MeshStream> make_solid(std::unique_ptr<MeshStream> inner, double base,
                                       std::uint64_t most_bytes) {
  return std::make_unique<Solid>(std::move(inner), base, most_bytes);
}

Mesh solid_of(const Mesh& surface, double base) {
  if (surface.vertices.size() > UINT32_MAX / 2) {
    refuse("a solid has twice the vertices, more than 2^32; ask for a window or an error");
  }
  Mesh solid;
  solid.crs = surface.crs;
  solid.metres_per_unit = surface.metres_per_unit;
  solid.frame = surface.frame;
  write_in_pieces(surface, *make_solid(std::make_unique<Collector>(solid), base));
  return solid;
}

}  // namespace ptin::tools
