// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/grid/height_fit.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "engine/error.h"

namespace ptin {
namespace {

/// How far a height may lie from a multiple of `step` and still count as one that was rounded to
/// binary: a few units of its last bit, which is 2^-23 of the height in a float32 and 2^-52 in a
/// float64. For float32 the answer decides the quantum alone and no stored height, so resampling
/// noise of a thousandth of the step passes too.
double tolerance(HeightScan::Given given, double height, double step) {
  return given == HeightScan::Given::kFloat32
             ? std::max(std::ldexp(std::abs(height), -23), std::ldexp(step, -10))
             : std::ldexp(std::abs(height), -50);
}

/// The nearest whole number, ties to even, of |v| < 2^51. Faster than nearbyint, which is a call.
double nearest_integer(double v) {
  static constexpr double kShift = 6755399441055744.0;  // 1.5 * 2^52: the sum has no bits below 1
  return (v + kShift) - kShift;
}

}  // namespace

double decimal_step(int decimals) noexcept {
  // Quotients of exact powers: rounded once.
  static constexpr std::array<double, 23> kSteps = {
      1 / 1e0,  1 / 1e1,  1 / 1e2,  1 / 1e3,  1 / 1e4,  1 / 1e5,  1 / 1e6,  1 / 1e7,
      1 / 1e8,  1 / 1e9,  1 / 1e10, 1 / 1e11, 1 / 1e12, 1 / 1e13, 1 / 1e14, 1 / 1e15,
      1 / 1e16, 1 / 1e17, 1 / 1e18, 1 / 1e19, 1 / 1e20, 1 / 1e21, 1 / 1e22};
  return kSteps[static_cast<std::size_t>(decimals)];
}

void HeightScan::add(double height) {
  ++count_;
  min_ = std::min(min_, height);
  max_ = std::max(max_, height);
  if (given_ == Given::kFloat64) {
    all_int32_ = all_int32_ && std::abs(height) <= kLargestCode && height == std::trunc(height);
    all_float32_ = all_float32_ && static_cast<double>(static_cast<float>(height)) == height;
  }
  if (decimals_ <= kMaxDecimals) {
    test_decimals(height);
  }
}

/// Measures a height against the coarsest step that holds it and against all finer steps. A later
/// height may need a finer step, and the distance from its multiples is another one: n * 0.01 and
/// (100 n) * 0.0001 are different doubles.
void HeightScan::test_decimals(double height) {
  bool fits = false;
  for (int decimals = decimals_; decimals <= kMaxDecimals; ++decimals) {
    const double step = decimal_step(decimals);
    const double steps = height / step;
    if (std::abs(steps) > kLargestCode) {
      break;  // finer steps do not fit either
    }
    const double distance = std::abs(height - nearest_integer(steps) * step);
    fits = fits || distance <= tolerance(given_, height, step);
    decimals_ += fits ? 0 : 1;
    double& rounding = decimal_rounding_[static_cast<std::size_t>(decimals)];
    rounding = std::max(rounding, distance);
    if (fits && given_ == Given::kFloat32) {
      return;  // float32 heights are stored as they are: no rounding to be measured
    }
  }
  decimals_ = fits ? decimals_ : kMaxDecimals + 1;
}

void HeightScan::join(const HeightScan& other) {
  count_ += other.count_;
  min_ = std::min(min_, other.min_);
  max_ = std::max(max_, other.max_);
  all_int32_ = all_int32_ && other.all_int32_;
  all_float32_ = all_float32_ && other.all_float32_;
  decimals_ = std::max(decimals_, other.decimals_);
  for (std::size_t d = 0; d < decimal_rounding_.size(); ++d) {
    decimal_rounding_[d] = std::max(decimal_rounding_[d], other.decimal_rounding_[d]);
  }
}

HeightFit HeightScan::fit() const {
  HeightFit fit;
  fit.count = count_;
  if (count_ == 0) {
    fit.quantum = 1.0;
    return fit;
  }
  const bool whole = given_ == Given::kFloat64 && all_int32_;
  const bool decimal =
      decimals_ <= kMaxDecimals && std::max(-min_, max_) / decimal_step(decimals_) <= kLargestCode;
  if (whole) {
    fit.encoding = {HeightType::int32, 1.0, 0.0};
    fit.quantum = 1.0;
  } else if (given_ == Given::kFloat32 || all_float32_) {
    fit.encoding = {HeightType::float32, 1.0, 0.0};
    fit.quantum = float_quantum();
  } else if (decimal) {
    fit.encoding = {HeightType::int32, decimal_step(decimals_), 0.0};
    fit.quantum = fit.encoding.step;
    fit.rounding = decimal_rounding_[static_cast<std::size_t>(decimals_)];
  } else {
    choose_rounded(fit);
  }
  fit.min_height = fit.encoding.height(encode_height(fit.encoding, min_));
  fit.max_height = fit.encoding.height(encode_height(fit.encoding, max_));
  return fit;
}

/// The quantum of float32 heights: the decimal step that holds them, where float32 at these heights
/// is at least four times as fine (else any number at all would pass for a decimal); otherwise the
/// range / 2^16, or 1 where all heights are equal.
double HeightScan::float_quantum() const {
  const double largest = std::max(std::abs(min_), std::abs(max_));
  if (decimals_ <= kMaxDecimals && std::ldexp(largest, -23) < decimal_step(decimals_) / 4) {
    return decimal_step(decimals_);
  }
  return max_ > min_ ? (max_ - min_) / 65536.0 : 1.0;
}

/// int32 with the smallest step 2^e for which range / step <= 2^31, but not below an ulp of the
/// largest height, so that offset + step * code, a multiple of the step below 2^53 steps, is
/// computed exactly.
void HeightScan::choose_rounded(HeightFit& fit) const {
  const double range = max_ - min_;
  const double largest = std::max(std::abs(min_), std::abs(max_));
  int range_exponent = 0, largest_exponent = 0;
  std::frexp(range, &range_exponent);      // range < 2^range_exponent
  std::frexp(largest, &largest_exponent);  // ulp(largest) = 2^(largest_exponent - 53)
  const double step = std::ldexp(1.0, std::max(range_exponent - 31, largest_exponent - 53));
  const double offset = std::nearbyint((min_ + range / 2) / step) * step;
  fit.encoding = {HeightType::int32, step, offset};
  fit.rounding = step / 2;
  fit.quantum = std::max(step, range / 65536.0);
}

void set_heights(TerrainFrame& frame, const HeightFit& fit) {
  frame.heights = fit.encoding;
  frame.height_quantum = fit.quantum;
  frame.height_rounding = fit.rounding;
  frame.min_height = fit.min_height;
  frame.max_height = fit.max_height;
}

HeightBits encode_height(const HeightEncoding& encoding, double height) {
  if (encoding.type == HeightType::float32) {
    return encoding.bits(static_cast<double>(static_cast<float>(height)));
  }
  const double code = std::nearbyint((height - encoding.offset) / encoding.step);
  if (!(std::abs(code) <= kLargestCode)) {
    throw Error(
        ErrorCode::io_error,
        "a height lies outside of the range found before; was the source changed meanwhile?");
  }
  return encoding.bits(code);
}

}  // namespace ptin
