// SPDX-License-Identifier: GPL-3.0-or-later
//
// Matches the triangles of a file with its vertices, by the ids with which triangles name them. So
// it is known which of both belong to the terrain before the grid is chosen.
#pragma once

#include <array>
#include <compare>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <stop_token>
#include <string>
#include <utility>
#include <vector>

#include "engine/construct/grid/source_point.h"
#include "engine/construct/read/point_stream.h"
#include "engine/construct/read/tin_file.h"
#include "engine/construct/scratch/record_file.h"
#include "engine/construct/tin/tin_on_grid.h"
#include "engine/stop.h"
#include "storage/file/external_sorter.h"

namespace ptin {

/// Hands out, one after the other, records that come in batches.
template <class Record>
class InOrder {
 public:
  /// @param fill  Overwrites its argument with the next records; leaves none at the end.
  explicit InOrder(std::function<void(std::vector<Record>&)> fill) : fill_(std::move(fill)) {
    next();
  }
  /// The record at hand, valid until next(); null at the end.
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

/// The records of a sorter, in ascending order. The sorter must outlive the result.
template <class Record, class Before>
[[nodiscard]] InOrder<Record> in_order(ExternalSorter<Record, Before>& sorter,
                                       const std::stop_token& stop) {
  return InOrder<Record>(
      [&sorter, stop](std::vector<Record>& batch) { static_cast<void>(sorter.take(batch, stop)); });
}
/// The records of a file, in their order there. The file must outlive the result.
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

/// Adds the records of a sorter to a file, in ascending order, and finishes it.
template <class Record, class Before>
void write_in_order(ExternalSorter<Record, Before>& sorter, RecordFile<Record>& to,
                    const std::stop_token& stop) {
  sorter.merge(
      [&](std::span<const Record> batch) {
        for (const Record& record : batch) {
          to.add(record);
        }
      },
      stop);
  to.finish();
}

/// A vertex as the file has it, in 40 bytes.
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
  friend bool operator<(const NamedVertex& a, const NamedVertex& b) noexcept { return a.id < b.id; }
};

/// A corner of a face, which names its vertex.
struct NamedCorner {
  std::int64_t id = 0;      ///< The vertex's id.
  std::uint64_t place = 0;  ///< 4 f + c for corner c (0 to 3) of face f of the file.
  friend auto operator<=>(const NamedCorner&, const NamedCorner&) = default;
};

/// A file's terrain: triangles and quads whose corners all have a height, and the vertices that they
/// name. A quad three of whose corners have a height leaves the triangle of these.
struct NamedTin {
  RecordFile<NamedVertex> vertices;  ///< Ascending by id, each once.
  RecordFile<NamedCorner> corners;   ///< Ascending by id, then place; each id is in `vertices`.
  TinFileFacts facts;
  std::uint64_t left_out_triangles = 0;  ///< Those with a corner without a height.
  std::uint64_t unused_vertices = 0;     ///< Vertices that no triangle names, or only such ones.
};

/// Reads the file once.
/// @param memory  What one sorter may take; up to three sorters take as much at the same time.
///                reading.memory is not looked at.
/// @throws Error as read_on_grid() (tin/tin_on_grid.h)
/// Cost: O(n log n); the corners are sorted twice more where triangles are left out.
[[nodiscard]] NamedTin read_named_tin(const std::string& path, const TinGridReading& reading,
                                      const ExternalMemory& memory);

}  // namespace ptin
