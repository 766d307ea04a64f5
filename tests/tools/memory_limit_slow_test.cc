// SPDX-License-Identifier: GPL-3.0-or-later
//
// Builds and streams under a limit that the system enforces: RLIMIT_DATA counts every private page that may be
// written, touched or not, so a build needs --memory and a margin for what is reserved and never
// used: stacks of threads, arenas of the heap, the data of libraries.
#include <array>
#include <fstream>
#include <vector>

#include <gtest/gtest.h>
#include <sys/mman.h>

#include "tests/support/resource_limit.h"
#include "tests/support/share_of_cases.h"
#include "tests/tools/program.h"

namespace ptin::tools {
namespace {

using testing::spawn_ptin;
using testing::TestFolder;

constexpr rlim_t kMiB = rlim_t{1} << 20;
/// What was measured on 4097 x 4097 samples, and a third more; engine/DECISIONS.md, section 4.8.
constexpr rlim_t kMargin = 64 * kMiB;

/// On private memory.
class DataLimit : public test::ResourceLimit {
 public:
  explicit DataLimit(rlim_t bytes) : ResourceLimit(RLIMIT_DATA, bytes) {}
};

/// Whether this program is refused private memory beyond a limit.
bool is_limit_enforced() {
  constexpr std::size_t kBytes = std::size_t{1} << 32;
  const DataLimit limit(kBytes / 2);
  if (!limit.is_set()) {
    return false;
  }
  void* const memory = ::mmap(nullptr, kBytes, PROT_READ | PROT_WRITE,
                              MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
  if (memory == MAP_FAILED) {
    return true;
  }
  ::munmap(memory, kBytes);
  return false;
}

/// Where nothing is enforced these tests would pass whatever a build takes.
class MemoryLimitSlow : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!is_limit_enforced()) {
      GTEST_SKIP() << "needs a system that enforces RLIMIT_DATA";
    }
  }
};

void make_hills(const TestFolder& folder, int side = 1500) {
  testing::RasterRecipe recipe;
  recipe.width = recipe.height = side;
  recipe.value = [](int x, int y) { return testing::hills(x, y) + (x * 31 + y * 17) % 23; };
  testing::make_raster(folder.file("dem.tif"), recipe);
}

TEST_F(MemoryLimitSlow, ABuildKeepsWithinItsMemoryAndAMarginThatTheSystemEnforces) {
  const TestFolder folder;
  make_hills(folder);
  for (rlim_t memory = 256; memory <= rlim_t{512} / test::share_of_cases(2); memory *= 2) {
    SCOPED_TRACE(memory);
    const DataLimit limit(memory * kMiB + kMargin);
    const auto outcome =
        spawn_ptin({"build", folder.file("dem.tif"), "-o", folder.file("out.ptin"), "--overwrite",
                    "--threads", "2", "--memory", std::to_string(memory) + "M", "-q"});
    EXPECT_EQ(outcome.status, 0) << outcome.err;
  }
}

/// A mesh of 1000 x 1000 vertices as binary PLY: read into memory, its 150 bytes a vertex
/// would be all that the limit leaves.
void make_mesh(const std::string& path) {
  constexpr int kSide = 1000;
  std::ofstream file(path, std::ios::binary);
  file << "ply\nformat binary_little_endian 1.0\nelement vertex " << kSide * kSide
       << "\nproperty float x\nproperty float y\nproperty float z\nelement face "
       << 2 * (kSide - 1) * (kSide - 1) << "\nproperty list uchar int vertex_indices\nend_header\n";
  const auto put = [&](const auto& value) {
    file.write(reinterpret_cast<const char*>(&value), sizeof value);
  };
  for (int i = 0; i < kSide * kSide; ++i) {
    const int x = i % kSide, y = i / kSide;
    put(static_cast<float>(x));
    put(static_cast<float>(y));
    put(static_cast<float>((x * 31 + y * 17) % 23));
  }
  for (int i = 0; i < kSide * (kSide - 1); ++i) {
    if (i % kSide == kSide - 1) {
      continue;
    }
    for (const std::array<int, 3>& corners :
         {std::array{i, i + 1, i + kSide + 1}, std::array{i, i + kSide + 1, i + kSide}}) {
      put(std::uint8_t{3});
      put(corners);
    }
  }
}

/// As they are, and repaired: neither takes memory for all vertices.
TEST_F(MemoryLimitSlow, ATinKeepsWithinItsMemoryToo) {
  const TestFolder folder;
  make_mesh(folder.file("mesh.ply"));
  constexpr rlim_t kMemory = 96;
  const DataLimit limit(kMemory * kMiB + kMargin);
  std::vector<const char*> ways{"--repair", "--overwrite"};
  ways.resize(ways.size() / test::share_of_cases(2));
  for (const char* repair : ways) {
    SCOPED_TRACE(repair);
    const auto outcome =
        spawn_ptin({"build", folder.file("mesh.ply"), "-o", folder.file("out.ptin"), "--overwrite",
                    "--threads", "1", "--tile", "128", "--memory", std::to_string(kMemory) + "M",
                    "-q", repair});
    EXPECT_EQ(outcome.status, 0) << outcome.err;
  }
}

/// Whole it would take some 300 MB, and is refused.
TEST_F(MemoryLimitSlow, AStreamKeepsWithinItsMemoryAndIsTheSame) {
  const TestFolder folder;
  make_hills(folder, 1000);
  const std::string store = folder.file("t.ptin");
  ASSERT_EQ(spawn_ptin({"build", folder.file("dem.tif"), "-o", store, "-q"}).status, 0);
  ASSERT_EQ(spawn_ptin({"stream", store, "-o", folder.file("whole.pts")}).status, 0);
  constexpr rlim_t kMemory = 64;
  const DataLimit limit(kMemory * kMiB + kMargin);
  const auto refused =
      spawn_ptin({"stream", store, "-o", folder.file("none.pts"), "--memory", "2G"});
  EXPECT_EQ(refused.status, 7) << "it is too small to be seen to keep within its memory";
  const auto outcome = spawn_ptin({"stream", store, "-o", folder.file("parts.pts"), "--threads",
                                   "2", "--memory", std::to_string(kMemory) + "M"});
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_TRUE(testing::read_file(folder.file("parts.pts")) ==
              testing::read_file(folder.file("whole.pts")));
}

/// So the others do not pass because a build is not held to the limit.
TEST_F(MemoryLimitSlow, ABuildThatIsGivenMoreThanTheLimitFails) {
  const TestFolder folder;
  make_hills(folder);
  const DataLimit limit(48 * kMiB);
  const auto outcome = spawn_ptin({"build", folder.file("dem.tif"), "-o", folder.file("out.ptin"),
                                   "--threads", "2", "--memory", "512M", "-q"});
  EXPECT_NE(outcome.status, 0);
  EXPECT_FALSE(std::filesystem::exists(folder.file("out.ptin")));
}

}  // namespace
}  // namespace ptin::tools
