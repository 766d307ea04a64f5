// SPDX-License-Identifier: GPL-3.0-or-later
#include "storage/error_table.h"

#include <algorithm>

#include "storage/layout.h"

namespace ptin {

namespace {

constexpr std::uint32_t kBinStep =
    1U << 20;  // a float has 23 mantissa bits; the upper three give the bin

}  // namespace

float error_bin_upper(float error) noexcept {
  const std::uint32_t bits = layout::to_bits(error);
  return layout::to_float((bits + (kBinStep - 1)) & ~(kBinStep - 1));
}

std::uint64_t records_in(const std::vector<ErrorBin>& bins) noexcept {
  std::uint64_t records = 0;
  for (const ErrorBin& bin : bins) {
    records += bin.records;
  }
  return records;
}

void ErrorTable::add(const VertexSplit& r) {
  const float upper = error_bin_upper(r.error);
  ErrorBin& bin = bins_[layout::to_bits(upper)];
  bin.upper = upper;
  bin.max_deviation = std::max(bin.max_deviation, r.deviation);
  ++bin.records;
  bin.void_vertices += r.has_height() ? 0 : 1;
}

void ErrorTable::add(const ErrorBin& other) {
  ErrorBin& bin = bins_[layout::to_bits(other.upper)];
  bin.upper = other.upper;
  bin.max_deviation = std::max(bin.max_deviation, other.max_deviation);
  bin.records += other.records;
  bin.void_vertices += other.void_vertices;
}

std::vector<ErrorBin> ErrorTable::bins() const {
  std::vector<ErrorBin> result;
  result.reserve(bins_.size() + 1);
  if (bins_.empty() || bins_.begin()->first != 0) {
    result.push_back({});
  }
  for (const auto& [bits, bin] : bins_) {
    result.push_back(bin);
  }
  return result;
}

}  // namespace ptin
