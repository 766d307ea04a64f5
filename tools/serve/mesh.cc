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

constexpr auto kMeshParameters = std::to_array<ParameterFact>(
    {kBboxParameter,
     kErrorParameter,
     {"vertices", "integer", "a mesh of so many vertices, the most important ones of the window"},
     kCrsParameter,
     {"f", "string", "glb (metres around a local origin, y up) or ply (map coordinates)", "glb"}});
constexpr auto kMeshFormats =
    std::to_array<OfferedFormat>({{"glb", "model/gltf-binary"}, {"ply", "application/x-ply"}});

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

std::span<const ParameterFact> mesh_parameters() noexcept { return kMeshParameters; }

http::Response answer_mesh(const Asked& asked) {
  const OfferedFormat& format = format_of(asked, kMeshFormats);
  const Places places(asked.collection->crs, asked.question.text("crs"), asked.collection->bounds,
                      asked.request.share);
  RefineRequest request;
  request.detail = detail_of(asked);
  const std::size_t most = asked.options.question.vertices;
  if (request.detail.vertices) {
    check_count(*request.detail.vertices, most, "vertices", "vertices", "vertices");
  }
  if (const auto window = window_on_terrain(asked, places)) {
    request.region = *window;
    request.form = ResultForm::kMeetingRegion;
  }
  request.limits = engine_limits(asked);
  const RefinedTin refined = asked.terrain().refine(request);
  check_count(refined.vertices, most, "vertices", "vertices", "bbox");
  tools::Mesh mesh = tools::surface_mesh(refined, asked.facts());
  tools::set_crs(mesh, asked.collection->crs, asked.facts());
  http::Response response = text_response(file_of(mesh, format.name == "glb", asked), format.media);
  add_choice(response, asked);
  response.add("Ptin-Vertices", std::to_string(mesh.vertices.size()));
  response.add("Ptin-Triangles", std::to_string(mesh.triangles.size()));
  add_cost(response, refined.cost);
  add_certainty(response, refined.certified_error, refined.exact);
  return response;
}

}  // namespace ptin::serve
