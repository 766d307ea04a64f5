// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/query/isoline/point_store.h"

#include <algorithm>
#include <utility>

#include "engine/error.h"

namespace ptin {

PointStore::PointStore(std::uint64_t budget_bytes, std::string temporary_folder, FileLayer& files)
    : block_points_(std::clamp<std::uint64_t>(budget_bytes / (4 * sizeof(MapPoint)), 1, 65536)),
      most_blocks_(std::max<std::uint64_t>(budget_bytes / sizeof(MapPoint) / block_points_, 1)),
      folder_(std::move(temporary_folder)),
      files_(&files) {}

void PointStore::add(std::span<const MapPoint> points) {
  while (!points.empty()) {
    const std::uint64_t at = (size_ - spilled_) % block_points_;
    if (at == 0) {
      add_block();
    }
    const std::size_t n = std::min<std::size_t>(points.size(), block_points_ - at);
    std::copy_n(points.begin(), n, blocks_.back().get() + at);
    size_ += n;
    points = points.subspan(n);
  }
}

void PointStore::add_block() {
  if (blocks_.size() == most_blocks_) {
    spill();
  }
  blocks_.push_back(std::make_unique_for_overwrite<MapPoint[]>(block_points_));
}

/// Writes all blocks, which are full, behind what is in the file.
void PointStore::spill() {
  if (folder_.empty()) {
    throw Error(ErrorCode::resource_exhausted,
                "the isolines need more memory than they were given, and no folder for temporary "
                "files: ask for fewer levels or a smaller window, or give more memory");
  }
  if (!file_) {
    file_ = std::make_unique<ScratchFile>(*files_, folder_, "ptin-isolines", true);
  }
  for (const std::unique_ptr<MapPoint[]>& block : blocks_) {
    file_->write_at(std::as_bytes(std::span(block.get(), block_points_)),
                    spilled_ * sizeof(MapPoint));
    spilled_ += block_points_;
  }
  blocks_.clear();
}

void PointStore::read(std::uint64_t first, std::size_t count, std::vector<MapPoint>& out) const {
  const std::uint64_t from_file =
      first < spilled_ ? std::min<std::uint64_t>(count, spilled_ - first) : 0;
  const std::size_t at = out.size();
  out.resize(at + count);
  if (from_file > 0) {
    file_->read_at(std::as_writable_bytes(std::span(out).subspan(at, from_file)),
                   first * sizeof(MapPoint));
  }
  for (std::uint64_t done = from_file; done < count;) {
    const std::uint64_t place = first + done - spilled_;
    const std::uint64_t n = std::min(count - done, block_points_ - place % block_points_);
    std::copy_n(blocks_[place / block_points_].get() + place % block_points_, n,
                out.data() + at + done);
    done += n;
  }
}

}  // namespace ptin
