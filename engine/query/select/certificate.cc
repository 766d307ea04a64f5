// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/query/select/certificate.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#include "engine/geometry/infinity.h"
#include "storage/error_table.h"

namespace ptin {

namespace {

Certificate of_finest(const StoreFile& store) {
  return {store.facts().base_error, store.facts().base_deviation, true};
}

/// The largest float that is not above `v`: no stored error lies between them. REQUIRES: v >= 0.
float rounded_down(double v) {
  if (v > std::numeric_limits<float>::max()) {
    return v < kInfinity ? std::numeric_limits<float>::max()
                         : std::numeric_limits<float>::infinity();
  }
  const auto f = static_cast<float>(v);
  return f > v ? std::nextafter(f, 0.0F) : f;
}

void leave_out(double error, double deviation, Certificate& certificate) {
  certificate.error = std::max(certificate.error, error);
  certificate.deviation = std::max(certificate.deviation, deviation);
  certificate.complete = false;
}

}  // namespace

bool leaves_records_out(const StoreFacts& facts) {
  const double left = std::max(facts.base_error, facts.base_deviation);
  const double of_floats =
      std::max(std::abs(facts.min_height), std::abs(facts.max_height)) * 0x1p-24;
  const bool has_codes = facts.heights.type == HeightType::int32;
  const double rounding = has_codes ? facts.heights.step / 2 : of_floats;
  constexpr double kSlack = 1.001;  // the bounds themselves are rounded up
  // Coarser steps are those of the source, whose heights they hold: what is told was left out.
  const bool is_rounding = rounding <= kSlack * of_floats && left <= kSlack * rounding;
  return left > 0 && !is_rounding;
}

Certificate certify_below(const StoreFile& store, double bound) {
  Certificate certificate = of_finest(store);
  if (!(bound >= 0)) {
    return certificate;
  }
  const float last = error_bin_upper(rounded_down(bound));
  for (const ErrorBin& bin : store.error_bins()) {
    if (bin.records != 0 && bin.upper <= last) {
      leave_out(std::min<double>(bin.upper, bound), bin.max_deviation, certificate);
    }
  }
  return certificate;
}

AppliedErrors::AppliedErrors(const StoreFile& store)
    : store_(&store), applied_(store.error_bins().size() + 1, 0) {}

std::size_t AppliedErrors::bin_of(float error) const noexcept {
  const std::span<const ErrorBin> bins = store_->error_bins();
  const auto bin = std::lower_bound(bins.begin(), bins.end(), error,
                                    [](const ErrorBin& b, float e) { return b.upper < e; });
  return static_cast<std::size_t>(bin - bins.begin());
}

Certificate AppliedErrors::certificate() const {
  const std::span<const ErrorBin> bins = store_->error_bins();
  Certificate certificate = of_finest(*store_);
  for (std::size_t i = 0; i < bins.size(); ++i) {
    if (applied_[i] < bins[i].records) {
      leave_out(bins[i].upper, bins[i].max_deviation, certificate);
    }
  }
  return certificate;
}

Certificate certify_applied(const StoreFile& store, std::span<const PendingSplit> splits) {
  AppliedErrors applied(store);
  for (const PendingSplit& s : splits) {
    applied.add(s.error);
  }
  return applied.certificate();
}

}  // namespace ptin
