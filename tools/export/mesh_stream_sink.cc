// SPDX-License-Identifier: GPL-3.0-or-later
//
// The formats of tools/formats/mesh_stream.h, fed by patches.
#include <utility>

#include "tools/export/tin_sink.h"
#include "tools/formats/mesh_stream.h"
#include "tools/formats/solid_stream.h"

namespace ptin::tools {

namespace {

class MeshStreamSink final : public TinSink {
 public:
  explicit MeshStreamSink(std::unique_ptr<MeshStream> stream) : stream_(std::move(stream)) {}

  void add(const TinPatch& patch) override {
    for (const TinPatch::Point& vertex : patch.vertices) stream_->add_vertex(vertex);
    for (const auto& triangle : patch.triangles) {
      std::array<MeshStream::Corner, 3> corners{};
      for (std::size_t i = 0; i < 3; ++i) {
        corners[i] = {triangle[i].number, patch.point(triangle[i])};
      }
      stream_->add_triangle(corners);
    }
  }
  void publish() override { stream_->publish(); }

 private:
  std::unique_ptr<MeshStream> stream_;
};

std::unique_ptr<TinSink> sink_of(std::unique_ptr<MeshStream> (*make)(const MeshStreamTarget&),
                                 const SinkTarget& target) {
  std::unique_ptr<MeshStream> stream =
      make({target.path, target.overwrite, target.crs, target.frame});
  if (target.solid_base)
    stream = make_solid(std::move(stream), *target.solid_base, target.border_bytes);
  return std::make_unique<MeshStreamSink>(std::move(stream));
}

}  // namespace

std::unique_ptr<TinSink> make_land_xml_sink(const SinkTarget& target) {
  return sink_of(make_land_xml, target);
}

std::unique_ptr<TinSink> make_obj_sink(const SinkTarget& target) {
  return sink_of(make_obj, target);
}

std::unique_ptr<TinSink> make_two_dm_sink(const SinkTarget& target) {
  return sink_of(make_two_dm, target);
}

std::unique_ptr<TinSink> make_dxf_sink(const SinkTarget& target) {
  return sink_of(make_dxf, target);
}

std::unique_ptr<TinSink> make_stl_sink(const SinkTarget& target) {
  return sink_of(make_stl, target);
}

}  // namespace ptin::tools
