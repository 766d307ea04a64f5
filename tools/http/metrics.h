// SPDX-License-Identifier: GPL-3.0-or-later
//
// Counts and times of a server, in the text that Prometheus reads (exposition format 0.0.4).
#pragma once

#include <cstdint>
#include <map>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

namespace ptin::http {

/// Labels of one series, as they stand between braces: `question="position",status="200"`. Their
/// values come from small fixed sets and never from a client, so that the text stays small.
using Labels = std::string;

/// Threads: any.
class Metrics {
 public:
  /// Declares a name before its first use, with the sentence that stands beside it.
  void declare_counter(const std::string& name, std::string help);
  void declare_gauge(const std::string& name, std::string help);
  /// A histogram of seconds: 0.5 ms to 16 s by factors of two.
  void declare_seconds(const std::string& name, std::string help);

  void add(const std::string& name, const Labels& labels, double value = 1.0);
  void set(const std::string& name, const Labels& labels, double value);
  /// Puts a value into a histogram.
  void observe(const std::string& name, const Labels& labels, double seconds);

  [[nodiscard]] double value(const std::string& name, const Labels& labels) const;
  [[nodiscard]] std::string text() const;

 private:
  struct Histogram {
    std::vector<std::uint64_t> counts;
    double sum = 0.0;
    std::uint64_t count = 0;
  };
  struct Family {
    std::string type, help;
    std::map<Labels, double> values;
    std::map<Labels, Histogram> histograms;
  };

  mutable std::mutex mutex_;
  std::map<std::string, Family> families_;
};

}  // namespace ptin::http
