// SPDX-License-Identifier: GPL-3.0-or-later
//
// The vertices of a TIN as points: what --repair triangulates anew, and what is verified against.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "engine/construct/grid/source_options.h"
#include "engine/construct/grid/source_point.h"
#include "engine/construct/read/point_stream.h"

namespace ptin {

/// The vertices of a TIN's triangles, on the digits that TinTriangles keeps, in the order of their
/// ids. Of any number: vertices find their triangles by sorting on disk.
class TinVertices final : public PointStream {
 public:
  /// Reads the file once.
  /// @param nodata     Triangles with a corner of this height are left out.
  /// @param resources  Without memory: 64 MiB, and temporary files where the system has its own.
  /// @throws Error as read_tin_file(); invalid_argument  an id that no vertex has, or that two
  ///               have; no triangle has a height; io_error, resource_exhausted, cancelled
  TinVertices(const std::string& path, const PointChoice& choice, std::optional<double> nodata = {},
              const StreamResources& resources = {});
  ~TinVertices() override;

  /// What that takes of the disk at most, bytes a vertex: 40 and six corners of 16 while they are
  /// sorted, the same when they have been matched; corners again where triangles are left out.
  [[nodiscard]] static std::uint64_t disk_of_vertex(bool has_nodata) noexcept {
    constexpr std::uint64_t kVertex = 40, kCorners = 96;
    return 2 * (kVertex + kCorners) + (has_nodata ? kCorners : 0);
  }

  [[nodiscard]] const PointStreamFacts& facts() const noexcept override { return facts_; }
  [[nodiscard]] bool next(std::vector<SourcePoint>& batch) override;
  [[nodiscard]] std::uint64_t left_out() const noexcept override { return left_out_; }
  [[nodiscard]] double largest_shift() const noexcept override { return largest_shift_; }
  [[nodiscard]] std::uint64_t done() const noexcept override { return next_; }
  [[nodiscard]] std::uint64_t total() const noexcept override;

 private:
  class Vertices;  ///< On disk.
  PointStreamFacts facts_;
  std::unique_ptr<const Vertices> vertices_;
  int decimals_ = 0;
  double largest_shift_ = 0.0;
  std::uint64_t next_ = 0;
  std::uint64_t left_out_ = 0;
};

}  // namespace ptin
