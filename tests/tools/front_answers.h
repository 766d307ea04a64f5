// SPDX-License-Identifier: GPL-3.0-or-later
//
// Whether the front program answers a command line by itself.
#pragma once

#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tools/ptin/command_line.h"
#include "tools/ptin/front.h"

namespace ptin::tools::testing {

inline bool front_answers(const std::vector<std::string>& words) {
  Context context;
  const ParsedWords parsed = parse_words(words, context);
  EXPECT_EQ(parsed.fault, "");
  return is_for_front(*parsed.command, *context.reading);
}

}  // namespace ptin::tools::testing
