// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/measure/io_report.h"

#include <algorithm>
#include <iterator>
#include <numeric>

namespace ptin::tools {

Quantiles Readings::seconds() const {
  std::vector<double> values;
  std::transform(all_.begin(), all_.end(), std::back_inserter(values),
                 [](const Reading& r) { return r.seconds; });
  return quantiles_of(std::move(values));
}

template <class Value>
double Readings::mean_of(const Value& value) const {
  const double sum = std::accumulate(
      all_.begin(), all_.end(), 0.0,
      [&](double s, const Reading& r) { return s + static_cast<double>(value(r)); });
  return all_.empty() ? 0.0 : sum / static_cast<double>(all_.size());
}

double Readings::mean_pages() const {
  return mean_of([](const Reading& r) { return r.io.pages; });
}
double Readings::mean_nodes() const {
  return mean_of([](const Reading& r) { return r.io.index_nodes; });
}
double Readings::mean_asked_bytes() const {
  return mean_of([](const Reading& r) { return r.io.bytes_read; });
}
std::optional<double> Readings::asked_over_least() const {
  const double least = mean_of([](const Reading& r) { return r.least_bytes; });
  if (least == 0) return {};
  return mean_asked_bytes() / least;
}
double Readings::mean_major_faults() const {
  return mean_of([](const Reading& r) { return r.major_faults; });
}
std::optional<double> Readings::mean_device_bytes() const {
  if (all_.empty() || !all_.front().device_bytes) return {};
  return mean_of([](const Reading& r) { return r.device_bytes.value_or(0); });
}

}  // namespace ptin::tools
