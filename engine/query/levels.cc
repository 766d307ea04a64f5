// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/query/levels.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>

#include "engine/error.h"

namespace ptin {

namespace {

class CrossesLevel final : public AttributePredicate {
 public:
  explicit CrossesLevel(std::vector<double> codes) : codes_(std::move(codes)) {}
  [[nodiscard]] bool holds(const Attributes& a) const noexcept override {
    const auto above_lowest = std::upper_bound(codes_.begin(), codes_.end(), a.heights.lo);
    return above_lowest != codes_.end() && *above_lowest <= a.heights.hi;
  }

 private:
  std::vector<double> codes_;
};

/// The code of a level. Converting back and forth carries a few units of rounding of the offset and
/// the height, so an integer code that close is what was meant.
double code_of(double height, const HeightEncoding& encoding) {
  const double code = (height - encoding.offset) / encoding.step;
  const double nearest = std::nearbyint(code);
  const double rounding =
      8 * std::numeric_limits<double>::epsilon() * (std::abs(height) + std::abs(encoding.offset));
  const bool stored = encoding.type == HeightType::int32 &&
                      std::abs(encoding.height_of_code(nearest) - height) <= rounding;
  return stored ? nearest : code;
}

Error invalid(const std::string& message) { return Error(ErrorCode::invalid_argument, message); }

Error too_many() {
  return invalid("there are more than " + std::to_string(kMostLevels) +
                 " levels: ask for fewer, or a larger interval");
}

}  // namespace

LevelSet::LevelSet(const std::vector<double>& levels, const HeightEncoding& encoding) {
  if (levels.empty()) {
    throw invalid("no level is given: expected at least one height");
  }
  if (levels.size() > kMostLevels) {
    throw too_many();
  }
  std::vector<std::pair<double, double>> pairs;
  for (const double height : levels) {
    if (!std::isfinite(height)) {
      throw invalid("a level is not a finite number: expected heights in the height's unit");
    }
    pairs.emplace_back(code_of(height, encoding), height);
  }
  std::sort(pairs.begin(), pairs.end());
  for (const auto& [code, height] : pairs) {
    if (codes_.empty() || codes_.back() != code) {
      codes_.push_back(code);
      heights_.push_back(height);
    }
  }
}

std::uint32_t LevelSet::band_of(double code) const noexcept {
  return static_cast<std::uint32_t>(std::upper_bound(codes_.begin(), codes_.end(), code) -
                                    codes_.begin());
}

PredicatePtr LevelSet::crossing() const { return std::make_shared<CrossesLevel>(codes_); }

std::vector<double> levels_at(double interval, double base, double low, double high) {
  if (!(interval > 0) || !std::isfinite(interval) || !std::isfinite(base)) {
    throw invalid("the interval must be a number > 0 and the base a number");
  }
  const double first = std::ceil((low - base) / interval);
  const double last = std::floor((high - base) / interval);
  if (last - first >= static_cast<double>(kMostLevels)) {
    throw too_many();
  }
  std::vector<double> levels;
  for (double n = first; n <= last; ++n) {  // none when all is void: low > high
    levels.push_back(base + n * interval);
  }
  return levels;
}

}  // namespace ptin
