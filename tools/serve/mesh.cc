// SPDX-License-Identifier: GPL-3.0-or-later
//
// A mesh of a window, as GLB or PLY.
#include <algorithm>
#include <array>
#include <cstdint>
#include <string>

#include "engine/error.h"
#include "engine/stop.h"
#include "tools/formats/mesh_writer.h"
#include "tools/http/problem.h"
#include "tools/region/mesh_crs.h"
#include "tools/region/tin_mesh.h"
#include "tools/serve/answer_parts.h"
#include "tools/serve/questions.h"

namespace ptin::serve {

namespace {

struct MeshQuestion {
  RefineRequest request;
  ask::RegionText region;
};

void add_question(ask::Parameters& rows, MeshQuestion& question) {
  ask::add_window(rows, question.region, ask::Door::kService);
  ask::add_detail(
      rows, question.request.detail, "",
      "A mesh of so many vertices, the most important ones of the window, instead of an error",
      ask::Door::kService);
  ask::add_crs(rows);
}

/// The file in memory, within what is left of the question's.
class BoundedSink : public tools::MemorySink {
 public:
  explicit BoundedSink(std::uint64_t most_bytes) : left_(most_bytes) {}
  using tools::MemorySink::write;
  void write(const void* data, std::size_t bytes) override {
    if (bytes > left_) {
      throw Error(ErrorCode::resource_exhausted, "the mesh takes more than its memory");
    }
    left_ -= bytes;
    tools::MemorySink::write(data, bytes);
  }

 private:
  std::uint64_t left_;
};

/// The file of a mesh. The engine left half of the memory: the mesh and the file share it.
std::string file_of(const tools::Mesh& mesh, bool as_glb, const Asked& asked) {
  const std::uint64_t bytes = mesh.vertices.size() * sizeof mesh.vertices[0] +
                              mesh.triangles.size() * sizeof mesh.triangles[0];
  const std::uint64_t rest = asked.limits.memory_bytes - engine_limits(asked).memory_bytes;
  BoundedSink sink(rest - std::min(rest, bytes));
  stop_if_asked(asked.limits.stop, "the mesh");
  as_glb ? tools::write_glb(mesh, sink) : tools::write_ply(mesh, sink);
  return sink.take();
}

}  // namespace

ask::Parameters mesh_parameters() { return described<MeshQuestion>(); }

http::Response answer_mesh(const Asked& asked) {
  const ask::Format& format = format_of(asked);
  auto question = read<MeshQuestion>(asked);
  const Places places = places_of(asked);
  RefineRequest& request = question.request;
  check_detail(asked, request.detail);
  const std::size_t most = asked.options.question.vertices;
  if (request.detail.vertices) {
    check_count(*request.detail.vertices, most, "vertices", "vertices", "vertices");
  }
  if (const auto window = window_on_terrain(asked, places, question.region.window)) {
    request.region = *window;
    request.form = ResultForm::kMeetingRegion;
  }
  request.limits = engine_limits(asked);
  const RefinedTin refined = asked.terrain().refine(request);
  check_count(refined.vertices, most, "vertices", "vertices", "bbox");
  tools::Mesh mesh = tools::surface_mesh(refined, asked.facts());
  tools::set_crs(mesh, asked.collection->crs, asked.facts());
  http::Response response =
      answered(asked, file_of(mesh, format.name == "glb", asked), format.media, refined);
  response.add("Ptin-Vertices", std::to_string(mesh.vertices.size()));
  response.add("Ptin-Triangles", std::to_string(mesh.triangles.size()));
  return response;
}

}  // namespace ptin::serve
