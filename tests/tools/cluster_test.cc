// SPDX-License-Identifier: GPL-3.0-or-later
//
// Plans of builds by jobs of a batch system, and parts that are refused.
#include <string>

#include <gtest/gtest.h>

#include "tests/tools/build_part.h"

namespace ptin::tools {
namespace {

using testing::BuildPartCommand;
using testing::Outcome;
using testing::read_file;
using testing::says;

TEST_F(BuildPartCommand, RefusesPlansThatAreMissingOrDamagedOrOfAnotherVersion) {
  const auto refused = [&](int status, const std::string& words) {
    const Outcome outcome = part({"join"});
    EXPECT_EQ(outcome.status, status) << outcome.err;
    EXPECT_TRUE(says(outcome.err, words)) << outcome.err;
  };
  refused(3, "there is no such plan");
  plan(2);
  const std::string whole = read_file(plan_);
  const auto write = [&](const std::string& text) { testing::write_file(plan_, text); };
  for (const double share : {0.0, 0.1, 0.5, 0.9}) {
    write(whole.substr(0, static_cast<std::size_t>(share * static_cast<double>(whole.size()))));
    refused(2, "this is no plan");
  }
  const auto replaced = [&](const std::string& from, const std::string& to) {
    std::string text = whole;
    EXPECT_NE(text.find(from), std::string::npos) << text;
    return text.replace(text.find(from), from.size(), to);
  };
  write(replaced("\"ptin_parts\": \"", "\"ptin_parts\": \"9"));
  refused(2, "another version");
  write(replaced("\"--tile\"", "\"--till\""));
  refused(2, "the plan is damaged");
  write(replaced("\"note\"", "\"not\""));
  refused(2, "the plan is damaged");
  write(replaced("\"temporary\"", "\"tmp\""));
  refused(2, "is damaged");
  write(replaced("\"folder\": \"/", "\"folder\": \"/not there/"));
  refused(3, "the folder in which the build was planned");
}

TEST_F(BuildPartCommand, RefusesPhasesOutOfTheirOrder) {
  plan(2);
  EXPECT_EQ(part({"collapse"}).status, 2);
  EXPECT_EQ(part({"join", "0"}).status, 2);
  EXPECT_EQ(part({"collapse", "2"}).status, 2);
  EXPECT_EQ(part({"collapse", "0", "-q"}).status, 0);
  const Outcome early = part({"publish"});
  EXPECT_EQ(early.status, 2);
  EXPECT_TRUE(says(early.err, "part 1 of the phase collapse is not done; do it first"))
      << early.err;
}

}  // namespace
}  // namespace ptin::tools
