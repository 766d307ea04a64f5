// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/query/select/accounting.h"

#include <algorithm>
#include <limits>

#include "engine/error.h"
#include "storage/sample_heights.h"

namespace ptin {

void QueryCost::add_counts(const QueryCost& part) noexcept {
  records_retrieved += part.records_retrieved;
  records_examined += part.records_examined;
  records_applied += part.records_applied;
  stars_read += part.stars_read;
  samples_read += part.samples_read;
  io.index_nodes += part.io.index_nodes;
  io.pages += part.io.pages;
  io.bytes_read += part.io.bytes_read;
  io.pages_verified += part.io.pages_verified;
  io.ranges_announced += part.io.ranges_announced;
  io.remote_rounds += part.io.remote_rounds;
  io.remote_requests += part.io.remote_requests;
  io.remote_bytes += part.io.remote_bytes;
}

QueryContext::OwnHeights::OwnHeights() noexcept = default;
QueryContext::OwnHeights::OwnHeights(const OwnHeights& /*other*/) noexcept {}
QueryContext::OwnHeights::OwnHeights(OwnHeights&&) noexcept = default;
QueryContext::OwnHeights::~OwnHeights() = default;
QueryContext::OwnHeights& QueryContext::OwnHeights::operator=(OwnHeights&&) noexcept = default;

QueryContext::OwnHeights& QueryContext::OwnHeights::operator=(const OwnHeights& other) noexcept {
  if (this != &other) kept.reset();
  return *this;
}

SampleHeights& QueryContext::heights() {
  if (heights_.kept == nullptr) heights_.kept = std::make_unique<SampleHeights>();
  return *heights_.kept;
}

void QueryContext::throw_cancelled() const {
  throw Error(ErrorCode::cancelled, "the query was cancelled by its caller", file_);
}

void QueryContext::throw_exhausted(std::uint64_t bytes) const {
  const auto size = [](std::uint64_t b) {
    if (b < 10 << 10) return std::to_string(b) + " bytes";
    return b < (16 << 20) ? std::to_string((b + 0x3FF) >> 10) + " KiB"
                          : std::to_string((b + 0xFFFFF) >> 20) + " MiB";
  };
  bytes += std::min(held_, std::numeric_limits<std::uint64_t>::max() - bytes);
  const bool reads_alike = size(bytes) == size(limits_.memory_bytes);
  const auto told = [&](std::uint64_t b) {
    return reads_alike ? std::to_string(b) + " bytes" : size(b);
  };
  throw Error(ErrorCode::resource_exhausted,
              "the answer may take " + told(bytes) + ", more than the limit of " +
                  told(limits_.memory_bytes) +
                  ": ask for a smaller region, a larger tolerance or fewer vertices, raise the "
                  "limit, or use export",
              file_);
}

}  // namespace ptin
