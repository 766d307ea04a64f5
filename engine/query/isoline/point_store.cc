// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/query/isoline/point_store.h"

#include <algorithm>
#include <utility>

#include "engine/error.h"

namespace ptin {

PointStore::PointStore(std::uint64_t budget_bytes, std::string temporary_folder, FileLayer& files)
    : most_points_(std::max<std::uint64_t>(budget_bytes / sizeof(MapPoint), 1)),
      block_points_(std::clamp<std::uint64_t>(most_points_ / 4, 1, 65536)),
      folder_(std::move(temporary_folder)),
      files_(&files) {}

void PointStore::add(std::span<const MapPoint> points) {
  while (!points.empty()) {
    if (size_ - spilled_ == most_points_) {
      spill();
    }
    const std::uint64_t kept = size_ - spilled_;
    const std::uint64_t at = kept % block_points_;
    const std::uint64_t room = std::min(block_points_ - at, most_points_ - kept);
    if (at == 0) {
      blocks_.push_back(std::make_unique_for_overwrite<MapPoint[]>(room));
    }
    const std::size_t n = std::min<std::size_t>(points.size(), room);
    std::copy_n(points.begin(), n, blocks_.back().get() + at);
    size_ += n;
    points = points.subspan(n);
  }
}

/// Writes what is in memory behind what is in the file.
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
    const std::uint64_t n = std::min(block_points_, size_ - spilled_);
    file_->write_at(std::as_bytes(std::span(block.get(), n)), spilled_ * sizeof(MapPoint));
    spilled_ += n;
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
