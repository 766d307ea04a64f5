// SPDX-License-Identifier: GPL-3.0-or-later
//
// The vertices of a TIN as points: what --repair triangulates anew, and what is verified against.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "engine/construct/grid/source_options.h"
#include "engine/construct/grid/source_point.h"
#include "engine/construct/read/point_stream.h"
#include "engine/construct/tin/tin_names.h"

namespace ptin {

/// A stream of the vertices that a TIN's triangles name, in the order of their ids. TINs may be of any
/// size: vertices and triangles are matched by sorting on disk.
class TinVertices final : public PointStream {
 public:
  /// Reads the file once.
  /// @param choice     Its `layer` names the surface of a LandXML file.
  /// @param nodata     Triangles with a corner of this height are left out.
  /// @param resources  Where it names no memory: 64 MiB, and the system's temporary folder.
  /// @throws Error as read_tin_file(); invalid_argument  an id that no vertex has, or that two
  ///               have; no triangle has a height; io_error, resource_exhausted, cancelled
  TinVertices(const std::string& path, const PointChoice& choice, std::optional<double> nodata = {},
              const StreamResources& resources = {});

  /// The most bytes of disk that the constructor takes for a vertex: 40 for itself and 96 for six
  /// corners while they are sorted, as much for the same when they have been matched, and 96 more
  /// for corners that are sorted again where triangles are left out.
  [[nodiscard]] static std::uint64_t disk_of_vertex(bool has_nodata) noexcept {
    constexpr std::uint64_t kVertex = 40, kCorners = 96;
    return 2 * (kVertex + kCorners) + (has_nodata ? kCorners : 0);
  }

  [[nodiscard]] const PointStreamFacts& facts() const noexcept override { return facts_; }
  [[nodiscard]] bool next(std::vector<SourcePoint>& batch) override;
  [[nodiscard]] LeftOutPoints left_out() const noexcept override { return left_out_; }
  [[nodiscard]] SourceWarnings warnings() const override { return warnings_; }
  [[nodiscard]] std::uint64_t done() const noexcept override { return next_; }
  [[nodiscard]] std::uint64_t total() const noexcept override { return vertices_->size(); }

 private:
  PointStreamFacts facts_;
  std::optional<RecordFile<NamedVertex>> vertices_;  ///< On disk.
  std::uint64_t next_ = 0;
  LeftOutPoints left_out_;
  SourceWarnings warnings_;
};

}  // namespace ptin
