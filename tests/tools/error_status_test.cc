// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/error_status.h"

#include <new>

#include <gtest/gtest.h>

namespace ptin::tools {
namespace {

TEST(ErrorStatus, HasTheDocumentedRowForEveryCode) {
  const struct {
    ErrorCode code;
    int exit;
    unsigned http;
  } rows[] = {{ErrorCode::invalid_argument, 2, 400}, {ErrorCode::not_found, 3, 500},
              {ErrorCode::corruption, 4, 500},       {ErrorCode::unsupported_version, 5, 500},
              {ErrorCode::io_error, 6, 500},         {ErrorCode::resource_exhausted, 7, 413},
              {ErrorCode::cancelled, 8, 503},        {ErrorCode::internal, 70, 500}};
  for (const auto& row : rows) {
    EXPECT_EQ(status_of(row.code).exit, row.exit) << to_string(row.code);
    EXPECT_EQ(status_of(row.code).http, row.http) << to_string(row.code);
  }
}

template <typename Throw>
Error caught(const Throw& raise) {
  try {
    raise();
  } catch (...) {
    return current_error();
  }
  return {ErrorCode::internal, "nothing was thrown"};
}

TEST(CurrentError, PassesOurOwnErrorsOn) {
  const Error error = caught([] { throw Error(ErrorCode::corruption, "bad page", "file.ptin"); });
  EXPECT_EQ(error.code(), ErrorCode::corruption);
  EXPECT_EQ(error.context(), "file.ptin");
}

TEST(CurrentError, CallsMissingMemoryExhausted) {
  EXPECT_EQ(caught([] { throw std::bad_alloc(); }).code(), ErrorCode::resource_exhausted);
}

TEST(CurrentError, CallsEverythingElseInternal) {
  EXPECT_EQ(caught([] { throw std::logic_error("x"); }).code(), ErrorCode::internal);
  EXPECT_EQ(caught([] { throw 1; }).code(), ErrorCode::internal);
}

}  // namespace
}  // namespace ptin::tools
