// SPDX-License-Identifier: GPL-3.0-or-later
#include "storage/directory_writer.h"

#include <algorithm>
#include <cstring>
#include <numeric>

#include "engine/check.h"
#include "storage/file/checksum.h"

namespace ptin {

namespace {

/// What is looked at of all pages before there are cells.
struct Overview {
  std::vector<GridPoint> points;               ///< Centres of the stars of every so manieth page.
  ShortBits least = kShortInfinity, most = 0;  ///< Range of largest errors but 0 and infinity.
};

Overview look_over(std::uint64_t pages, const PageWalk& walk) {
  constexpr std::uint64_t kMostPoints = std::uint64_t{1} << 18;
  const std::uint64_t step = (pages - 1) / kMostPoints + 1;
  Overview all;
  all.points.reserve(pages / step + 1);
  walk([&](std::uint64_t page, const layout::NodeEntry& d) {
    if (page % step == 0) {
      all.points.push_back({d.star_min_x + (d.star_max_x - d.star_min_x) / 2,
                            d.star_min_y + (d.star_max_y - d.star_min_y) / 2});
    }
    if (d.error_max != 0 && d.error_max != kShortInfinity) {
      all.least = std::min(all.least, d.error_max);
      all.most = std::max(all.most, d.error_max);
    }
  });
  return all;
}

std::uint64_t sum_of(std::span<const std::uint64_t> numbers) {
  return std::accumulate(numbers.begin(), numbers.end(), std::uint64_t{0});
}

}  // namespace

std::optional<DirectoryWriter> DirectoryWriter::plan(const GridBox& bounds, std::uint64_t pages,
                                                     std::uint32_t page_bytes,
                                                     const DirectoryOptions& options,
                                                     const PageWalk& walk) {
  if (pages == 0 || pages > UINT32_MAX) {
    return std::nullopt;
  }
  Overview all = look_over(pages, walk);
  const DirectoryScale scale = DirectoryScale::of(all.least, std::max(all.least, all.most));
  const std::uint64_t most =
      pages * page_bytes / options.page_bytes_of_byte / layout::kDirectoryEntryBytes;
  auto count = static_cast<std::uint32_t>(
      std::min<std::uint64_t>((pages - 1) / options.pages_of_cell + 1, options.most_cells));
  for (; count > 0; count /= 2) {
    DirectoryCells cells = make_cells(bounds, count, all.points);
    std::vector<std::uint64_t> entries = count_entries(cells, walk);
    if (sum_of(entries) <= most &&
        *std::max_element(entries.begin(), entries.end()) <= UINT16_MAX) {
      return DirectoryWriter(std::move(cells), std::move(entries), scale);
    }
  }
  return std::nullopt;
}

std::uint64_t DirectoryWriter::root_bytes() const noexcept {
  return sizeof(layout::DirectoryHead) + entries_.size() * layout::kDirectoryCellBytes;
}

std::uint64_t DirectoryWriter::node_bytes() const noexcept {
  return sum_of(entries_) * layout::kDirectoryEntryBytes;
}

std::uint64_t DirectoryWriter::write_nodes(const PageWalk& walk, ScratchFile& out,
                                           std::uint64_t offset) {
  RunningChecksum all;
  make_directory_nodes(cells_, entries_, scale_, walk,
                       [&](std::uint32_t, std::span<const std::byte> node) {
                         out.write_at(node, offset + all.bytes());
                         all.add(node);
                         checksums_.push_back(static_cast<std::uint32_t>(checksum_of(node)));
                       });
  PTIN_CHECK(all.bytes() == node_bytes());
  return all.value();
}

std::vector<std::byte> DirectoryWriter::root() const {
  PTIN_CHECK(checksums_.size() == entries_.size());
  const layout::DirectoryHead head{cells_.count(), scale_.least, scale_.step_shift,
                                   sum_of(entries_)};
  const std::vector<std::uint16_t> counts(entries_.begin(), entries_.end());
  std::vector<std::byte> bytes(root_bytes());
  std::byte* next = bytes.data();
  const auto put = [&](std::span<const std::byte> part) {
    std::memcpy(next, part.data(), part.size());
    next += part.size();
  };
  put(std::as_bytes(std::span(&head, 1)));
  put(std::as_bytes(std::span(checksums_)));
  put(std::as_bytes(cells_.lines()));
  put(std::as_bytes(std::span(counts)));
  return bytes;
}

}  // namespace ptin
