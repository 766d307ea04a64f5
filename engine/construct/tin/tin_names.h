// SPDX-License-Identifier: GPL-3.0-or-later
//
// Vertices and triangles of a file matched by the ids that triangles name vertices by: which of
// them belong to the terrain is known before the grid is chosen.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <stop_token>
#include <string>
#include <utility>
#include <vector>

#include "engine/construct/grid/source_point.h"
#include "engine/construct/read/point_stream.h"
#include "engine/construct/read/tin_soup.h"
#include "engine/construct/scratch/external_sorter.h"
#include "engine/construct/scratch/record_file.h"
#include "engine/construct/tin/tin_on_grid.h"
#include "engine/stop.h"

namespace ptin {

/// One record after the other of what comes in batches.
template <class Record>
class InOrder {
 public:
  /// @param fill  Overwrites its argument with the next records; leaves none at the end.
  explicit InOrder(std::function<void(std::vector<Record>&)> fill) : fill_(std::move(fill)) {
    next();
  }
  /// Null at the end. Valid until next().
  [[nodiscard]] const Record* now() const noexcept {
    return at_ < batch_.size() ? &batch_[at_] : nullptr;
  }
  void next() {
    if (++at_ >= batch_.size()) {
      at_ = 0;
      fill_(batch_);
    }
  }

 private:
  std::function<void(std::vector<Record>&)> fill_;
  std::vector<Record> batch_;
  std::size_t at_ = 0;
};

/// Of what is sorted; of a file. Both must outlive it.
template <class Record, class Before>
[[nodiscard]] InOrder<Record> in_order(ExternalSorter<Record, Before>& sorter,
                                       const std::stop_token& stop) {
  return InOrder<Record>(
      [&sorter, stop](std::vector<Record>& batch) { static_cast<void>(sorter.take(batch, stop)); });
}
template <class Record>
[[nodiscard]] InOrder<Record> in_order(const RecordFile<Record>& file,
                                       const std::stop_token& stop) {
  return InOrder<Record>(
      [&file, stop, next = std::uint64_t{0}](std::vector<Record>& batch) mutable {
        stop_if_asked(stop, "reading temporary files");
        const auto count = std::min<std::uint64_t>(1 << 13, file.size() - next);
        file.take(next, count, batch);
        next += count;
      });
}

/// A vertex as the file has it.
struct NamedVertex {
  std::int64_t id = 0;
  std::array<std::int64_t, 3> mantissa{};
  std::array<std::int8_t, 3> decimals{};

  NamedVertex() = default;
  NamedVertex(std::int64_t number, const SourcePoint& p)
      : id(number),
        mantissa{p.x.mantissa, p.y.mantissa, p.z.mantissa},
        decimals{static_cast<std::int8_t>(p.x.decimals), static_cast<std::int8_t>(p.y.decimals),
                 static_cast<std::int8_t>(p.z.decimals)} {}
  [[nodiscard]] SourcePoint point() const noexcept {
    return {{mantissa[0], decimals[0]}, {mantissa[1], decimals[1]}, {mantissa[2], decimals[2]}};
  }
};

/// A corner of a triangle by the id of its vertex.
struct NamedCorner {
  std::int64_t id = 0;
  std::uint64_t place = 0;  ///< Four times the triangle's number, and which corner it is.
};

/// A file's terrain: triangles whose corners all have a height, and the vertices that they name.
struct NamedTin {
  RecordFile<NamedVertex> vertices;  ///< Ascending by id, each once.
  RecordFile<NamedCorner> corners;   ///< Likewise; the id of each is among `vertices`.
  TinFileFacts facts;
  std::uint64_t left_out_triangles = 0;  ///< A corner has no height.
  std::uint64_t unused_vertices = 0;
};

/// Reads the file once.
/// @param memory  Of one sorter; three hold it at the same time.
/// @throws Error as read_on_grid()
/// Cost: O(n log n); the corners are sorted twice more where triangles are left out.
[[nodiscard]] NamedTin read_named_tin(const std::string& path, const TinGridReading& reading,
                                      const ExternalMemory& memory);

}  // namespace ptin
