// SPDX-License-Identifier: GPL-3.0-or-later
//
// The limits of a question, and how their excess is told.
#include "engine/query/select/accounting.h"

#include <string>

#include <gtest/gtest.h>

#include "engine/error.h"

namespace ptin {
namespace {

std::string refusal_of(std::uint64_t limit, std::uint64_t bytes) {
  QueryLimits limits;
  limits.memory_bytes = limit;
  try {
    QueryContext(limits, "a.ptin").admit(bytes);
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ErrorCode::resource_exhausted);
    return e.what();
  }
  return "admitted";
}

TEST(QueryContext, TellsSmallAmountsInBytesAndOthersSoThatTheyDiffer) {
  const auto tells = [](std::uint64_t limit, std::uint64_t bytes, const std::string& words) {
    const std::string text = refusal_of(limit, bytes);
    EXPECT_NE(text.find(words), std::string::npos) << text;
  };
  tells(10, 200, "may take 200 bytes, more than the limit of 10 bytes:");
  tells(10, 1000, "may take 1000 bytes, more than the limit of 10 bytes:");
  tells(1000, 20'000, "may take 20 KiB, more than the limit of 1000 bytes:");
  tells(20'000, 20'001, "may take 20001 bytes, more than the limit of 20000 bytes:");
  tells(50 << 20, 100 << 20, "may take 100 MiB, more than the limit of 50 MiB:");
  EXPECT_EQ(refusal_of(200, 200), "admitted");
}

}  // namespace
}  // namespace ptin
