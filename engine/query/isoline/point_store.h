// SPDX-License-Identifier: GPL-3.0-or-later
//
// Points of lines while the lines are made: in memory as far as they fit, then on disk.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "engine/geometry/affine.h"
#include "storage/file/file_layer.h"

namespace ptin {

/// Points in the order in which they were added: in memory up to a budget, then in a file without a
/// name. A store that was moved from can only be assigned to or destroyed. Threads: none; one
/// owner.
class PointStore {
 public:
  /// @param budget_bytes      Bytes of points kept in memory, in blocks of at most a megabyte. All of
  ///                          them are used; one point fits any budget.
  /// @param temporary_folder  Where the file is made when the points do not fit; empty: no file.
  /// @param files             Borrowed for the life of the store.
  PointStore(std::uint64_t budget_bytes, std::string temporary_folder,
             FileLayer& files = FileLayer::system());

  [[nodiscard]] std::uint64_t size() const noexcept { return size_; }
  /// Appends points.
  /// @throws Error resource_exhausted  over the budget and no folder, or the disk is full
  ///               not_found           there is no such folder
  ///               io_error
  void add(std::span<const MapPoint> points);
  /// Appends points [first, first + count) to `out`.  @throws Error io_error
  void read(std::uint64_t first, std::size_t count, std::vector<MapPoint>& out) const;

 private:
  void spill();

  std::uint64_t most_points_;   ///< Points in memory at most.
  std::uint64_t block_points_;  ///< Points in a block; fewer in the last one that fits.
  std::string folder_;
  FileLayer* files_;
  std::vector<std::unique_ptr<MapPoint[]>> blocks_;  ///< The last points, in order.
  std::uint64_t size_ = 0;
  std::uint64_t spilled_ = 0;          ///< Points in the file, before those in memory.
  std::unique_ptr<ScratchFile> file_;  ///< Made when it is needed.
};

}  // namespace ptin
