// SPDX-License-Identifier: GPL-3.0-or-later
//
// What a service keeps of the memory that its questions freed: so that the next one takes no fresh
// pages, no more than its part, and nothing at rest.
#include "tools/kept_memory.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <unistd.h>

#include "tests/tools/http_client.h"
#include "tests/tools/program.h"
#include "tools/serve/serve_options.h"

namespace ptin::tools::testing {
namespace {

constexpr std::uint64_t kMib = std::uint64_t{1} << 20;

/// Sanitizers have allocators of their own.
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
constexpr bool kHasTheSystemsAllocator = false;
#else
constexpr bool kHasTheSystemsAllocator = true;
#endif

class KeptMemory : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!kHasTheSystemsAllocator) GTEST_SKIP() << "needs the allocator of the system";
  }
};

/// Resident memory of a process that is no file's.
std::uint64_t resident_bytes(pid_t process) {
  const std::string status = read_file("/proc/" + std::to_string(process) + "/status");
  const std::string name = "RssAnon:";
  return std::stoull(status.substr(status.find(name) + name.size())) << 10;
}

/// Pages that the process has been given so far.
std::uint64_t page_faults(pid_t process) {
  const std::string stat = read_file("/proc/" + std::to_string(process) + "/stat");
  std::istringstream fields(stat.substr(stat.rfind(')') + 1));
  std::array<std::string, 8> field;  // The eighth from the state on is minflt.
  for (std::string& one : field) fields >> one;
  return std::stoull(field.back());
}

/// `ptin serve` of one small terrain under the name `dem`, which keeps no answers.
class ServingPtin {
 public:
  explicit ServingPtin(const std::vector<std::string>& options)
      : ptin_(arguments(options)), client_(address()) {}

  /// A mesh of the whole terrain.
  void ask_for_much() {
    const HttpAnswer answer = client_.get("/collections/dem/mesh?f=ply&crs=native");
    EXPECT_EQ(answer.status, 200) << answer.body;
    EXPECT_GT(answer.body.size(), kMib);
  }
  [[nodiscard]] pid_t process() const { return ptin_.process(); }

 private:
  [[nodiscard]] std::vector<std::string> arguments(const std::vector<std::string>& options) const {
    std::vector<std::string> all{"serve",     "dem=" + built(folder_, "mountains_257.tif"),
                                 "--listen",  "127.0.0.1:0",
                                 "--threads", "1",
                                 "--limit",   "cache_bytes=0"};
    all.insert(all.end(), options.begin(), options.end());
    return all;
  }
  [[nodiscard]] std::string address() const {
    const std::string out = ptin_.out_with("SIGTERM ends it"), before = "http://";
    const std::size_t at = out.find(before) + before.size();
    return out.substr(at, out.find('/', at) - at);
  }

  TestFolder folder_;
  StartedPtin ptin_;
  HttpClient client_;
};

/// The fewest of many: on a busy machine the service may rest between two questions, and either of its
/// threads has memory of its own.
TEST_F(KeptMemory, ARepeatedQuestionTakesHardlyAFreshPage) {
  ServingPtin service({});
  std::uint64_t fewest = UINT64_MAX;
  for (int i = 0; i < 30; ++i) {
    const std::uint64_t before = page_faults(service.process());
    service.ask_for_much();
    fewest = std::min(fewest, page_faults(service.process()) - before);
  }
  EXPECT_LT(fewest, 50U);
}

TEST_F(KeptMemory, AServiceAtRestKeepsNothing) {
  ServingPtin service({});
  const std::uint64_t before = resident_bytes(service.process());
  for (int i = 0; i < 3; ++i) service.ask_for_much();
  EXPECT_TRUE(comes_true([&] { return resident_bytes(service.process()) < before + 4 * kMib; }))
      << resident_bytes(service.process()) << " after " << before;
}

/// Blocks of a megabyte.
class Blocks {
 public:
  explicit Blocks(std::uint64_t bytes) : blocks_(bytes / kMib) {
    for (void*& block : blocks_) std::memset(block = std::malloc(kMib), 1, kMib);
  }
  Blocks(const Blocks&) = delete;
  Blocks& operator=(const Blocks&) = delete;
  ~Blocks() {
    for (void* const block : blocks_) std::free(block);
  }
  /// Frees three of four, and not the last one, before which malloc gives nothing back by itself.
  void free_most() {
    for (std::size_t i = 0; i < blocks_.size(); ++i) {
      if (i % 4 != 3) std::free(std::exchange(blocks_[i], nullptr));
    }
  }

 private:
  std::vector<void*> blocks_;
};

/// Runs in a process of its own, since the allocator stays as it is told.
/// @return 0, or the number of what failed.
int fault_of_bound(std::uint64_t kept) {
  const auto bound = keep_freed_memory_of_questions(kept);
  const std::uint64_t before = resident_bytes(::getpid());
  const auto grown = [&] { return resident_bytes(::getpid()) - before; };
  Blocks few(kept / 2);
  few.free_most();
  bound();
  if (grown() < kept / 2 - kMib) return 1;  // Given back, though less than is kept.
  Blocks many(4 * kept);
  bound();
  if (grown() < 4 * kept - kMib) return 2;  // All in use.
  many.free_most();
  if (grown() < 4 * kept - kMib) return 3;  // Else there is nothing to bound.
  bound();
  if (grown() > kept + kept / 8 + kept + kMib) return 4;  // What is in use, and what is kept.
  Blocks again(kept / 2);
  again.free_most();
  const std::uint64_t little = grown();
  bound();  // malloc counts as free what it has given back.
  return grown() < little ? 5 : 0;
}

TEST_F(KeptMemory, NoMoreStaysThanIsKept) {
  EXPECT_EXIT(std::_Exit(fault_of_bound(16 * kMib)), ::testing::ExitedWithCode(0), "");
}

TEST(DividedMemory, HasAPartThatIsKept) {
  const auto kept_of = [](std::uint64_t memory, std::uint64_t question) {
    serve::ServeOptions options;
    options.http.memory_bytes = memory * kMib;
    options.question.question_memory = question * kMib;
    serve::divide_memory(options);
    EXPECT_LE(options.http.kept_bytes + options.http.question_bytes, options.http.memory_bytes);
    EXPECT_TRUE(memory == 0 || options.http.memory_bytes == memory * kMib);
    return options.http.kept_bytes;
  };
  EXPECT_EQ(kept_of(64, 64), 0U);  // One question takes all.
  EXPECT_EQ(kept_of(80, 64), 0U);  // Beside it a point is answered.
  EXPECT_EQ(kept_of(100, 64), 0U);
  EXPECT_EQ(kept_of(112, 64), 8 * kMib);
  EXPECT_EQ(kept_of(336, 64), 64 * kMib);
  EXPECT_EQ(kept_of(10000, 64), 64 * kMib);
  EXPECT_EQ(kept_of(0, 32), 32 * kMib);
}

/// Where nobody says how much memory there is, what is kept takes nothing of what is lent.
TEST(DividedMemory, GrowsByWhatIsKept) {
  serve::ServeOptions options;
  options.http.threads = 2;
  options.http.memory_bytes = 0;
  serve::divide_memory(options);
  EXPECT_EQ(options.http.memory_bytes, (3 * 64 + 2 * 16) * kMib * 6 / 5 + (16 + 64) * kMib);
}

}  // namespace
}  // namespace ptin::tools::testing
