// SPDX-License-Identifier: GPL-3.0-or-later
//
// DXF, release 12: pairs of lines, a group's code and its value. GDAL's DXF driver writes lines and
// hatches, and no faces; of this release a header and the entities are enough.
#include <algorithm>

#include "tools/formats/dxf_units.h"
#include "tools/formats/mesh_stream.h"
#include "tools/formats/number_text.h"
#include "tools/output/output_file.h"

namespace ptin::tools {

namespace {

class Dxf final : public MeshStream {
 public:
  explicit Dxf(const MeshStreamTarget& target) : out_(target.path, target.overwrite) {
    std::string text = "999\nwritten by ptin\n";
    const CrsFacts& crs = target.crs;
    // A value has at most 255 characters, which WKT does not keep to.
    const std::string name = crs.code.empty() ? crs.name : crs.code;
    if (!name.empty()) text += "999\ncrs: " + on_one_line(name) + "\n";
    if (crs.vertical_unit != "unknown" && crs.vertical_unit != crs.horizontal_unit)
      text += "999\nheights: " + on_one_line(crs.vertical_unit) + "\n";
    const DxfUnits units = dxf_units(crs);
    text += "0\nSECTION\n2\nHEADER\n9\n$ACADVER\n1\nAC1009\n9\n$INSUNITS\n70\n" +
            std::to_string(units.insunits) + "\n9\n$MEASUREMENT\n70\n" +
            std::to_string(units.measurement) + "\n0\nENDSEC\n";
    text += "0\nSECTION\n2\nENTITIES\n";
    out_.write(text);
  }

  void add_vertex(const Point& /*point*/) override {}

  void add_triangle(const std::array<Corner, 3>& corners) override {
    text_ = "0\n3DFACE\n8\nTIN\n";
    // A face has four corners; of a triangle the last two are one.
    for (std::size_t i = 0; i < 4; ++i) {
      const Point& p = corners[std::min<std::size_t>(i, 2)].point;
      for (std::size_t axis = 0; axis < 3; ++axis) {
        append_number(text_, std::uint64_t{10} * (axis + 1) + i);
        text_ += '\n';
        append_number(text_, p[axis]);
        text_ += '\n';
      }
    }
    out_.write(text_);
  }

  void publish() override {
    out_.write("0\nENDSEC\n0\nEOF\n");
    out_.publish();
  }

 private:
  static std::string on_one_line(std::string text) {
    constexpr std::size_t kLongest = 200;
    text.resize(std::min(text.size(), kLongest));
    for (char& c : text) {
      if (c == '\n' || c == '\r') c = ' ';
    }
    return text;
  }

  OutputFile out_;
  std::string text_;
};

}  // namespace

std::unique_ptr<MeshStream> make_dxf(const MeshStreamTarget& target) {
  return std::make_unique<Dxf>(target);
}

}  // namespace ptin::tools
