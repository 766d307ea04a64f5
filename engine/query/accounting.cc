// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/query/accounting.h"

#include "engine/error.h"

namespace ptin {

void QueryContext::throw_cancelled() const {
  throw Error(ErrorCode::cancelled, "the query was cancelled by its caller", file_);
}

void QueryContext::throw_exhausted(std::uint64_t bytes) const {
  const auto mebibytes = [](std::uint64_t b) {
    return std::to_string((b + 0xFFFFF) >> 20) + " MiB";
  };
  throw Error(ErrorCode::resource_exhausted,
              "the answer may take " + mebibytes(bytes) + ", more than the limit of " +
                  mebibytes(memory_limit_bytes_) +
                  ": ask for a smaller region, a larger tolerance or fewer vertices, raise the "
                  "limit, or use export",
              file_);
}

}  // namespace ptin
