// SPDX-License-Identifier: GPL-3.0-or-later
//
// SMS 2DM: MESH2D, then E3T (element, three nodes, material) and ND (node, x, y, z), ids from 1.
// The format has no place for a CRS; QGIS asks for it, or reads a .prj beside the file.
#include "tools/formats/mesh_stream.h"
#include "tools/formats/number_text.h"
#include "tools/output/output_file.h"
#include "tools/output/spill_file.h"

namespace ptin::tools {

namespace {

class TwoDm final : public MeshStream {
 public:
  explicit TwoDm(const MeshStreamTarget& target)
      : out_(target.path, target.overwrite), nodes_(target.path) {
    out_.write("MESH2D\n");
  }

  void add_vertex(const Point& point) override {
    line_ = "ND ";
    append_number(line_, ++vertices_);
    for (const double coordinate : point) {
      line_ += ' ';
      append_number(line_, coordinate);
    }
    line_ += '\n';
    nodes_.write(line_.data(), line_.size());
  }

  void add_triangle(const std::array<Corner, 3>& corners) override {
    line_ = "E3T ";
    append_number(line_, ++triangles_);
    for (const Corner& corner : corners) {
      line_ += ' ';
      append_number(line_, corner.number + 1);
    }
    out_.write(line_ += " 1\n");
  }

  void publish() override {
    for (auto bytes = nodes_.read(); !bytes.empty(); bytes = nodes_.read())
      out_.write(bytes.data(), bytes.size());
    out_.publish();
  }

 private:
  OutputFile out_;
  SpillFile nodes_;
  std::uint64_t vertices_ = 0, triangles_ = 0;
  std::string line_;
};

}  // namespace

std::unique_ptr<MeshStream> make_two_dm(const MeshStreamTarget& target) {
  return std::make_unique<TwoDm>(target);
}

}  // namespace ptin::tools
