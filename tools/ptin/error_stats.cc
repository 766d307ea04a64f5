// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/ptin/error_stats.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include <nlohmann/json.hpp>

#include "engine/crs/crs_facts.h"
#include "engine/query/questions.h"

namespace ptin::tools {

std::uint64_t vertices_at(const StoreFile& store, double tolerance) {
  return store.t0().vertices.size() + records_above(store, tolerance);
}

double error_quantile(const StoreFile& store, double share) {
  const double wanted = share * static_cast<double>(store.record_count());
  double below = 0.0;
  for (const ErrorBin& bin : store.error_bins()) {
    below += static_cast<double>(bin.records);
    if (bin.records > 0 && below >= wanted) return bin.upper;
  }
  return 0.0;
}

FlatRecords flat_records(const StoreFile& store) {
  constexpr double kFarBelow = 1e-3;
  FlatRecords flat;
  double smallest = metadata_of(store).value("height_quantum", 1.0) * kFarBelow;
  for (const ErrorBin& bin : store.error_bins()) {
    if (bin.upper == 0) {
      flat.records += bin.records;
    } else if (bin.records > 0) {
      smallest = std::min(smallest, static_cast<double>(bin.upper) / 2);  // below where it begins
    }
  }
  if (flat.records == 0) return flat;
  const double share =
      static_cast<double>(flat.records) / static_cast<double>(store.record_count());
  flat.bytes = static_cast<std::uint64_t>(share * static_cast<double>(store.file_bytes()));
  const double decade = std::floor(std::log10(smallest) + 1e-9);
  flat.max_error = decade < 0 ? 1 / std::pow(10.0, -decade) : std::pow(10.0, decade);
  return flat;
}

double largest_finite_error(const StoreFile& store) {
  double largest = 0.0;
  for (const ErrorBin& bin : store.error_bins()) {
    if (bin.records > 0 && std::isfinite(bin.upper))
      largest = std::max(largest, static_cast<double>(bin.upper));
  }
  return largest;
}

std::vector<double> round_tolerances(const StoreFile& store, std::size_t count) {
  double smallest = std::numeric_limits<double>::infinity();
  for (const ErrorBin& bin : store.error_bins()) {
    if (bin.records > 0 && bin.upper > 0)
      smallest = std::min(smallest, static_cast<double>(bin.upper));
  }
  const double largest = largest_finite_error(store);
  std::vector<double> tolerances;
  if (!(largest > 0)) return tolerances;
  // Products and quotients by powers of ten that round as decimal text does, so that 0.1 is 0.1.
  for (int decade = static_cast<int>(std::ceil(std::log10(largest))); decade >= -12; --decade) {
    for (const double digit : {5.0, 2.0, 1.0}) {
      const double value =
          decade >= 0 ? digit * std::pow(10.0, decade) : digit / std::pow(10.0, -decade);
      if (value > largest) continue;
      if (value < smallest / 2 || tolerances.size() >= count) {
        std::reverse(tolerances.begin(), tolerances.end());
        return tolerances;
      }
      tolerances.push_back(value);
    }
  }
  std::reverse(tolerances.begin(), tolerances.end());
  return tolerances;
}

}  // namespace ptin::tools
