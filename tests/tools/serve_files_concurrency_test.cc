// SPDX-License-Identifier: GPL-3.0-or-later
//
// A service whose files are replaced, cut short, damaged and removed while it answers, and one that
// is asked for too much.
#include <atomic>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <string>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include "tests/support/share_of_cases.h"
#include "tests/tools/serve_fixture.h"

namespace ptin::tools::testing {
namespace {

namespace fs = std::filesystem;

serve::ServeOptions one_file(const std::string& path) {
  serve::ServeOptions options;
  options.http = unhurried_limits();
  options.files = {{"dem", path}};
  options.http.threads = 2;
  options.version = "test";
  return options;
}

constexpr const char* kHighest = "/collections/dem/highest?crs=native";
constexpr const char* kIsolines = "/collections/dem/isolines?interval=50";

/// Pages of records and of heights.
void damage_pages(const std::string& path) {
  std::fstream file(path, std::ios::in | std::ios::out | std::ios::binary);
  const auto bytes = static_cast<std::streamoff>(fs::file_size(path));
  for (std::streamoff at = bytes / 3; at < bytes; at += 512) file.seekp(at).put('?');
}

TEST(ServeFiles, PicksUpAFileThatTakesTheOldOnesPlace) {
  TestFolder folder;
  const std::string dem = folder.file("dem.ptin");
  fs::copy_file(built(folder, "mountains_257.tif"), dem);
  const std::string other = folder.file("other.ptin");
  fs::copy_file(built(folder, "coast_257.tif", "coast.ptin"), other);
  ServedTerrains served(one_file(dem));
  const HttpAnswer before = served.get(kHighest);
  ASSERT_EQ(before.status, 200);
  fs::rename(other, dem);
  const HttpAnswer after = served.get(kHighest);
  EXPECT_EQ(after.status, 200);
  EXPECT_NE(after.body, before.body);
  EXPECT_NE(after.header("etag"), before.header("etag"));
}

TEST(ServeFiles, GoesOnWithTheOldFileWhereTheNewOneIsNone) {
  TestFolder folder;
  const std::string dem = folder.file("dem.ptin");
  fs::copy_file(built(folder, "mountains_257.tif"), dem);
  ServedTerrains served(one_file(dem));
  const std::string before = served.get(kHighest).body;
  const std::string other = folder.file("other.ptin");
  write_file(other, "no terrain");
  fs::rename(other, dem);
  EXPECT_EQ(served.get(kHighest).body, before);
  EXPECT_NE(served.log().find("\"event\":\"file\""), std::string::npos);
  fs::remove(dem);
  EXPECT_EQ(served.get(kHighest).body, before);
  EXPECT_NE(served.log().find("gone"), std::string::npos);
  EXPECT_NE(served.get("/metrics").body.find("ptin_stale_files_total{collection=\"dem\"} 2"),
            std::string::npos);
  fs::copy_file(built(folder, "coast_257.tif", "coast.ptin"), dem);
  EXPECT_NE(served.get(kHighest).body, before);
}

TEST(ServeFiles, FailsAQuestionAndNotItselfWhereTheFileIsCutShort) {
  TestFolder folder;
  const std::string dem = folder.file("dem.ptin");
  fs::copy_file(built(folder, "mountains_257.tif"), dem);
  ServedTerrains served(one_file(dem));
  ASSERT_EQ(served.get(kHighest).status, 200);
  fs::resize_file(dem, fs::file_size(dem) / 2);
  const HttpAnswer answer = served.get("/collections/dem/isolines?interval=50");
  EXPECT_EQ(answer.status, 500);
  EXPECT_EQ(answer.body.find(folder.path().string()), std::string::npos) << answer.body;
  EXPECT_NE(served.log().find("\"event\":\"store\""), std::string::npos);
  EXPECT_NE(served.get("/metrics").body.find("ptin_store_failures_total{collection=\"dem\"} 1"),
            std::string::npos);
  EXPECT_EQ(served.get("/healthz").status, 200);
}

TEST(ServeFiles, FailsAQuestionWhosePagesAreDamaged) {
  TestFolder folder;
  const std::string dem = folder.file("dem.ptin");
  fs::copy_file(built(folder, "mountains_257.tif"), dem);
  damage_pages(dem);
  ServedTerrains served(one_file(dem));
  EXPECT_EQ(served.get(kIsolines).status, 500);
  EXPECT_EQ(served.get("/collections/dem").status, 200);
}

TEST(ServeFiles, AreDamagedUntilTheyAreReplacedWherePagesAre) {
  TestFolder folder;
  const std::string dem = folder.file("dem.ptin"), whole = built(folder, "mountains_257.tif");
  fs::copy_file(whole, dem);
  ServedTerrains served(one_file(dem));
  damage_pages(dem);
  EXPECT_EQ(served.get("/readyz").status, 200);  // Nobody met it yet.
  EXPECT_EQ(served.get(kIsolines).status, 500);
  EXPECT_EQ(served.get("/readyz").body, "damaged: dem\n");
  EXPECT_EQ(served.get("/collections/dem").status, 200);
  EXPECT_EQ(served.get("/readyz").status, 503);
  const std::string other = folder.file("other.ptin");
  fs::copy_file(whole, other);
  fs::rename(other, dem);
  EXPECT_EQ(served.get(kIsolines).status, 200);
  EXPECT_EQ(served.get("/readyz").status, 200);
}

TEST(ServeFiles, AnswersFromOneFileOrTheOtherWhileTheyChangePlaces) {
  TestFolder folder;
  const std::string dem = folder.file("dem.ptin");
  const std::string a = built(folder, "mountains_257.tif", "a.ptin");
  const std::string b = built(folder, "coast_257.tif", "b.ptin");
  fs::copy_file(a, dem);
  serve::ServeOptions options = one_file(dem);
  options.cache_bytes = 0;  // Each answer is read from pages.
  ServedTerrains served(options);
  const std::string first = served.get(kHighest).body;
  std::atomic<bool> ends{false};
  std::thread replacer([&] {
    for (int i = 0; !ends; ++i) {
      const std::string next = folder.file("next.ptin");
      fs::copy_file(i % 2 == 0 ? b : a, next, fs::copy_options::overwrite_existing);
      fs::rename(next, dem);
    }
  });
  std::string second;
  int strange = 0;
  const int times = 300 / test::share_of_cases(3);
  for (int i = 0; i < times || (second.empty() && i < 100000); ++i) {
    const HttpAnswer answer = served.get(kHighest);
    if (answer.status != 200) ++strange;
    if (answer.body == first) continue;
    if (second.empty()) second = answer.body;
    if (answer.body != second) ++strange;
  }
  ends = true;
  replacer.join();
  EXPECT_EQ(strange, 0);
  EXPECT_FALSE(second.empty());
}

TEST(ServeLimits, RefusesWhatTakesMoreMemoryOrTimeThanAQuestionMay) {
  TestFolder folder;
  serve::ServeOptions options = one_file(built(folder, "mountains_257.tif"));
  options.question.question_memory = std::uint64_t{1} << 20;
  options.http.memory_bytes = std::uint64_t{1} << 20;
  ServedTerrains served(options);
  const HttpAnswer much = served.get("/collections/dem/mesh");
  EXPECT_EQ(much.status, 413);
  EXPECT_EQ(much.json()["limit"], "question_memory");
  EXPECT_EQ(served.get(kHighest).status, 200);
}

TEST(ServeLimits, LendsNoMoreMemoryThanItHas) {
  TestFolder folder;
  serve::ServeOptions options = one_file(built(folder, "mountains_257.tif"));
  options.question.question_memory = std::uint64_t{64} << 20;
  options.http.memory_bytes = std::uint64_t{32} << 20;  // The program refuses such options.
  ServedTerrains served(options);
  const HttpAnswer answer = served.get("/collections/dem/mesh?error=50");
  EXPECT_EQ(answer.status, 503);
  EXPECT_EQ(answer.json()["limit"], "memory_bytes");
  EXPECT_EQ(answer.header("retry-after"), "1");
  EXPECT_EQ(served.get(kHighest).status, 200);
  EXPECT_NE(served.get("/metrics").body.find("ptin_memory_reserved_bytes 0"), std::string::npos);
}

TEST(ServeLimits, WantsItsToken) {
  TestFolder folder;
  serve::ServeOptions options = one_file(built(folder, "mountains_257.tif"));
  options.token = "a secret";
  ServedTerrains served(options);
  const HttpAnswer none = served.get(kHighest);
  EXPECT_EQ(none.status, 401);
  EXPECT_EQ(none.header("www-authenticate"), "Bearer");
  for (const char* wrong : {"Bearer a secre", "Bearer a secret ", "Bearer a secretx", "Bearer ",
                            "Basic a secret", "Bearer A secret"}) {
    // A blank at the end is no part of a header's value.
    const int expected = std::string(wrong) == "Bearer a secret " ? 200 : 401;
    EXPECT_EQ(served.get(kHighest, std::string("Authorization: ") + wrong + "\r\n").status,
              expected)
        << wrong;
  }
  EXPECT_EQ(served.get(kHighest, "Authorization: Bearer a secret\r\n").status, 200);
  EXPECT_EQ(served.get("/healthz").status, 200);
  EXPECT_EQ(served.log().find("a secret"), std::string::npos);
}

TEST(ServeLimits, DoesNotGiveOutFilesUnlessToldTo) {
  TestFolder folder;
  ServedTerrains served(one_file(built(folder, "mountains_257.tif")));
  EXPECT_EQ(served.get("/collections/dem/file").status, 403);
}

}  // namespace
}  // namespace ptin::tools::testing
