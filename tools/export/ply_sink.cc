// SPDX-License-Identifier: GPL-3.0-or-later
#include <cstring>

#include "engine/error.h"
#include "tools/export/tin_sink.h"
#include "tools/formats/crs_lines.h"
#include "tools/output/output_file.h"
#include "tools/output/spill_file.h"

namespace ptin::tools {

namespace {

/// The header of the PLY. It has one length for all counts, so that it can be written again at the
/// end. Spare room is a row of dots in a comment, since readers split header lines at single
/// spaces.
std::string header_of(const CrsFacts& crs, std::uint64_t vertices, std::uint64_t triangles) {
  constexpr std::size_t kMostDigits = 20;
  const std::string v = std::to_string(vertices);
  const std::string t = std::to_string(triangles);
  const std::string index = vertices > INT32_MAX ? "uint" : "int";
  const std::size_t spare = 2 * kMostDigits + 4 - v.size() - t.size() - index.size();
  std::string text = "ply\nformat binary_little_endian 1.0\ncomment written by ptin";
  text.append(spare, '.').append("\n");
  text += crs_lines(crs, "comment ");
  text += "element vertex " + v + "\n";
  text += "property double x\nproperty double y\nproperty double z\n";
  text += "element face " + t + "\n";
  text += "property list uchar " + index + " vertex_indices\nend_header\n";
  return text;
}

class PlySink final : public TinSink {
 public:
  explicit PlySink(const SinkTarget& target)
      : crs_(target.crs), out_(target.path, target.overwrite), faces_(target.path) {
    out_.write(header_of(crs_, 0, 0));
  }

  void add(const TinPatch& patch) override {
    vertices_ = patch.first_vertex + patch.vertices.size();
    if (vertices_ > std::uint64_t{UINT32_MAX} + 1) {
      throw Error(ErrorCode::invalid_argument,
                  "PLY counts at most 2^32 vertices; export a window or a tolerance");
    }
    for (const auto& vertex : patch.vertices) out_.write_value(vertex);
    for (const auto& triangle : patch.triangles) {
      char face[1 + 3 * sizeof(std::uint32_t)];
      face[0] = 3;
      for (std::size_t i = 0; i < 3; ++i) {
        const auto number = static_cast<std::uint32_t>(triangle[i].number);
        std::memcpy(face + 1 + i * sizeof number, &number, sizeof number);
      }
      faces_.write(face, sizeof face);
    }
    triangles_ += patch.triangles.size();
  }

  void publish() override {
    for (auto bytes = faces_.read(); !bytes.empty(); bytes = faces_.read()) {
      out_.write(bytes.data(), bytes.size());
    }
    out_.replace(0, header_of(crs_, vertices_, triangles_));
    out_.publish();
  }

 private:
  CrsFacts crs_;
  OutputFile out_;
  SpillFile faces_;
  std::uint64_t vertices_ = 0;
  std::uint64_t triangles_ = 0;
};

}  // namespace

std::unique_ptr<TinSink> make_ply_sink(const SinkTarget& target) {
  return std::make_unique<PlySink>(target);
}

}  // namespace ptin::tools
