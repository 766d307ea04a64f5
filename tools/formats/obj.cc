// SPDX-License-Identifier: GPL-3.0-or-later
//
// Wavefront OBJ: map coordinates as they are (x east, y north, z up), every digit that a double
// needs, indices from 1.
#include "tools/formats/crs_lines.h"
#include "tools/formats/mesh_stream.h"
#include "tools/formats/number_text.h"
#include "tools/output/output_file.h"
#include "tools/output/spill_file.h"

namespace ptin::tools {

namespace {

class Obj final : public MeshStream {
 public:
  explicit Obj(const MeshStreamTarget& target)
      : out_(target.path, target.overwrite), faces_(target.path) {
    std::string head = "# written by ptin; x east, y north, z up\n";
    out_.write(head += crs_lines(target.crs, "# "));
  }

  void add_vertex(const Point& point) override {
    line_.assign(1, 'v');
    for (const double coordinate : point) {
      line_ += ' ';
      append_number(line_, coordinate);
    }
    out_.write(line_ += '\n');
  }

  void add_triangle(const std::array<Corner, 3>& corners) override {
    line_.assign(1, 'f');
    for (const Corner& corner : corners) {
      line_ += ' ';
      append_number(line_, corner.number + 1);
    }
    line_ += '\n';
    faces_.write(line_.data(), line_.size());
  }

  void publish() override {
    for (auto bytes = faces_.read(); !bytes.empty(); bytes = faces_.read())
      out_.write(bytes.data(), bytes.size());
    out_.publish();
  }

 private:
  OutputFile out_;
  SpillFile faces_;
  std::string line_;
};

}  // namespace

std::unique_ptr<MeshStream> make_obj(const MeshStreamTarget& target) {
  return std::make_unique<Obj>(target);
}

}  // namespace ptin::tools
