// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/query/isoline_pieces.h"

#include <algorithm>
#include <cerrno>
#include <tuple>
#include <utility>

#include <fcntl.h>
#include <unistd.h>

#include "engine/error.h"

namespace ptin {

namespace {

/// A file in `folder` that has no name any more.
int nameless_file(const std::string& folder) {
  const int file = open(folder.c_str(), O_TMPFILE | O_RDWR | O_CLOEXEC, 0600);
  if (file >= 0) {
    return file;
  }
  std::string name = folder + "/.ptin-isolines-XXXXXX";  // a file system without O_TMPFILE
  const int named = mkostemp(name.data(), O_CLOEXEC);
  if (named < 0) {
    throw system_error(errno, "cannot create a temporary file", folder);
  }
  unlink(name.c_str());
  return named;
}

}  // namespace

PointStore::PointStore(std::uint64_t budget_bytes, std::string temporary_folder)
    : block_points_(std::clamp<std::uint64_t>(budget_bytes / (4 * sizeof(MapPoint)), 1, 65536)),
      most_blocks_(std::max<std::uint64_t>(budget_bytes / sizeof(MapPoint) / block_points_, 1)),
      folder_(std::move(temporary_folder)) {}

PointStore::PointStore(PointStore&& other) noexcept
    : block_points_(other.block_points_),
      most_blocks_(other.most_blocks_),
      folder_(std::move(other.folder_)),
      blocks_(std::move(other.blocks_)),
      size_(std::exchange(other.size_, 0)),
      spilled_(std::exchange(other.spilled_, 0)),
      file_(std::exchange(other.file_, -1)) {}

PointStore& PointStore::operator=(PointStore&& other) noexcept {
  std::swap(block_points_, other.block_points_);
  std::swap(most_blocks_, other.most_blocks_);
  std::swap(folder_, other.folder_);
  std::swap(blocks_, other.blocks_);
  std::swap(size_, other.size_);
  std::swap(spilled_, other.spilled_);
  std::swap(file_, other.file_);
  return *this;
}

PointStore::~PointStore() {
  if (file_ >= 0) {
    close(file_);
  }
}

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
  if (file_ < 0) {
    file_ = nameless_file(folder_);
  }
  for (const std::unique_ptr<MapPoint[]>& block : blocks_) {
    const char* at = reinterpret_cast<const char*>(block.get());
    std::size_t left = block_points_ * sizeof(MapPoint);
    auto offset = static_cast<off_t>(spilled_ * sizeof(MapPoint));
    while (left > 0) {
      const ssize_t n = pwrite(file_, at, left, offset);
      if (n < 0 && errno == EINTR) {
        continue;
      }
      if (n < 0) {
        throw system_error(errno, "cannot write temporary isolines", folder_);
      }
      at += n, offset += n, left -= static_cast<std::size_t>(n);
    }
    spilled_ += block_points_;
  }
  blocks_.clear();
}

void PointStore::read(std::uint64_t first, std::size_t count, std::vector<MapPoint>& out) const {
  const std::uint64_t from_file =
      first < spilled_ ? std::min<std::uint64_t>(count, spilled_ - first) : 0;
  const std::size_t at = out.size();
  out.resize(at + count);
  auto* to = reinterpret_cast<char*>(out.data() + at);
  auto offset = static_cast<off_t>(first * sizeof(MapPoint));
  for (std::size_t left = from_file * sizeof(MapPoint); left > 0;) {
    const ssize_t n = pread(file_, to, left, offset);
    if (n < 0 && errno == EINTR) {
      continue;
    }
    if (n <= 0) {
      throw system_error(n < 0 ? errno : EIO, "cannot read temporary isolines", folder_);
    }
    to += n, offset += n, left -= static_cast<std::size_t>(n);
  }
  for (std::uint64_t done = from_file; done < count;) {
    const std::uint64_t place = first + done - spilled_;
    const std::uint64_t n = std::min(count - done, block_points_ - place % block_points_);
    std::copy_n(blocks_[place / block_points_].get() + place % block_points_, n,
                out.data() + at + done);
    done += n;
  }
}

namespace {

using Begin = std::tuple<std::uint32_t, CutEdge, std::uint32_t>;  // level, edge, piece

class Joiner {
 public:
  Joiner(std::span<const IsolinePiece> pieces, const QueryContext& context)
      : pieces_(pieces), context_(context), next_(pieces.size(), kNone), taken_(pieces.size()) {
    find_successors();
  }

  JoinedLines run() {
    std::vector<std::uint8_t> has_previous(pieces_.size());
    for (const std::uint32_t n : next_) {
      if (n != kNone) {
        has_previous[n] = 1;
      }
    }
    for (std::uint32_t i = 0; i < pieces_.size(); ++i) {
      if (has_previous[i] == 0) {
        take_from(i);
      }
    }
    for (std::uint32_t i = 0; i < pieces_.size(); ++i) {
      if (taken_[i] == 0) {
        take_from(i);  // a ring of several pieces
      }
    }
    std::sort(joined_.lines.begin(), joined_.lines.end(),
              [](const JoinedLine& a, const JoinedLine& b) {
                return std::tie(a.level, a.smallest) < std::tie(b.level, b.smallest);
              });
    return std::move(joined_);
  }

 private:
  void find_successors() {
    std::vector<Begin> begins;
    for (std::uint32_t i = 0; i < pieces_.size(); ++i) {
      if (!pieces_[i].ring) {
        begins.emplace_back(pieces_[i].level, pieces_[i].begin, i);
      }
    }
    std::sort(begins.begin(), begins.end());
    for (std::uint32_t i = 0; i < pieces_.size(); ++i) {
      if (i % kStopInterval == 0) {
        context_.check_stop();
      }
      if (pieces_[i].ring) {
        continue;
      }
      const Begin wanted{pieces_[i].level, pieces_[i].end, 0};
      const auto found = std::lower_bound(begins.begin(), begins.end(), wanted);
      if (found != begins.end() && std::get<0>(*found) == pieces_[i].level &&
          std::get<1>(*found) == pieces_[i].end) {
        next_[i] = std::get<2>(*found);
      }
    }
  }

  void take_from(std::uint32_t start) {
    JoinedLine line{pieces_[start].level, pieces_[start].ring, pieces_[start].smallest,
                    joined_.order.size(), 0};
    std::uint32_t i = start;
    std::size_t smallest_place = joined_.order.size();
    do {
      taken_[i] = 1;
      if (pieces_[i].smallest < line.smallest) {
        line.smallest = pieces_[i].smallest;
        smallest_place = joined_.order.size();
      }
      joined_.order.push_back(i);
      ++line.pieces;
      i = next_[i];
    } while (i != kNone && i != start);
    if (i == start) {  // closed: it begins with the piece that holds its smallest edge
      line.ring = true;
      const auto first = joined_.order.begin() + static_cast<std::ptrdiff_t>(line.first_piece);
      std::rotate(first, joined_.order.begin() + static_cast<std::ptrdiff_t>(smallest_place),
                  joined_.order.end());
    }
    joined_.lines.push_back(line);
  }

  std::span<const IsolinePiece> pieces_;
  const QueryContext& context_;
  std::vector<std::uint32_t> next_;
  std::vector<std::uint8_t> taken_;
  JoinedLines joined_;
};

}  // namespace

JoinedLines join_pieces(std::span<const IsolinePiece> pieces, const QueryContext& context) {
  return Joiner(pieces, context).run();
}

void points_of(const JoinedLine& line, const JoinedLines& joined,
               std::span<const IsolinePiece> pieces, const PointStore& store,
               std::vector<MapPoint>& out) {
  out.clear();
  for (std::uint32_t k = 0; k < line.pieces; ++k) {
    const IsolinePiece& piece = pieces[joined.order[line.first_piece + k]];
    const std::size_t before = out.size();
    store.read(piece.first, piece.count, out);
    if (before > 0 && out[before] == out[before - 1]) {
      out.erase(out.begin() + static_cast<std::ptrdiff_t>(before));
    }
  }
  if (line.ring && line.pieces > 0 && out.size() > 1) {
    const IsolinePiece& piece = pieces[joined.order[line.first_piece]];
    if (!piece.ring) {  // several pieces: begin on the smallest edge
      out.pop_back();
      const std::size_t at = piece.smallest_at < out.size() ? piece.smallest_at : 0;
      std::rotate(out.begin(), out.begin() + static_cast<std::ptrdiff_t>(at), out.end());
      out.push_back(out.front());
    }
  }
  if (out.size() < 2) {
    out.clear();
  }
}

void drop_single_points(JoinedLines& joined, std::span<const IsolinePiece> pieces,
                        const PointStore& store) {
  std::vector<MapPoint> points;
  std::erase_if(joined.lines, [&](const JoinedLine& line) {
    for (std::uint32_t k = 0; k < line.pieces; ++k) {
      if (pieces[joined.order[line.first_piece + k]].count > 1) {
        return false;  // its points differ in a row
      }
    }
    points_of(line, joined, pieces, store, points);
    return points.empty();
  });
}

}  // namespace ptin
