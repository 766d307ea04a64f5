// SPDX-License-Identifier: GPL-3.0-or-later
//
// The transform is that of Meijster, Roerdink and Hesselink ("A general algorithm for computing
// distance transforms in linear time", 2000): distances along columns first, then along each row
// the lower envelope of the parabolas that they define. It suits rows with steps of their own,
// since the second pass stays inside a row; and both classes at once, since a run of one class in a
// row ends at samples of the other.
#include "engine/construct/raster/void_depth.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <vector>

#include "engine/error.h"

namespace ptin {
namespace {

constexpr float kInfinite = std::numeric_limits<float>::infinity();
constexpr int kLargestCutOff = 4096;
constexpr double kLargestRatio = 64.0;

/// Squared steps as integers, in units of the smaller squared step / 2^24.
///
/// Bounds: weights are at most 64^2 * 2^24 = 2^36; a candidate less than 2 * 4096 + 2 columns and
/// at most 4096 rows away is at most 2^36 * (2^26.001 + 2^24) < 2^63 away, squared.
struct RowWeights {
  static constexpr std::int64_t kOne = std::int64_t{1} << 24;
  std::int64_t x = kOne;
  std::int64_t y = kOne;
  std::int64_t limit = 0;  ///< Largest finite squared distance.
  double step = 1.0;       ///< The smaller step, in ground units.
};

RowWeights weigh(GroundStep step, int cut_off) {
  const double larger = std::max(step.x, step.y);
  if (!(std::isfinite(larger) && larger > 0 && step.x >= 0 && step.y >= 0)) {
    throw Error(ErrorCode::invalid_argument, "steps on the ground must be finite and positive");
  }
  const double smaller = std::max(std::min(step.x, step.y), larger / kLargestRatio);
  const double ratio = larger / smaller;
  const std::int64_t weight = std::llround(ratio * ratio * static_cast<double>(RowWeights::kOne));
  RowWeights weights;
  (step.x > step.y ? weights.x : weights.y) = weight;
  weights.limit = std::int64_t{cut_off} * cut_off * RowWeights::kOne;
  weights.step = smaller;
  return weights;
}

/// One row of the mask and, for each of its samples, the rows to the nearest sample of the other
/// class in its column; cut_off + 1 or more when there is none.
struct Row {
  const std::uint8_t* valid;
  const std::uint16_t* rows_away;
  std::int64_t width;
};

/// Finds the depths of one row. Keeps its arrays from row to row.
class RowTransform {
 public:
  RowTransform(const MaskWindow& mask, int cut_off) : mask_(mask), cut_off_(cut_off) {
    candidates_.reserve(static_cast<std::size_t>(mask.width) + 2);
  }

  void run(const Row& row, const RowWeights& weights, float* depth) {
    std::fill(depth, depth + mask_.inner_width, kInfinite);
    if (is_far_from_the_other_class(row)) {
      return;
    }
    const std::int64_t inner_end = mask_.inner_x + mask_.inner_width;
    for (std::int64_t first = 0; first < inner_end;) {
      std::int64_t end = first + 1;
      while (end < row.width && (row.valid[end] != 0) == (row.valid[first] != 0)) {
        ++end;
      }
      if (end > mask_.inner_x) {
        transform_run(row, weights, first, end, depth);
      }
      first = end;
    }
  }

 private:
  /// A sample of the other class that may be the nearest to samples of a run: one beside the run,
  /// or the nearest in a column of the run. Its column, its squared distance from the row along the
  /// column, and the first column of the row to which it is the nearest candidate.
  struct Candidate {
    std::int64_t column;
    std::int64_t squared;
    std::int64_t from;
  };

  [[nodiscard]] bool is_far_from_the_other_class(const Row& row) const {
    std::uint16_t least = std::numeric_limits<std::uint16_t>::max();
    for (std::int64_t x = 0; x < row.width; ++x) {
      least = std::min(least, row.rows_away[x]);
    }
    const void* other = row.valid[0] != 0 ? std::memchr(row.valid, 0, row.width) : nullptr;
    const bool one_class = row.valid[0] != 0 ? other == nullptr
                                             : std::all_of(row.valid, row.valid + row.width,
                                                           [](std::uint8_t v) { return v == 0; });
    return least > cut_off_ && one_class;
  }

  /// The last column in which `a` is at least as near as `b`, which lies to the east of `a`. Of
  /// candidates that are more than two cut-offs apart no column is within the cut-off of both: any
  /// column between them serves.
  [[nodiscard]] std::int64_t last_column_of(const Candidate& a, const Candidate& b,
                                            const RowWeights& weights) const {
    const std::int64_t apart = b.column - a.column;
    if (apart >= 2 * std::int64_t{cut_off_} + 2) {
      return a.column + apart / 2;
    }
    const std::int64_t numerator = weights.x * apart * apart + b.squared - a.squared;
    const std::int64_t denominator = 2 * weights.x * apart;
    const std::int64_t floor =
        numerator >= 0 ? numerator / denominator : -((denominator - 1 - numerator) / denominator);
    return a.column + floor;
  }

  /// Adds a candidate to the east of all others, and drops those to which it leaves no column.
  void add_candidate(Candidate c, const RowWeights& weights) {
    c.from = std::numeric_limits<std::int64_t>::min();
    while (!candidates_.empty()) {
      c.from = last_column_of(candidates_.back(), c, weights) + 1;
      if (c.from > candidates_.back().from) {
        break;
      }
      candidates_.pop_back();
      c.from = std::numeric_limits<std::int64_t>::min();
    }
    candidates_.push_back(c);
  }

  /// Finds the depths of a run: columns [first, end), which are of one class. The samples of the
  /// row beside the run, where there are any, are of the other class; no sample beyond them is
  /// nearer.
  void transform_run(const Row& row, const RowWeights& weights, std::int64_t first,
                     std::int64_t end, float* depth) {
    candidates_.clear();
    if (first > 0) {
      candidates_.push_back({first - 1, 0, std::numeric_limits<std::int64_t>::min()});
    }
    for (std::int64_t x = first; x < end; ++x) {
      const std::int64_t away = row.rows_away[x];
      if (away <= cut_off_) {
        add_candidate({x, weights.y * away * away, 0}, weights);
      }
    }
    if (end < row.width) {
      add_candidate({end, 0, 0}, weights);
    }
    if (candidates_.empty()) {
      return;
    }
    auto nearest = candidates_.begin();
    const std::int64_t inner_end = std::min(end, mask_.inner_x + mask_.inner_width);
    for (std::int64_t x = std::max(first, mask_.inner_x); x < inner_end; ++x) {
      while (nearest + 1 != candidates_.end() && (nearest + 1)->from <= x) {
        ++nearest;
      }
      const std::int64_t apart = x - nearest->column;
      if (std::abs(apart) > cut_off_) {
        continue;
      }
      const std::int64_t squared = weights.x * apart * apart + nearest->squared;
      if (squared <= weights.limit) {
        static constexpr double kUnit = 1.0 / static_cast<double>(RowWeights::kOne);
        depth[x - mask_.inner_x] =
            static_cast<float>(weights.step * std::sqrt(static_cast<double>(squared) * kUnit));
      }
    }
  }

  MaskWindow mask_;
  int cut_off_;
  std::vector<Candidate> candidates_;
};

/// Moves on from the row `from` to the row `to` beside it. `rows_away` says, for each sample of a
/// row, how many rows back along its column the nearest sample of the other class lies.
void count_rows(const std::uint8_t* from, const std::uint8_t* to, std::int64_t width,
                std::uint16_t* rows_away) {
  for (std::int64_t x = 0; x < width; ++x) {
    const bool same = (from[x] != 0) == (to[x] != 0);
    const auto further = static_cast<std::uint16_t>(rows_away[x] + (rows_away[x] < 0xFFFF ? 1 : 0));
    rows_away[x] = same ? further : std::uint16_t{1};
  }
}

void check(const MaskWindow& mask, int cut_off, std::span<float> depth) {
  const bool inside = mask.inner_x >= 0 && mask.inner_y >= 0 && mask.inner_width > 0 &&
                      mask.inner_height > 0 && mask.inner_x + mask.inner_width <= mask.width &&
                      mask.inner_y + mask.inner_height <= mask.height;
  if (!inside || mask.valid.size() != static_cast<std::size_t>(mask.width * mask.height) ||
      depth.size() != static_cast<std::size_t>(mask.inner_width * mask.inner_height)) {
    throw Error(ErrorCode::invalid_argument,
                "depths need a window inside of its mask, and arrays of their sizes");
  }
  if (cut_off < 1 || cut_off > kLargestCutOff) {
    throw Error(ErrorCode::invalid_argument, "the cut-off of depths must lie between 1 and 4096");
  }
}

bool has_one_class(std::span<const std::uint8_t> valid) {
  if (valid.front() != 0) {
    return std::memchr(valid.data(), 0, valid.size()) == nullptr;
  }
  // A byte is 0 and each equals the one before it.
  return std::memcmp(valid.data(), valid.data() + 1, valid.size() - 1) == 0;
}

}  // namespace

void void_depth(const MaskWindow& mask, const GroundStepOfRow& step_of_row, int cut_off,
                std::span<float> depth) {
  check(mask, cut_off, depth);
  if (has_one_class(mask.valid)) {
    std::fill(depth.begin(), depth.end(), kInfinite);
    return;
  }
  const auto width = static_cast<std::size_t>(mask.width);
  const auto row_at = [&](std::int64_t y) {
    return &mask.valid[static_cast<std::size_t>(y) * width];
  };
  const auto inner_rows = static_cast<std::size_t>(mask.inner_height);
  static constexpr std::uint16_t kNone16 = 0xFFFF;

  // Southwards, keeping the counts of the inner rows; then northwards, finishing row by row.
  std::vector<std::uint16_t> to_north(width * inner_rows);
  std::vector<std::uint16_t> counts(width, kNone16);
  for (std::int64_t y = mask.height - 1; y >= mask.inner_y; --y) {
    if (y + 1 < mask.height) {
      count_rows(row_at(y + 1), row_at(y), mask.width, counts.data());
    }
    if (y < mask.inner_y + mask.inner_height) {
      std::copy(counts.begin(), counts.end(),
                to_north.begin() + static_cast<std::ptrdiff_t>(
                                       static_cast<std::size_t>(y - mask.inner_y) * width));
    }
  }
  std::fill(counts.begin(), counts.end(), kNone16);
  RowTransform transform(mask, cut_off);
  for (std::int64_t y = 0; y < mask.inner_y + mask.inner_height; ++y) {
    if (y > 0) {
      count_rows(row_at(y - 1), row_at(y), mask.width, counts.data());
    }
    if (y < mask.inner_y) {
      continue;
    }
    const auto inner = static_cast<std::size_t>(y - mask.inner_y);
    std::uint16_t* rows_away = &to_north[inner * width];
    for (std::size_t x = 0; x < width; ++x) {
      rows_away[x] = std::min(rows_away[x], counts[x]);
    }
    transform.run({row_at(y), rows_away, mask.width}, weigh(step_of_row(y), cut_off),
                  &depth[inner * static_cast<std::size_t>(mask.inner_width)]);
  }
}

}  // namespace ptin
