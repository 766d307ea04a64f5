// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/query/isoline/isoline_pieces.h"

#include <algorithm>
#include <tuple>
#include <utility>

namespace ptin {

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
        return false;  // the points of one piece differ in a row, so the line has two
      }
    }
    points_of(line, joined, pieces, store, points);
    return points.empty();
  });
}

}  // namespace ptin
