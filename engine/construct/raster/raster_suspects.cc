// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/raster/raster_suspects.h"

#include <algorithm>
#include <cmath>

namespace ptin {
namespace {

/// No height is as large as this.
constexpr double kAlwaysSuspect = 1e15;
/// All but the huge ones, which are two kinds more.
constexpr std::array<double, RasterSuspects::kKinds - 2> kValues = {
    -9999,         -99999,        -999999,      -32768, -32767, 32767,
    -2147483648.0, -2147483647.0, 2147483647.0, 9999,   99999};
/// The value nearest to the others that is looked for.
constexpr double kLeast = 9999.0;
/// How far apart a value lies, as a share of the range of all others.
constexpr double kApart = 0.01;

}  // namespace

bool RasterSuspects::may_hold_some(double low, double high) noexcept {
  return low <= -kLeast || high >= kLeast;
}

std::optional<std::size_t> RasterSuspects::kind_of(double value) noexcept {
  if (std::abs(value) < kLeast) {
    return std::nullopt;
  }
  if (std::abs(value) >= kAlwaysSuspect) {
    return value < 0 ? kValues.size() : kValues.size() + 1;
  }
  const auto* const found = std::find(kValues.begin(), kValues.end(), value);
  return found == kValues.end() ? std::nullopt
                                : std::optional(static_cast<std::size_t>(found - kValues.begin()));
}

void RasterSuspects::add_others(double low, double high) noexcept {
  low_ = std::min(low_, low);
  high_ = std::max(high_, high);
}

void RasterSuspects::add(double value, std::uint64_t place) {
  const std::optional<std::size_t> kind = kind_of(value);
  if (!kind) {
    add_others(value, value);
    return;
  }
  Suspect& suspect = kinds_[*kind];
  ++suspect.count;
  if (place < suspect.first) {
    suspect.first = place;
    suspect.value = value;
  }
}

void RasterSuspects::join(const RasterSuspects& other) {
  add_others(other.low_, other.high_);
  for (std::size_t i = 0; i < kKinds; ++i) {
    Suspect& suspect = kinds_[i];
    suspect.count += other.kinds_[i].count;
    if (other.kinds_[i].first < suspect.first) {
      suspect.first = other.kinds_[i].first;
      suspect.value = other.kinds_[i].value;
    }
  }
}

std::vector<RasterSuspects::Suspect> RasterSuspects::apart() const {
  std::vector<Suspect> all;
  const double range = high_ - low_;
  for (const Suspect& suspect : kinds_) {
    const double gap = std::max(low_ - suspect.value, suspect.value - high_);
    if (suspect.count > 0 && (range < 0 || gap > kApart * range)) {
      all.push_back(suspect);
    }
  }
  return all;
}

}  // namespace ptin
