// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/tin/tin_vertices.h"

#include <algorithm>
#include <utility>

#include "engine/construct/grid/source_options.h"
#include "engine/construct/grid/source_point.h"
#include "engine/construct/scratch/record_file.h"
#include "storage/file/file_questions.h"

namespace ptin {

namespace {

/// Sorters of read_named_tin() that hold memory at the same time.
constexpr std::uint64_t kSorters = 3;

ExternalMemory memory_of(const StreamResources& resources) {
  ExternalMemory memory = resources.memory != nullptr
                              ? *resources.memory
                              : ExternalMemory{FileLayer::system(), system_temporary_folder()};
  memory.bytes /= kSorters;
  return memory;
}

}  // namespace

TinVertices::TinVertices(const std::string& path, const PointChoice& choice,
                         std::optional<double> nodata, const StreamResources& resources) {
  SourceOptions options;
  options.points = choice;
  options.nodata = nodata;
  const ExternalMemory memory = memory_of(resources);
  const auto progress = [&](const char*, std::uint64_t done, std::uint64_t total) {
    if (resources.progress) {
      resources.progress(done, total);
    }
  };
  NamedTin tin = read_named_tin(path, {options, memory, resources.stop, progress}, memory);
  facts_.crs = tin.facts.crs;
  facts_.vertical_crs = tin.facts.vertical_crs;
  facts_.units = tin.facts.units;
  warnings_ = tin.facts.warnings;
  left_out_.add(LeftOutReason::kNoTriangle, tin.unused_vertices);
  vertices_.emplace(std::move(tin.vertices));
}

bool TinVertices::next(std::vector<SourcePoint>& batch) {
  constexpr std::uint64_t kBatchPoints = 4096;
  std::vector<NamedVertex> vertices;
  vertices_->take(next_, std::min(kBatchPoints, total() - next_), vertices);
  next_ += vertices.size();
  batch.clear();
  for (const NamedVertex& v : vertices) {
    batch.push_back(v.point());
  }
  return !batch.empty();
}

}  // namespace ptin
