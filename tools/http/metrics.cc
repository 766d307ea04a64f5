// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/http/metrics.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>

namespace ptin::http {

namespace {

constexpr int kBuckets = 16;
constexpr double kFirstBound = 0.0005;

double bound_of(int bucket) { return std::ldexp(kFirstBound, bucket); }

std::string number_text(double value) {
  std::array<char, 32> text{};
  const auto [end, status] = std::to_chars(text.data(), text.data() + text.size(), value);
  static_cast<void>(status);  // 32 characters hold every double.
  return {text.data(), end};
}

void append_line(std::string& text, const std::string& name, const Labels& labels, double value) {
  text += name;
  if (!labels.empty()) text.append("{").append(labels).append("}");
  text.append(" ").append(number_text(value)).append("\n");
}

}  // namespace

void Metrics::declare_counter(const std::string& name, std::string help) {
  const std::lock_guard lock(mutex_);
  families_[name] = {"counter", std::move(help), {}, {}};
}

void Metrics::declare_gauge(const std::string& name, std::string help) {
  const std::lock_guard lock(mutex_);
  families_[name] = {"gauge", std::move(help), {}, {}};
}

void Metrics::declare_seconds(const std::string& name, std::string help) {
  const std::lock_guard lock(mutex_);
  families_[name] = {"histogram", std::move(help), {}, {}};
}

void Metrics::add(const std::string& name, const Labels& labels, double value) {
  const std::lock_guard lock(mutex_);
  families_.at(name).values[labels] += value;
}

void Metrics::set(const std::string& name, const Labels& labels, double value) {
  const std::lock_guard lock(mutex_);
  families_.at(name).values[labels] = value;
}

void Metrics::observe(const std::string& name, const Labels& labels, double seconds) {
  const std::lock_guard lock(mutex_);
  Histogram& histogram = families_.at(name).histograms[labels];
  histogram.counts.resize(kBuckets);
  for (int i = 0; i < kBuckets; ++i) {
    if (seconds <= bound_of(i)) ++histogram.counts[static_cast<std::size_t>(i)];
  }
  histogram.sum += seconds;
  ++histogram.count;
}

double Metrics::value(const std::string& name, const Labels& labels) const {
  const std::lock_guard lock(mutex_);
  const Family& family = families_.at(name);
  const auto found = family.values.find(labels);
  return found == family.values.end() ? 0.0 : found->second;
}

std::string Metrics::text() const {
  const std::lock_guard lock(mutex_);
  std::string text;
  for (const auto& [name, family] : families_) {
    text.append("# HELP ").append(name).append(" ").append(family.help).append("\n");
    text.append("# TYPE ").append(name).append(" ").append(family.type).append("\n");
    for (const auto& [labels, value] : family.values) append_line(text, name, labels, value);
    for (const auto& [labels, histogram] : family.histograms) {
      const std::string comma = labels.empty() ? "" : labels + ",";
      for (int i = 0; i < kBuckets; ++i) {
        append_line(text, name + "_bucket", comma + "le=\"" + number_text(bound_of(i)) + "\"",
                    static_cast<double>(histogram.counts[static_cast<std::size_t>(i)]));
      }
      append_line(text, name + "_bucket", comma + "le=\"+Inf\"",
                  static_cast<double>(histogram.count));
      append_line(text, name + "_sum", labels, histogram.sum);
      append_line(text, name + "_count", labels, static_cast<double>(histogram.count));
    }
  }
  return text;
}

}  // namespace ptin::http
