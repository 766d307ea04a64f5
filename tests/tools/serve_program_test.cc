// SPDX-License-Identifier: GPL-3.0-or-later
//
// `ptin serve` as a program: options, configuration, start, end.
#include <csignal>
#include <filesystem>
#include <fstream>
#include <string>

#include <gtest/gtest.h>

#include "engine/error.h"
#include "tests/tools/http_client.h"
#include "tests/tools/program.h"
#include "tools/serve/config_file.h"
#include "tools/serve/limit_table.h"

namespace ptin::tools::testing {
namespace {

TEST(ServeProgram, EndsWithStatus0AfterSigterm) {
  TestFolder folder;
  const Outcome outcome =
      spawn_ptin_until("SIGTERM ends it", SIGTERM,
                       {"serve", built(folder, "mountains_257.tif"), "--listen", "127.0.0.1:0"});
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_NE(outcome.out.find("http://127.0.0.1:"), std::string::npos);
}

TEST(ServeProgram, RefusesWhatItCannotServe) {
  TestFolder folder;
  const std::string store = built(folder, "mountains_257.tif");
  const struct {
    std::vector<std::string> arguments;
    int status;
    const char* says;
  } all[] = {
      {{}, 2, "no file is given"},
      {{"missing.ptin"}, 3, "missing.ptin"},
      {{test_data("mountains_257.tif")}, 2, "mountains_257.tif: this is not a .ptin file"},
      {{store, store}, 2, "two files have the name"},
      {{"a/b=" + store}, 2, "cannot be the name"},
      {{store, "--listen", "nowhere"}, 2, "ADDRESS:PORT"},
      {{store, "--listen", "192.0.2.1:80"}, 6, "192.0.2.1:80"},
      {{store, "--limit", "points"}, 2, "NAME=VALUE"},
      {{store, "--limit", "dots=5"}, 2, "question_memory"},
      {{store, "--limit", "points=0"}, 2, "1 at least"},
      {{store, "--limit", "points=many"}, 2, "no whole number"},
      {{store, "--memory", "1M"}, 2, "question_memory"},
      {{store, "--token-file", folder.file("none")}, 3, "none"},
      {{store, "--config", folder.file("none.toml")}, 3, "none.toml"},
  };
  for (const auto& one : all) {
    std::vector<std::string> arguments = {"serve"};
    arguments.insert(arguments.end(), one.arguments.begin(), one.arguments.end());
    const Outcome outcome = run_ptin(arguments);
    EXPECT_EQ(outcome.status, one.status) << outcome.err;
    EXPECT_NE(outcome.err.find(one.says), std::string::npos) << outcome.err;
  }
}

TEST(ServeConfig, ReadsWhatOptionsSay) {
  TestFolder folder;
  write_file(folder.file("token"), "secret\n");
  std::filesystem::permissions(folder.file("token"), std::filesystem::perms::owner_read);
  write_file(folder.file("serve.toml"),
             "listen = \"0.0.0.0:9000\"\nthreads = 3\ncors = \"*\"\nfiles = true\n"
             "token_file = \"token\"\n\n[collections]\nalps = \"alps.ptin\"\n"
             "coast = \"/data/coast.ptin\"\n\n[limits]\npoints = 5\nmemory_bytes = \"64M\"\n");
  serve::ServeOptions options;
  serve::read_config(folder.file("serve.toml"), options);
  EXPECT_EQ(options.listen, "0.0.0.0:9000");
  EXPECT_EQ(options.http.threads, 3U);
  EXPECT_EQ(options.cors_origin, "*");
  EXPECT_TRUE(options.offers_files);
  EXPECT_EQ(options.token, "secret");
  ASSERT_EQ(options.files.size(), 2U);
  EXPECT_EQ(options.files[0].id, "alps");
  EXPECT_EQ(options.files[0].path, folder.file("alps.ptin"));
  EXPECT_EQ(options.files[1].path, "/data/coast.ptin");
  EXPECT_EQ(options.question.points, 5U);
  EXPECT_EQ(options.http.memory_bytes, std::uint64_t{64} << 20);
}

TEST(ServeConfig, NamesWhatItDoesNotKnow) {
  TestFolder folder;
  const struct {
    const char* text;
    const char* says;
  } all[] = {{"port = 80\n", "port"},
             {"[colections]\na = \"b\"\n", "colections"},
             {"[limits]\nspeed = 5\n", "speed"},
             {"threads = \"many\"\n", "threads"},
             {"files = \"perhaps\"\n", "files"}};
  for (const auto& one : all) {
    write_file(folder.file("serve.toml"), one.text);
    serve::ServeOptions options;
    try {
      serve::read_config(folder.file("serve.toml"), options);
      ADD_FAILURE() << one.text;
    } catch (const Error& error) {
      EXPECT_NE(std::string(error.what()).find(one.says), std::string::npos) << error.what();
    }
  }
}

TEST(ServeConfig, TakesNoTokenThatEverybodyReads) {
  TestFolder folder;
  write_file(folder.file("token"), "secret\n");
  std::filesystem::permissions(folder.file("token"), std::filesystem::perms::all);
  EXPECT_THROW(static_cast<void>(serve::read_token(folder.file("token"))), Error);
  write_file(folder.file("empty"), "");
  std::filesystem::permissions(folder.file("empty"), std::filesystem::perms::owner_read);
  EXPECT_THROW(static_cast<void>(serve::read_token(folder.file("empty"))), Error);
}

TEST(ServeLimitTable, SetsEveryLimitByItsName) {
  for (const serve::LimitFact& limit : serve::limit_table()) {
    serve::ServeOptions options;
    serve::set_limit(options, std::string(limit.name), "7654321");
    EXPECT_EQ(limit.get(options), 7654321U) << limit.name;
  }
}

}  // namespace
}  // namespace ptin::tools::testing
