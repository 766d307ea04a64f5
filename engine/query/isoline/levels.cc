// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/query/isoline/levels.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <string>
#include <utility>

#include "engine/error.h"
#include "storage/page_columns.h"

namespace ptin {

namespace {

constexpr double kMostSteps = 9007199254740992.0;  // 2^53: from there on n + 1 may be n

class CrossesLevel final : public AttributePredicate {
 public:
  explicit CrossesLevel(std::shared_ptr<const Ladder> codes) : codes_(std::move(codes)) {}
  [[nodiscard]] bool holds(const Attributes& a) const noexcept override {
    const std::uint32_t above_lowest = codes_->at_or_below(a.heights.lo);
    return above_lowest < codes_->steps().size() && codes_->steps()[above_lowest] <= a.heights.hi;
  }

 private:
  std::shared_ptr<const Ladder> codes_;
};

/// The code of a level. Where an integer code lies within a few units of rounding of the level, as
/// many as converting back and forth carries, that code is what was meant.
double code_of(double height, const HeightEncoding& encoding) {
  const double code = (height - encoding.offset) / encoding.step;
  const double nearest = std::nearbyint(code);
  const double rounding =
      8 * std::numeric_limits<double>::epsilon() * (std::abs(height) + std::abs(encoding.offset));
  const bool stored = encoding.type == HeightType::int32 &&
                      std::abs(encoding.height_of_code(nearest) - height) <= rounding;
  return stored ? nearest : code;
}

/// The least ordered height whose code is at least `code`; 2^32 where there is none.
std::uint64_t least_ordered_at(double code, HeightType type) {
  constexpr std::uint64_t kNoHeight = std::uint64_t{1} << 32;
  if (type == HeightType::int32) {
    const double whole = std::ceil(code);
    if (whole > std::numeric_limits<std::int32_t>::max()) {
      return kNoHeight;
    }
    const double least = std::numeric_limits<std::int32_t>::min();
    const auto height = static_cast<std::int32_t>(std::max(whole, least));
    return ordered_height(std::bit_cast<HeightBits>(height), type);
  }
  constexpr float kMost = std::numeric_limits<float>::max();
  if (code > static_cast<double>(kMost)) {
    return kNoHeight;
  }
  auto height = static_cast<float>(std::max(code, -static_cast<double>(kMost)));
  if (static_cast<double>(height) < code) {
    height = std::nextafter(height, kMost);
  }
  return ordered_height(std::bit_cast<HeightBits>(height), type);
}

[[noreturn]] void refuse_more_levels() {
  refuse("there are more than " + std::to_string(kMostLevels) +
         " levels: ask for fewer, or a larger interval");
}

}  // namespace

Ladder::Ladder(std::vector<double> steps) : steps_(std::move(steps)) {
  const double width = steps_.back() - steps_.front();
  const std::size_t slots = 8 * steps_.size();
  const double per_slot = static_cast<double>(slots) / width;
  per_slot_ = std::isfinite(per_slot) ? per_slot : 0;  // one step, or steps that almost touch
  first_.resize(slots + 1);
  for (std::size_t s = 0, i = 0; s < first_.size(); ++s) {
    while (i < steps_.size() && slot(steps_[i]) < s) {
      ++i;
    }
    first_[s] = static_cast<std::uint32_t>(i);
  }
}

LevelSet::LevelSet(const std::vector<double>& levels, const HeightEncoding& encoding) {
  if (levels.empty()) {
    refuse("no level is given: expected at least one height");
  }
  if (levels.size() > kMostLevels) {
    refuse_more_levels();
  }
  std::vector<std::pair<double, double>> pairs;
  for (const double height : levels) {
    if (!std::isfinite(height)) {
      refuse("a level is not a finite number: expected heights in the height's unit");
    }
    pairs.emplace_back(code_of(height, encoding), height);
  }
  std::sort(pairs.begin(), pairs.end());
  std::vector<double> codes;
  for (const auto& [code, height] : pairs) {
    if (codes.empty() || codes.back() != code) {
      codes.push_back(code);
      heights_.push_back(height);
      least_above_.push_back(least_ordered_at(code, encoding.type));
    }
  }
  codes_ = std::make_shared<const Ladder>(std::move(codes));
}

PredicatePtr LevelSet::crossing() const { return std::make_shared<CrossesLevel>(codes_); }

std::vector<double> levels_at(double interval, double base, double low, double high) {
  if (!(interval > 0) || !std::isfinite(interval) || !std::isfinite(base)) {
    refuse("the interval must be a number > 0 and the base a number");
  }
  if (low > high) {
    return {};  // all is void
  }
  const double first = std::ceil((low - base) / interval);
  const double last = std::floor((high - base) / interval);
  if (!(std::abs(first) <= kMostSteps) || !(std::abs(last) <= kMostSteps)) {
    refuse(
        "the heights lie more than 2^53 intervals from the base: give a larger interval, or a base "
        "nearer to the heights");
  }
  if (last - first >= static_cast<double>(kMostLevels)) {
    refuse_more_levels();
  }
  const auto count = static_cast<std::int64_t>(last - first) + 1;
  std::vector<double> levels;
  for (std::int64_t n = 0; n < count; ++n) {
    levels.push_back(base + (first + static_cast<double>(n)) * interval);
  }
  return levels;
}

}  // namespace ptin
