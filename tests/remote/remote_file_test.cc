// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/remote/remote_file.h"

#include <algorithm>
#include <chrono>
#include <cstring>
#include <fstream>
#include <optional>
#include <random>
#include <thread>
#include <vector>

#include <cpl_conv.h>
#include <cpl_vsi.h>
#include <gtest/gtest.h>

#include "engine/error.h"
#include "tests/support/range_server.h"
#include "tests/support/test_folder.h"

namespace ptin {
namespace {

using test::RangeServer;
using test::TestFolder;

constexpr std::size_t kFront = std::size_t{64} << 10;
constexpr std::size_t kBytes = 1000003;

/// One folder and one server for all cases: each case reads a file of its own, by which the server
/// counts.
class RemoteFileTest : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    if (!RangeServer::is_possible()) return;
    folder_ = new TestFolder(TestFolder::Size::kSmall);
    server_ = new RangeServer(folder_->path().string());
  }
  static void TearDownTestSuite() {
    delete server_;
    delete folder_;
    server_ = nullptr;
    folder_ = nullptr;
  }
  void SetUp() override {
    if (server_ == nullptr) GTEST_SKIP() << RangeServer::kNeeded;
    options.first_pause = 0.01;
    options.most_silent_seconds = 1;
    file = std::string(testing::UnitTest::GetInstance()->current_test_info()->name());
    content = write(file, 1);
    server_->take_counts();
  }

  static std::vector<char> write(const std::string& name, std::uint64_t seed) {
    std::mt19937_64 random(seed);
    std::vector<char> bytes(kBytes);
    for (char& b : bytes) b = static_cast<char>(random());
    std::ofstream(folder_->file(name), std::ios::binary)
        .write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    return bytes;
  }
  [[nodiscard]] std::string url(const std::string& mode) const {
    return server_->url(mode + "/" + file);
  }
  [[nodiscard]] std::shared_ptr<RangeSource> open(const std::string& mode) const {
    return open_remote(url(mode), options);
  }
  /// Reads ranges in one round, and compares them.
  void expect_reads(RangeSource& source, const std::vector<ByteRange>& ranges) const {
    std::vector<std::vector<std::byte>> out;
    std::vector<RangeRead> reads;
    for (const ByteRange& r : ranges) out.emplace_back(r.bytes);
    for (std::size_t i = 0; i < ranges.size(); ++i) reads.push_back({ranges[i].offset, out[i]});
    source.read(reads);
    for (std::size_t i = 0; i < ranges.size(); ++i) {
      EXPECT_EQ(std::memcmp(out[i].data(), content.data() + ranges[i].offset, out[i].size()), 0);
    }
  }
  /// What goes wrong; none: nothing.
  template <class Do>
  static std::optional<Error> fault_of(const Do& what) {
    try {
      what();
    } catch (const Error& error) {
      return error;
    }
    return std::nullopt;
  }
  void expect_fault(const std::string& mode, ErrorCode code, const std::string& words) const {
    const auto fault = fault_of([&] {
      const auto source = open(mode);
      std::vector<std::byte> out(5000);
      const RangeRead range{500000, out};
      source->read(std::span(&range, 1));
    });
    ASSERT_TRUE(fault) << mode;
    EXPECT_EQ(fault->code(), code) << fault->what();
    EXPECT_NE(fault->message().find(words), std::string::npos) << fault->what();
    EXPECT_EQ(fault->context(), url(mode));
  }

  static TestFolder* folder_;
  static RangeServer* server_;
  RemoteOptions options;
  std::string file;
  std::vector<char> content;
};
TestFolder* RemoteFileTest::folder_ = nullptr;
RangeServer* RemoteFileTest::server_ = nullptr;

TEST(IsRemote, TellsUrlsFromPaths) {
  for (const char* name :
       {"http://h/a.ptin", "https://h/a.ptin", "s3://b/k", "gs://b/k", "az://b/k",
        "/vsicurl/http://h/a", "/vsizip/a.zip/a.ptin", "/vsimem/a"}) {
    EXPECT_TRUE(is_remote(name)) << name;
  }
  for (const char* name :
       {"", "a.ptin", "/data/a.ptin", "./http://a", "file:///a", "ftp://h/a", "C:/a"}) {
    EXPECT_FALSE(is_remote(name)) << name;
  }
}

TEST_F(RemoteFileTest, OpensByOneRequestForTheFront) {
  const auto source = open("plain");
  EXPECT_EQ(source->bytes(), kBytes);
  ASSERT_EQ(source->front().size(), kFront);
  EXPECT_EQ(std::memcmp(source->front().data(), content.data(), kFront), 0);
  const auto counts = server_->take_counts();
  EXPECT_EQ(counts.ranges, std::vector<std::string>{"bytes=0-65535"});
  EXPECT_EQ(counts.bytes, kFront);
}

TEST_F(RemoteFileTest, ReadsRangesInOneRoundAtMostSixteenAtOnce) {
  const RangeServer slow(folder_->path().string(), "0.03");
  const auto source = open_remote(slow.url("plain/" + file), options);
  slow.take_counts();
  std::vector<ByteRange> ranges;
  for (std::uint64_t i = 0; i < 50; ++i) ranges.push_back({70000 + i * 15000, 1 + i * 17});
  ranges.push_back({kBytes - 1, 1});
  expect_reads(*source, ranges);
  const auto counts = slow.take_counts();
  EXPECT_EQ(counts.requests, ranges.size());
  EXPECT_LE(counts.most, 16U);
  EXPECT_GT(counts.most, 4U) << "they run together";
}

TEST_F(RemoteFileTest, ReadsFilesThatAreShorterThanTheFront) {
  std::ofstream(folder_->file("short"), std::ios::binary) << "hello";
  const auto source = open_remote(server_->url("plain/short"), options);
  EXPECT_EQ(source->bytes(), 5U);
  EXPECT_EQ(source->front().size(), 5U);
  std::ofstream(folder_->file("empty"), std::ios::binary);
  const auto fault =
      fault_of([&] { static_cast<void>(open_remote(server_->url("plain/empty"), options)); });
  ASSERT_TRUE(fault);
  EXPECT_EQ(fault->code(), ErrorCode::corruption);
}

TEST_F(RemoteFileTest, FollowsRedirections) {
  const auto source = open("moved");
  expect_reads(*source, {{200000, 70000}});
}

TEST_F(RemoteFileTest, TriesAgainWhatMayPass) {
  for (const char* mode : {"busy-3", "limit-3", "cut-3", "reset-3"}) {
    const auto source = open(mode);
    EXPECT_EQ(std::memcmp(source->front().data(), content.data(), kFront), 0) << mode;
    EXPECT_EQ(server_->take_counts().requests, 4U) << mode;
    expect_reads(*source, {{70000, 5000}, {500000, 5000}});
    server_->take_counts();
  }
}

TEST_F(RemoteFileTest, GivesUpAfterAFewTries) {
  options.tries = 3;
  expect_fault("down", ErrorCode::io_error, "503; 3 tries");
  EXPECT_EQ(server_->take_counts().requests, 3U);
  expect_fault("always-cut", ErrorCode::io_error, "ended before the answer did; 3 tries");
  EXPECT_EQ(server_->take_counts().requests, 3U);
  options.tries = 2;
  expect_fault("reset-9", ErrorCode::io_error, "2 tries");
}

TEST_F(RemoteFileTest, EndsWaitingForAServerThatIsSilent) {
  options.tries = 1;
  expect_fault("silent", ErrorCode::io_error, "does not answer");
}

TEST_F(RemoteFileTest, RefusesServersThatSendNoRanges) {
  expect_fault("whole", ErrorCode::invalid_argument, "no ranges");
  EXPECT_EQ(server_->take_counts().requests, 1U);
  expect_fault("packed", ErrorCode::invalid_argument, "packed");
}

TEST_F(RemoteFileTest, TellsWhatIsNotThereOrNotAllowed) {
  expect_fault("missing", ErrorCode::not_found, "no such object");
  expect_fault("refused", ErrorCode::io_error, "refuses access");
  EXPECT_EQ(server_->take_counts().requests, 2U) << "neither is tried again";
}

TEST_F(RemoteFileTest, RefusesAnObjectThatTookThePlace) {
  std::vector<char> other = write(file + ".other", 2);
  expect_fault("replaced-1", ErrorCode::corruption, "replaced");
  EXPECT_EQ(server_->take_counts().ranges.size(), 2U);
  expect_fault("weak-1", ErrorCode::corruption, "replaced");
  expect_fault("deaf-1", ErrorCode::corruption, "replaced");
  // Its length alone tells where nothing else does.
  std::ofstream(folder_->file(file + ".other"), std::ios::binary)
      .write(other.data(), static_cast<std::streamsize>(kBytes - 1));
  expect_fault("swapped-1", ErrorCode::corruption, "replaced");
}

TEST_F(RemoteFileTest, RefusesOtherBytesThanThoseAskedFor) {
  expect_fault("wrong", ErrorCode::io_error, "495904 to 500903, and 500000-504999 were asked for");
}

TEST_F(RemoteFileTest, TellsANameThatNoServerAnswersTo) {
  options.tries = 1;
  const auto fault =
      fault_of([&] { static_cast<void>(open_remote("http://127.0.0.1:1/a.ptin", options)); });
  ASSERT_TRUE(fault);
  EXPECT_EQ(fault->code(), ErrorCode::io_error);
}

TEST_F(RemoteFileTest, StopsWhenItIsAsked) {
  std::stop_source stop;
  options.stop = stop.get_token();
  options.most_silent_seconds = 100;
  const auto source = open("silent");
  const std::jthread stopper([&] {
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
    stop.request_stop();
  });
  const auto fault = fault_of([&] { expect_reads(*source, {{70000, 10}}); });
  ASSERT_TRUE(fault);
  EXPECT_EQ(fault->code(), ErrorCode::cancelled);
}

TEST_F(RemoteFileTest, ReadsGdalsFileSystems) {
  const std::string path = "/vsimem/" + file;
  VSIFCloseL(VSIFileFromMemBuffer(path.c_str(), reinterpret_cast<GByte*>(content.data()),
                                  content.size(), FALSE));
  const auto source = open_remote(path, options);
  EXPECT_EQ(source->bytes(), kBytes);
  std::vector<ByteRange> ranges;
  for (std::uint64_t i = 0; i < 40; ++i) ranges.push_back({i * 20000, 100});
  expect_reads(*source, ranges);
  VSIUnlink(path.c_str());
  const auto fault = fault_of([&] { static_cast<void>(open_remote("/vsimem/none", options)); });
  ASSERT_TRUE(fault);
  EXPECT_EQ(fault->code(), ErrorCode::not_found);
  expect_reads(*open_remote("/vsicurl/" + url("plain"), options), {{500000, 10}});
}

/// GDAL's options while this lives.
class Configured {
 public:
  using Options = std::vector<std::pair<const char*, std::string>>;
  explicit Configured(Options options) : options_(std::move(options)) {
    for (const auto& [name, value] : options_) CPLSetConfigOption(name, value.c_str());
  }
  Configured(const Configured&) = delete;
  Configured& operator=(const Configured&) = delete;
  ~Configured() {
    for (const auto& [name, value] : options_) CPLSetConfigOption(name, nullptr);
  }

 private:
  Options options_;
};

TEST_F(RemoteFileTest, SignsRequestsToAStoreOfObjects) {
  const Configured here({{"AWS_S3_ENDPOINT", "127.0.0.1:" + std::to_string(server_->port())},
                         {"AWS_HTTPS", "NO"},
                         {"AWS_VIRTUAL_HOSTING", "FALSE"},
                         {"AWS_REGION", "us-east-1"},
                         {"AWS_ACCESS_KEY_ID", "PTINTESTKEY"},
                         {"AWS_SECRET_ACCESS_KEY", "ptin/test+secret"}});
  const auto source = open_remote("s3://bucket/" + file, options);
  expect_reads(*source, {{70000, 5000}, {500000, 5000}});
  EXPECT_EQ(server_->take_counts().requests, 3U);
  expect_reads(*open_remote("/vsis3/bucket/" + file, options), {{500000, 10}});
  server_->take_counts();
  const Configured wrong(Configured::Options{{"AWS_SECRET_ACCESS_KEY", "another"}});
  const auto fault =
      fault_of([&] { static_cast<void>(open_remote("s3://bucket/" + file, options)); });
  ASSERT_TRUE(fault);
  EXPECT_EQ(fault->code(), ErrorCode::io_error);
  EXPECT_NE(fault->message().find("credentials"), std::string::npos) << fault->what();
  EXPECT_EQ(server_->take_counts().requests, 2U) << "once more by a new signature";
}

TEST_F(RemoteFileTest, AsksForPublicObjectsWithoutASignature) {
  const Configured here({{"AWS_S3_ENDPOINT", "127.0.0.1:" + std::to_string(server_->port())},
                         {"AWS_HTTPS", "NO"},
                         {"AWS_VIRTUAL_HOSTING", "FALSE"},
                         {"AWS_NO_SIGN_REQUEST", "YES"}});
  expect_reads(*open_remote("s3://plain/" + file, options), {{500000, 10}});
}

TEST_F(RemoteFileTest, TakesGdalsOptionsOfItsRequests) {
  const Configured here({{"GDAL_HTTP_MAX_RETRY", "1"}, {"GDAL_HTTP_RETRY_DELAY", "0"}});
  expect_fault("down", ErrorCode::io_error, "2 tries");
}

}  // namespace
}  // namespace ptin
