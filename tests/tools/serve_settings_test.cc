// SPDX-License-Identifier: GPL-3.0-or-later
//
// Options and the configuration of the service.
#include <filesystem>
#include <string>

#include <gtest/gtest.h>

#include "engine/error.h"
#include "tests/tools/serve_fixture.h"
#include "tools/serve/config_file.h"
#include "tools/serve/limit_table.h"

namespace ptin::tools::testing {
namespace {

/// What an action says when it refuses; nothing where it does not.
template <typename Action>
std::string refusal_of(const Action& action) {
  try {
    action();
  } catch (const Error& error) {
    return error.what();
  }
  return {};
}

TEST(ServeSettings, AreBoundOnBothSides) {
  serve::ServeOptions options;
  serve::set_limit(options, "cache_bytes", "0");
  EXPECT_EQ(options.cache_bytes, 0U);
  const struct {
    const char* name;
    const char* value;
    const char* says;
  } all[] = {{"body_bytes", "2G", "1073741824 at most"},
             {"header_bytes", "3G", "1073741824 at most"},
             {"request_line_bytes", "3G", "1073741824 at most"},
             {"points", "9999999999999", "at most"},
             {"points", "0", "1 at least"},
             {"body_bytes", "0", "256 at least"}};
  for (const auto& one : all) {
    const std::string says = refusal_of([&] { serve::set_limit(options, one.name, one.value); });
    EXPECT_NE(says.find(one.says), std::string::npos) << one.name << ": " << says;
  }
  TestFolder folder;
  const std::string config = folder.file("serve.toml");
  write_file(config, "threads = 100000\n");
  EXPECT_NE(refusal_of([&] { serve::read_config(config, options); }).find("1 to 1024"),
            std::string::npos);
}

TEST(ServeSettings, HoldNothingThatBreaksAHeader) {
  EXPECT_EQ(serve::checked_origin("https://example.org", ""), "https://example.org");
  for (const char* origin : {"https://a\r\nSet-Cookie: b", "a\tb", "a b", "a\x7f"}) {
    EXPECT_THROW(static_cast<void>(serve::checked_origin(origin, "")), Error) << origin;
  }
  TestFolder folder;
  for (const char* text : {"secret \r\n", "secret", "secret\t\nmore"}) {
    const std::string file = folder.file(std::to_string(std::string(text).size()));
    write_file(file, text);
    std::filesystem::permissions(file, std::filesystem::perms::owner_read);
    EXPECT_EQ(serve::read_token(file), "secret");
  }
}

}  // namespace
}  // namespace ptin::tools::testing
