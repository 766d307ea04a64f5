// SPDX-License-Identifier: GPL-3.0-or-later
//
// What affinity and cgroups leave a process, told by files as the kernel writes them.
#include "engine/construct/process_limits.h"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include <gtest/gtest.h>
#include <sched.h>

#include "tests/support/test_folder.h"

namespace ptin {
namespace {

/// A kernel's files in a folder of the test.
class Cgroups {
 public:
  explicit Cgroups(const std::string& groups) { write("groups", groups); }
  void write(const std::string& name, const std::string& text) const {
    const std::filesystem::path path(folder_.file(name));
    std::filesystem::create_directories(path.parent_path());
    std::ofstream(path) << text << '\n';
  }
  [[nodiscard]] CgroupPlace place() const { return {folder_.file("groups"), folder_.file("root")}; }

 private:
  test::TestFolder folder_;
};

/// Threads that a process on very many processors would have: the machine of the test has few.
int threads_of(const std::string& quota_and_period) {
  const Cgroups cgroups("0::/a/b");
  cgroups.write("root/a/b/cpu.max", quota_and_period);
  return allowed_threads(cgroups.place());
}

TEST(AllowedThreads, AreTheProcessorsOfTheAffinity) {
  int alone = 0, all = 0;
  std::thread([&] {  // the affinity is a thread's own
    all = allowed_threads();
    cpu_set_t given, one;
    ASSERT_EQ(sched_getaffinity(0, sizeof given, &given), 0);
    EXPECT_LE(all, CPU_COUNT(&given));
    int processor = 0;
    while (CPU_ISSET(processor, &given) == 0) ++processor;
    CPU_ZERO(&one);
    CPU_SET(processor, &one);
    ASSERT_EQ(sched_setaffinity(0, sizeof one, &one), 0);
    alone = allowed_threads();
  })
      .join();
  EXPECT_EQ(alone, 1);
  EXPECT_GE(all, 1);
}

TEST(AllowedThreads, AreNoMoreThanAQuotaPaysFor) {
  const int all = threads_of("max 100000");
  EXPECT_EQ(threads_of("100000 100000"), 1);
  EXPECT_EQ(threads_of("150000 100000"), std::min(all, 2));
  EXPECT_EQ(threads_of("1000 100000"), 1);
  EXPECT_EQ(threads_of("6400000 100000"), std::min(all, 64));
  EXPECT_EQ(threads_of("no numbers"), all);
}

TEST(AllowedThreads, HeedTheGroupsAround) {
  const Cgroups cgroups("0::/a/b");
  cgroups.write("root/a/b/cpu.max", "max 100000");
  cgroups.write("root/a/cpu.max", "50000 100000");
  EXPECT_EQ(allowed_threads(cgroups.place()), 1);
  const Cgroups container("0::/not/seen/from/inside");
  container.write("root/cpu.max", "100000 100000");
  EXPECT_EQ(allowed_threads(container.place()), 1);
}

TEST(AllowedThreads, KnowTheFirstVersionOfCgroups) {
  const int all = threads_of("max 100000");
  const std::string quota = "root/cpu/a/cpu.cfs_quota_us", period = "root/cpu/a/cpu.cfs_period_us";
  for (const std::string controllers : {"cpu", "cpu,cpuacct", "cpuacct,cpu"}) {
    const Cgroups cgroups("5:cpuset:/b\n4:" + controllers + ":/a\n0::/");
    cgroups.write(quota, "-1");
    cgroups.write(period, "100000");
    EXPECT_EQ(allowed_threads(cgroups.place()), all);
    cgroups.write(quota, "20000");
    EXPECT_EQ(allowed_threads(cgroups.place()), 1) << controllers;
  }
  const Cgroups other("4:cpuset,cpuacct:/a");  // neither limits time
  other.write(quota, "20000");
  other.write(period, "100000");
  EXPECT_EQ(allowed_threads(other.place()), all);
}

TEST(AllowedMemory, IsThatOfTheSmallestGroup) {
  constexpr std::uint64_t kSmall = 123456789;  // below any limit on the resources of a test
  const Cgroups second("0::/a/b");
  second.write("root/a/b/memory.max", "max");
  const std::uint64_t unlimited = allowed_memory(second.place());
  second.write("root/a/memory.max", std::to_string(kSmall));
  EXPECT_EQ(allowed_memory(second.place()), std::min(unlimited, kSmall));
  const Cgroups first("3:memory:/a\n2:cpu:/a");
  first.write("root/memory/memory.limit_in_bytes", std::to_string(kSmall));
  EXPECT_EQ(allowed_memory(first.place()), std::min(unlimited, kSmall));
}

}  // namespace
}  // namespace ptin
