// SPDX-License-Identifier: GPL-3.0-or-later
//
// Builds in which the n-th allocation fails, for every n of the first few hundred and many more:
// what is there afterwards is the old file, or the new one, whole; or work that --resume ends with
// the same bytes. Points and TINs as text without a CRS, so that hardly anything but code of ours
// allocates; one thread, so that the n-th is always the same one.
#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <new>
#include <optional>
#include <random>
#include <string>
#include <string_view>
#include <vector>

#include <dlfcn.h>
#include <execinfo.h>
#include <gtest/gtest.h>

#include "engine/construct/build.h"
#include "engine/construct/scratch/workspace.h"
#include "engine/error.h"
#include "tests/construct/hierarchy_fixture.h"
#include "tests/construct/made_raster.h"
#include "tests/support/replaced_new.h"
#include "tests/support/share_of_cases.h"

namespace {

/// Allocations until one fails; the one after it succeeds again.
std::atomic<std::int64_t> allocations_left{0};

/// Functions of libraries that allocate where they must not throw, and so end the process without
/// memory. Nobody else is excused.
constexpr std::array<std::string_view, 2> kEndTheProcess = {
    "json_value7destroy",    // nlohmann's values, in their destructor
    "18directory_iterator",  // libstdc++'s constructor that takes an error_code
};

bool is_excused() {
  std::array<void*, 32> frames{};  // Each call of a template that is not optimised is one.
  const int depth = ::backtrace(frames.data(), static_cast<int>(frames.size()));
  for (int i = 0; i < depth; ++i) {
    Dl_info info{};
    if (::dladdr(frames[static_cast<std::size_t>(i)], &info) == 0 || info.dli_sname == nullptr) {
      continue;
    }
    for (const std::string_view name : kEndTheProcess) {
      if (std::string_view(info.dli_sname).find(name) != std::string_view::npos) {
        return true;
      }
    }
  }
  return false;
}

/// Whether this is the one that fails.
bool fails() {
  if (allocations_left.fetch_sub(1, std::memory_order_relaxed) != 1) {
    return false;
  }
  if (is_excused()) {
    allocations_left = 1;  // the next one instead
    return false;
  }
  return true;
}

}  // namespace

namespace ptin {
namespace {

/// Counts, and fails one, for as long as it lives.
class FailingAllocation {
 public:
  explicit FailingAllocation(std::int64_t nth) : nth_(nth) { allocations_left = nth; }
  [[nodiscard]] std::int64_t allocations() const { return nth_ - allocations_left; }

 private:
  std::int64_t nth_;
  test::AskedAllocations asked_{fails};
};

std::string few_points() {
  std::mt19937 random(7);
  std::string text;
  for (int i = 0; i < 90; ++i) {
    const auto x = random() % 100, y = random() % 100;
    text += std::to_string(x) + " " + std::to_string(y) + " " + std::to_string(x * y % 97) + "\n";
  }
  return text;
}

std::string few_triangles() {
  constexpr int kSide = 8;
  std::string text;
  for (int i = 0; i < kSide * kSide; ++i) {
    text += "v " + std::to_string(i % kSide * 10 + i % 3) + " " + std::to_string(i / kSide * 10) +
            " " + std::to_string(i * 37 % 23) + "\n";
  }
  for (int i = 0; i < kSide * (kSide - 1); ++i) {
    if (i % kSide == kSide - 1 || i % 11 == 5) {  // some holes
      continue;
    }
    const auto face = [&](int a, int b, int c) {
      text += "f " + std::to_string(a) + " " + std::to_string(b) + " " + std::to_string(c) + "\n";
    };
    face(i + 1, i + 2, i + 2 + kSide);
    face(i + 1, i + 2 + kSide, i + 1 + kSide);
  }
  return text;
}

class AllocationFaults : public ::testing::Test {
 protected:
  void SetUp() override {
#ifndef PTIN_TEST_ALLOCATES
    GTEST_SKIP() << "needs a program without a sanitizer, which allocates by itself";
#endif
  }
  void use(const std::string& name, const std::string& text) {
    input_ = source_folder_.file(name);
    oracle::write_text(input_, text);
    // Twice: what libraries keep from the first time on is no part of the second.
    ASSERT_EQ(fault_of(Unfinished::kRefuse, 0), std::nullopt);
    ASSERT_EQ(fault_of(Unfinished::kRefuse, 0), std::nullopt);
    expected_ = oracle::bytes_of(output_);
  }

  /// What is said of a build whose n-th allocation fails (0: none does); none when it ends well.
  std::optional<std::string> fault_of(Unfinished unfinished, std::int64_t nth) {
    BuildOptions options;
    options.tile = 4;
    BuildResources resources;
    resources.overwrite = true;
    resources.unfinished = unfinished;
    resources.threads = 1;
    resources.memory_bytes = std::uint64_t{512} << 20;
    resources.files = &files_;
    resources.checkpoint_interval = std::chrono::milliseconds(0);
    const std::vector<std::string> inputs = {input_};
    const FailingAllocation failing(nth == 0 ? std::int64_t{1} << 40 : nth);
    try {
      build(inputs, output_, options, resources);
    } catch (const Error& e) {
      // A standard stream takes a failing allocation for a file that cannot be opened.
      const bool is_from_stream =
          e.code() == ErrorCode::io_error && e.message().find("cannot open") == 0;
      EXPECT_TRUE(e.code() == ErrorCode::resource_exhausted || is_from_stream) << e.what();
      return e.message();
    } catch (const std::bad_alloc&) {
      ADD_FAILURE() << "no Error";
      return "std::bad_alloc";
    }
    allocations_ = failing.allocations();
    return std::nullopt;
  }

  /// What must hold when the n-th allocation fails.
  void expect_old_or_new(std::int64_t nth) {
    oracle::write_text(output_, "old");
    const std::optional<std::string> fault = fault_of(Unfinished::kRefuse, nth);
    const std::string now = oracle::bytes_of(output_);
    const bool is_kept = folder_.names().size() > 1;
    EXPECT_TRUE(fault ? now == "old" : now == expected_) << fault.value_or("");
    if (fault) {
      EXPECT_EQ(fault->find("--resume") != std::string::npos, is_kept) << *fault;
    }
    if (is_kept) {
      EXPECT_TRUE(fault);
      EXPECT_GT(std::filesystem::file_size(folder_.file(".out.ptin.ptin-build/manifest")), 0U);
      EXPECT_EQ(folder_.names(), (std::vector<std::string>{".out.ptin.ptin-build", "out.ptin"}));
      expect_known(nth % 2 == 0, now);
    }
    ++(!fault ? complete_ : is_kept ? kept_ : without_a_trace_);
    EXPECT_EQ(folder_.names(), std::vector<std::string>{"out.ptin"});
  }

  /// What a build left behind, --discard removes, and --resume ends.
  void expect_known(bool by_discard, const std::string& now) {
    if (by_discard) {
      EXPECT_TRUE(Workspace::discard(files_, output_));
      EXPECT_TRUE(oracle::bytes_of(output_) == now);
      return;
    }
    const auto fault = fault_of(Unfinished::kResume, 0);
    EXPECT_FALSE(fault) << *fault;
    EXPECT_TRUE(oracle::bytes_of(output_) == expected_);
  }

  void expect_old_or_new_always() {
    const std::int64_t one_by_one = 1000 / test::share_of_cases(2);
    const std::int64_t strides = 1500 / test::share_of_cases(3);
    const std::int64_t all = allocations_;
    const std::int64_t stride = (all - one_by_one) / strides + 1;
    for (std::int64_t n = 1; n <= all && !HasFailure(); n += n < one_by_one ? 1 : stride) {
      SCOPED_TRACE("allocation " + std::to_string(n) + " of " + std::to_string(all));
      expect_old_or_new(n);
    }
    // Else the test shows nothing of what it is about.
    EXPECT_GT(without_a_trace_, 100);
    EXPECT_GT(kept_, 100);
  }

 private:
  oracle::ScratchFolder source_folder_{oracle::ScratchFolder::Size::kSmall};
  oracle::ScratchFolder folder_{oracle::ScratchFolder::Size::kSmall};
  test::UnsyncedFiles files_;
  std::string input_, output_ = folder_.file("out.ptin"), expected_;
  std::int64_t allocations_ = 0;  ///< Of the last build that ended well.
  int complete_ = 0, kept_ = 0, without_a_trace_ = 0;
};

TEST_F(AllocationFaults, OfPointsLeaveTheOldFileOrTheNewOne) {
  use("points.xyz", few_points());
  expect_old_or_new_always();
}

TEST_F(AllocationFaults, OfATinLeaveTheOldFileOrTheNewOne) {
  use("mesh.obj", few_triangles());
  expect_old_or_new_always();
}

}  // namespace
}  // namespace ptin
