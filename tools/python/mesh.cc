// SPDX-License-Identifier: GPL-3.0-or-later
//
// Meshes: at a level of detail, and part by part.
#include <algorithm>
#include <limits>
#include <unordered_map>
#include <vector>

#include <unistd.h>

#include "engine/error.h"
#include "tools/export/tin_patch.h"
#include "tools/python/binding.h"

namespace ptin::python {

namespace {

constexpr const char* kTooMany =
    "the mesh has more than 2^31 - 1 vertices; take it by parts(), or with an error";

/// Vertices as x, y, height, and faces as numbers of three of them.
struct MeshArrays {
  std::vector<double> vertices;
  std::vector<std::int32_t> faces;

  /// REQUIRES: the GIL.
  [[nodiscard]] py::tuple taken() {
    return py::make_tuple(table_of(std::move(vertices), 3), table_of(std::move(faces), 3));
  }
};

/// The surface of a TIN: vertices without a height, which stand in void triangles only, are left out.
MeshArrays surface_of(const Tin& tin, const StoreFacts& facts) {
  MeshArrays mesh;
  std::vector<std::int32_t> number(tin.vertices.size(), -1);
  if (tin.vertices.size() > std::numeric_limits<std::int32_t>::max()) {
    throw Error(ErrorCode::resource_exhausted, kTooMany);
  }
  mesh.vertices.reserve(3 * tin.vertices.size());
  std::int32_t next = 0;
  for (std::size_t v = 0; v < tin.vertices.size(); ++v) {
    if (tin.has_height[v] == 0) continue;
    const Vertex& vertex = tin.vertices[v];
    const MapPoint at = facts.map.to_map(vertex.position.x, vertex.position.y);
    mesh.vertices.insert(mesh.vertices.end(), {at.x, at.y, facts.heights.height(vertex.height)});
    number[v] = next++;
  }
  mesh.faces.reserve(3 * tin.triangles.size());
  for (std::size_t t = 0; t < tin.triangles.size(); ++t) {
    if (tin.classes[t] != TriangleClass::kSurface) continue;
    for (const VertexId v : tin.triangles[t].v) mesh.faces.push_back(number[v]);
  }
  return mesh;
}

py::tuple refine(const OpenTerrain& t, const RegionArgument& region, bool clip,
                 std::optional<std::uint64_t> triangles, const Asked& asked) {
  std::stop_source stop;
  RefineRequest request;
  asked.put(request, stop.get_token());
  request.region = region_of(region);
  request.triangles = triangles;
  request.form = clip ? ResultForm::kMeetingRegion : ResultForm::kWholeDomain;
  MeshArrays mesh;
  const RefinedTin found = answer(t, stop, [&] {
    RefinedTin refined = t.terrain.refine(request);
    mesh = surface_of(refined.tin, t.terrain.store().facts());
    refined.tin = {};
    return refined;
  });
  const py::tuple arrays = mesh.taken();
  return py::make_tuple(arrays[0], arrays[1], certificate_of(found));
}

/// A patch by itself: with the vertices of its triangles, whichever patch owns them.
MeshArrays mesh_of(const tools::TinPatch& patch) {
  MeshArrays mesh;
  std::unordered_map<VertexId, std::int32_t> numbers;
  mesh.faces.reserve(3 * patch.triangles.size());
  for (const auto& triangle : patch.triangles) {
    for (const tools::TinPatch::Corner& corner : triangle) {
      const auto [known, is_new] =
          numbers.try_emplace(corner.local, static_cast<std::int32_t>(numbers.size()));
      if (is_new) {
        const tools::TinPatch::Point p = patch.point(corner);
        mesh.vertices.insert(mesh.vertices.end(), p.begin(), p.end());
      }
      mesh.faces.push_back(known->second);
    }
  }
  return mesh;
}

/// A walk over the parts of a TIN, on a thread of its own, which makes a part while the loop works on
/// the one before.
class PartWalk {
 public:
  PartWalk(std::shared_ptr<const OpenTerrain> t, const RegionArgument& region, const Asked& asked)
      : terrain_(std::move(t)) {
    asked.put(request_, stop_.get_token());
    request_.region = region_of(region);
    // What a patch takes beside its part, and two parts as arrays: in work, and in the loop.
    request_.limits.memory_bytes /= 4;
    parts_ = answer(*terrain_, stop_,
                    [this] { return std::make_unique<TinParts>(terrain_->terrain, request_); });
    certified_ = parts_->detail().certificate();
    is_exact_ = parts_->detail().is_exact(terrain_->terrain.store().facts());
    walker_ = std::jthread([this] { walk(); });
  }
  ~PartWalk() {
    if (is_ended_by_python()) {  // the GIL, once let go, could not be had again
      end();
      return;
    }
    const Question question;
    const py::gil_scoped_release release;
    end();
  }
  PartWalk(const PartWalk&) = delete;
  PartWalk& operator=(const PartWalk&) = delete;

  /// None after the last part.
  py::object next() {
    Question question(stop_);
    const std::stop_callback on_stop(stop_.get_token(), [this] { terrain_->stop_waiting(); });
    std::unique_lock lock(mutex_);
    if (question.wait(lock, changed_, [this] { return is_ready_ || is_done_; })) {
      raise_what_is_set();
    }
    if (is_ready_) {
      MeshArrays mesh = std::move(mesh_);
      is_ready_ = false;
      changed_.notify_all();
      lock.unlock();
      return mesh.taken();
    }
    if (failure_) {
      exit_if_ended_by_python();
      std::rethrow_exception(std::exchange(failure_, nullptr));
    }
    return py::none();
  }
  [[nodiscard]] py::tuple certificate() const {
    return py::make_tuple(certified_.error, certified_.deviation, is_exact_);
  }

 private:
  void walk() {
    try {
      tools::PatchMaker maker(terrain_->terrain.store(), request_.region);
      const std::uint64_t border_bytes = request_.limits.memory_bytes;
      walk_cells(*parts_, [&](const GridCell& cell, Tin& part, double) {
        MeshArrays mesh = mesh_of(maker.make(cell, part, border_bytes));
        if (!mesh.faces.empty()) hand_over(std::move(mesh));
      });
    } catch (...) {
      failure_ = std::current_exception();
    }
    const std::lock_guard lock(mutex_);
    is_done_ = true;
    changed_.notify_all();
  }
  /// Waits until the loop has taken the part before.
  void hand_over(MeshArrays mesh) {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [this] { return !is_ready_ || stop_.stop_requested(); });
    mesh_ = std::move(mesh);
    is_ready_ = true;
    changed_.notify_all();
  }
  void end() {
    stop_.request_stop();
    {
      const std::lock_guard lock(mutex_);
      changed_.notify_all();
    }
    walker_.join();
  }

  std::shared_ptr<const OpenTerrain> terrain_;
  PartRequest request_;
  std::stop_source stop_;
  std::unique_ptr<TinParts> parts_;
  Certificate certified_;
  bool is_exact_ = false;
  std::mutex mutex_;  ///< Guards what follows.
  std::condition_variable changed_;
  MeshArrays mesh_;
  bool is_ready_ = false, is_done_ = false;
  std::exception_ptr failure_;
  std::jthread walker_;
};

/// The parts of a TIN, for a loop that asks for the next one.
class PartIterator {
 public:
  PartIterator(std::shared_ptr<const OpenTerrain> t, const RegionArgument& region,
               const Asked& asked)
      : walk_(std::make_unique<PartWalk>(std::move(t), region, asked)) {}
  ~PartIterator() {
    // The child of a fork has no thread that walks, and locks that are never let go: the memory stays.
    if (is_child()) (void)walk_.release();
  }
  PartIterator(const PartIterator&) = delete;
  PartIterator& operator=(const PartIterator&) = delete;

  /// None after the last part.
  py::object next() {
    if (is_child()) {
      refuse(
          "these parts were begun before the process forked, and go on in its parent; ask for "
          "parts() in the child");
    }
    return walk_->next();
  }
  [[nodiscard]] py::tuple certificate() const { return walk_->certificate(); }

 private:
  [[nodiscard]] bool is_child() const { return process_ != getpid(); }

  std::unique_ptr<PartWalk> walk_;
  pid_t process_ = getpid();
};

}  // namespace

void add_meshes(py::module_& module) {
  module.def("refine", refine);
  py::class_<PartIterator>(module, "Parts")
      .def(py::init<std::shared_ptr<const OpenTerrain>, const RegionArgument&, const Asked&>())
      .def("next", &PartIterator::next)
      .def("certificate", &PartIterator::certificate);
}

}  // namespace ptin::python
