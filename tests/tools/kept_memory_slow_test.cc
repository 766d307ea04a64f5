// SPDX-License-Identifier: GPL-3.0-or-later
//
// What a service keeps of the memory that its questions freed: so that the next one takes no fresh
// pages, no more than its part, and nothing at rest. Sanitizers have allocators of their own.
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
#include <unistd.h>

#include "tests/tools/http_client.h"
#include "tests/tools/program.h"
#include "tools/kept_memory.h"

namespace ptin::tools::testing {
namespace {

constexpr std::uint64_t kMib = std::uint64_t{1} << 20;

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
TEST(KeptMemory, ARepeatedQuestionTakesHardlyAFreshPage) {
  ServingPtin service({});
  std::uint64_t fewest = UINT64_MAX;
  for (int i = 0; i < 30; ++i) {
    const std::uint64_t before = page_faults(service.process());
    service.ask_for_much();
    fewest = std::min(fewest, page_faults(service.process()) - before);
  }
  EXPECT_LT(fewest, 50U);
}

TEST(KeptMemory, AServiceAtRestKeepsNothing) {
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

TEST(KeptMemory, NoMoreStaysThanIsKept) {
  EXPECT_EXIT(std::_Exit(fault_of_bound(16 * kMib)), ::testing::ExitedWithCode(0), "");
}

}  // namespace
}  // namespace ptin::tools::testing
