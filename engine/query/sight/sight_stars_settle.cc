// SPDX-License-Identifier: GPL-3.0-or-later
//
// What a search by stars leaves open, and the points of the full TIN that settle it.
#include <algorithm>
#include <cstddef>
#include <utility>
#include <vector>

#include "engine/geometry/infinity.h"
#include "engine/query/sight/sight_stars.h"

namespace ptin {

/// Where the full TIN may have a void in the place of a piece that hides the line, or of the one
/// point in which the line meets the domain: looks at the full TIN there, at the point that is most
/// likely to hide the line first.
void SightStars::settle() {
  if (!facts_.has_voids || facts_.final_settles || !facts_.exact_settles) {
    return;
  }
  std::vector<std::pair<double, double>> likely;
  for (const SightPiece& p : line_.pieces) {
    // Ground that rises above the line by more than the deviation hides it, unless it is a void.
    if (p.verdict == PieceVerdict::kUndecided && p.surface && p.guess < -p.deviation) {
      likely.emplace_back(p.guess, p.guess_at);
    }
  }
  std::sort(likely.begin(), likely.end());
  if (line_.pieces.empty() && open_touch_) {
    likely.emplace_back(0.0, *open_touch_);
  }
  for (const auto& [guess, share] : likely) {
    if (first_hidden_ <= 1.0 || out_of_budget()) {
      return;
    }
    look_at_full(Aim::kWhole, share);
    if (!is_cut_) {
      open_touch_.reset();
    }
  }
}

/// Where the budget ends the search, a void along an edge may have surface on its other side that
/// was not read: it is forgotten.
void SightStars::look_at_full(Aim aim, double share) {
  const std::size_t before = line_.pieces.size();
  search(aim, {share, share}, full_);
  if (!is_cut_) {
    settled_.push_back(share);
    return;
  }
  // Only what this search has read is in doubt.
  const auto read = line_.pieces.begin() + static_cast<std::ptrdiff_t>(before);
  line_.pieces.erase(std::remove_if(read, line_.pieces.end(),
                                    [](const SightPiece& p) { return p.along_edge && !p.surface; }),
                     line_.pieces.end());
}

/// Where a void of the full TIN ends, a vertex may lie below the line of which all surface triangles
/// lie beside the line: looks for these.
void SightStars::settle_touches() {
  for (auto share = unsettled_touch(); share; share = unsettled_touch()) {
    // A look that the budget cuts settles nothing; then the budget is spent, and the next turn says
    // so. So each turn but one settles a share, and the loop ends.
    if (out_of_budget()) {
      line_.take_open_touch(*share);
      settled_.push_back(*share);
    } else {
      look_at_full(Aim::kTouch, *share);
    }
  }
}

std::optional<double> SightStars::unsettled_touch() const {
  if (facts_.final_settles || !facts_.exact_settles) {
    return std::nullopt;
  }
  for (const SightPiece& p : line_.pieces) {
    for (const double share : {p.from, p.to}) {
      if (p.exact && !p.surface &&
          std::find(settled_.begin(), settled_.end(), share) == settled_.end()) {
        return share;
      }
    }
  }
  return std::nullopt;
}

void SightStars::order() {
  line_.order_pieces();
  if (facts_.is_level_asked) {
    line_.prefer_exact();
    line_.order_pieces();
  }
}

/// Looks at the full TIN in a few points: by turns where the clearance seems to be smallest, which it
/// is no larger than there, and where the level leaves room for the smallest one. So the bounds of the
/// clearance come close to each other, and a verdict is seldom open.
void SightStars::narrow() {
  constexpr int kMostLooks = 8;
  for (int i = 0; i < kMostLooks && !out_of_budget(); ++i) {
    const SightPiece* piece = wide_piece(i % 2 == 0);
    if (piece == nullptr) {
      return;
    }
    // The point that is likely to be lowest may lower the upper bound of the clearance, the one
    // with most room below it may raise the lower bound: taken by turns, both come closer.
    look_at_full(Aim::kWhole, piece->guess_at);
    order();
  }
}

/// The piece of the level by which the answer is most open; null when it is not.
/// @param by_guess  True: the smallest clearance as it is decides, else the smallest bound.
const SightPiece* SightStars::wide_piece(bool by_guess) const {
  double most = kInfinity;
  for (const SightPiece& p : line_.pieces) {
    most = std::min(most, p.most);
  }
  // One hidden piece is the verdict, whatever else is open.
  if (request_.verdict_only && line_.hidden_piece() != nullptr) {
    return nullptr;
  }
  const SightPiece* widest = nullptr;
  for (const SightPiece& p : line_.pieces) {
    const bool is_open =
        request_.verdict_only ? p.verdict == PieceVerdict::kUndecided : p.least < most;
    if (is_open && p.surface && p.final && !p.exact && !is_final_truth(p) &&
        (widest == nullptr || (by_guess ? p.guess < widest->guess : p.least < widest->least))) {
      widest = &p;
    }
  }
  return widest;
}

SightVerdict SightStars::decide() {
  if (request_.verdict_only) {
    decide_by_search();
  }
  settle();
  order();
  if (facts_.is_level_asked) {
    narrow();
  }
  settle_touches();
  // One certain obstruction outweighs all that is undecided.
  if (line_.hidden_piece() != nullptr || line_.is_touched_from_below()) {
    return SightVerdict::kHidden;
  }
  const bool is_open =
      (line_.pieces.empty() && open_touch_) || line_.may_be_touched_from_below() ||
      std::any_of(line_.pieces.begin(), line_.pieces.end(),
                  [](const SightPiece& p) { return p.verdict == PieceVerdict::kUndecided; });
  return is_open ? SightVerdict::kUndecided : SightVerdict::kVisible;
}

}  // namespace ptin
