// SPDX-License-Identifier: GPL-3.0-or-later
//
// A planned build whose parts are done one by one.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tests/tools/program.h"

namespace ptin::tools::testing {

inline bool says(const std::string& text, const std::string& words) {
  return text.find(words) != std::string::npos;
}

class BuildPartCommand : public ::testing::Test {
 protected:
  /// A plan of so many parts for mountains in small tiles.
  void plan(int parts) {
    expect_done({"build", test_data("mountains_257.tif"), "-o", folder_.file("a.ptin"), "--tile",
                 "32", "-q", "--parts", std::to_string(parts), "--plan", plan_});
  }
  [[nodiscard]] Outcome part(std::vector<std::string> arguments) const {
    arguments.insert(arguments.begin(), {"build-part", plan_});
    return run_ptin(arguments);
  }
  void expect_the_same_bytes() const {
    const TestFolder other;
    expect_done({"build", test_data("mountains_257.tif"), "-o", other.file("a.ptin"), "--tile",
                 "32", "-q"});
    EXPECT_TRUE(read_file(folder_.file("a.ptin")) == read_file(other.file("a.ptin")));
    EXPECT_FALSE(std::filesystem::exists(folder_.file(".a.ptin.ptin-build")));
  }
  [[nodiscard]] static std::string script(const std::string& name) {
    return PTIN_TEST_DATA "/../../tools/cluster/" + name;
  }

  TestFolder folder_;
  std::string plan_ = folder_.file("the plan");
};

}  // namespace ptin::tools::testing
