// SPDX-License-Identifier: GPL-3.0-or-later
//
// Binary STL: 80 bytes of header, the number of triangles, and 50 bytes a triangle. It must not
// begin with "solid", by which programs know the text form.
#include <cmath>
#include <cstdio>
#include <cstring>

#include "engine/error.h"
#include "tools/formats/mesh_stream.h"
#include "tools/output/output_file.h"

namespace ptin::tools {

namespace {

constexpr std::size_t kHeaderBytes = 80;

std::string stl_header(const LocalFrame& frame) {
  const auto numbers = [](const std::array<double, 3>& values) {
    std::string text;
    for (const double value : values) {
      std::array<char, 24> number{};
      std::snprintf(number.data(), number.size(), " %.9g", value);
      text += number.data();
    }
    return text;
  };
  std::string header = "ptin origin" + numbers(frame.origin) + " scale" + numbers(frame.scale);
  header.resize(kHeaderBytes);
  return header;
}

class Stl final : public MeshStream {
 public:
  explicit Stl(const MeshStreamTarget& target)
      : frame_(target.frame), out_(target.path, target.overwrite) {
    out_.write(stl_header(frame_));
    out_.write_value(triangles_);
  }

  void add_vertex(const Point& /*point*/) override {}

  void add_triangle(const std::array<Corner, 3>& corners) override {
    if (triangles_ == UINT32_MAX) {
      refuse("STL counts at most 2^32 - 1 triangles; ask for a window or a tolerance");
    }
    ++triangles_;
    std::array<Point, 3> p{};
    for (std::size_t i = 0; i < 3; ++i) p[i] = frame_.to_local(corners[i].point);
    std::array<float, 12> numbers{};
    set_normal(p, numbers);
    for (std::size_t i = 0; i < 9; ++i) numbers[3 + i] = static_cast<float>(p[i / 3][i % 3]);
    out_.write_value(numbers);
    out_.write_value(std::uint16_t{0});  // the attributes, of which there are none
  }

  void publish() override {
    std::array<char, sizeof triangles_> count{};
    std::memcpy(count.data(), &triangles_, sizeof triangles_);
    out_.replace(kHeaderBytes, {count.data(), count.size()});
    out_.publish();
  }

 private:
  static void set_normal(const std::array<Point, 3>& p, std::array<float, 12>& numbers) {
    Point u{}, v{};
    for (std::size_t i = 0; i < 3; ++i) {
      u[i] = p[1][i] - p[0][i];
      v[i] = p[2][i] - p[0][i];
    }
    const Point n = {u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2],
                     u[0] * v[1] - u[1] * v[0]};
    const double length = std::sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
    if (!(length > 0)) return;  // a normal of zeros: readers compute their own
    for (std::size_t i = 0; i < 3; ++i) numbers[i] = static_cast<float>(n[i] / length);
  }

  LocalFrame frame_;
  OutputFile out_;
  std::uint32_t triangles_ = 0;
};

}  // namespace

std::unique_ptr<MeshStream> make_stl(const MeshStreamTarget& target) {
  return std::make_unique<Stl>(target);
}

}  // namespace ptin::tools
