// SPDX-License-Identifier: GPL-3.0-or-later
//
// Builds by the ranks of an MPI job, and by jobs of a batch system: the bytes are those of one process; and what is said where
// something is missing. Ranks are killed at random moments (five in all; twenty where all cases are asked for): the build goes
// on with another number of them. Not under sanitizers, which find faults of MPI's.
#include <algorithm>
#include <csignal>
#include <filesystem>
#include <string>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include "tests/support/share_of_cases.h"
#include "tests/tools/build_part.h"
#include "tests/tools/mpi_run.h"

namespace ptin::tools {
namespace {

using testing::BuildPartCommand;
using testing::cluster_source;
using testing::ClusterSource;
using testing::mpi_environment;
using testing::mpi_program;
using testing::mpirun;
using testing::Outcome;
using testing::read_file;
using testing::run_ptin;
using testing::run_ranks;
using testing::says;
using testing::StartedProgram;
using testing::TestFolder;

class RanksSlow : public ::testing::TestWithParam<std::string> {};

TEST_P(RanksSlow, KilledAtRandomMomentsLoseNothing) {
  if (!testing::why_no_mpi().empty()) GTEST_SKIP() << testing::why_no_mpi();
  testing::expect_kills_lose_nothing(GetParam(),
                                     (GetParam() == "tin" ? 4 : 8) / test::share_of_cases(4));
}

TEST_P(RanksSlow, GiveTheBytesOfOneProcess) {
  if (!testing::why_no_mpi().empty()) GTEST_SKIP() << testing::why_no_mpi();
  testing::expect_same_bytes_on_ranks(GetParam(), {2, 4, 7});
}

INSTANTIATE_TEST_SUITE_P(OfEachKind, RanksSlow, ::testing::Values("raster", "points", "tin"),
                         [](const auto& kind) { return kind.param; });

TEST(BuildOnRanks, GivesTheBytesOfOneProcess) {
  if (!testing::why_no_mpi().empty()) GTEST_SKIP() << testing::why_no_mpi();
  testing::expect_same_bytes_on_ranks("raster", {7});
  testing::expect_same_bytes_on_ranks("points", {2});
  testing::expect_same_bytes_on_ranks("tin", {4});
}

/// A raster, and its file by one process.
class Ranks : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!testing::why_no_mpi().empty()) GTEST_SKIP() << testing::why_no_mpi();
    source_ = cluster_source(folder_, "raster");
    testing::expect_done(source_.build(folder_.file("1.ptin")));
    expected_ = read_file(folder_.file("1.ptin"));
  }

  TestFolder folder_;
  ClusterSource source_;
  std::string expected_;
};

/// One command for each group of ranks, as mpirun takes them.
std::vector<std::string> with_groups(const std::vector<std::vector<std::string>>& groups) {
  std::vector<std::string> arguments;
  for (const std::vector<std::string>& group : groups) {
    if (!arguments.empty()) arguments.emplace_back(":");
    arguments.insert(arguments.end(), group.begin(), group.end());
  }
  return mpirun(arguments);
}

std::vector<std::string> joined(std::vector<std::string> a, const std::vector<std::string>& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

/// What ranks exchange lies where the first of them says; what the others are given as --tmp
/// does not matter.
TEST_F(Ranks, ExchangeFilesInTheFolderOfTheFirst) {
  const TestFolder shared, other;
  const std::string output = folder_.file("a.ptin");
  const Outcome outcome =
      StartedProgram(with_groups({joined({"-n", "1", mpi_program()},
                                         source_.build(output, {"--tmp", shared.path().string()})),
                                  joined({"-n", "2", mpi_program()},
                                         source_.build(output, {"--tmp", other.path().string()}))}),
                     mpi_environment())
          .wait();
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_TRUE(read_file(output) == expected_);
  EXPECT_TRUE(shared.names().empty());
}

TEST_F(Ranks, GoOnWhereOneHasNoMoreDisk) {
  const std::string output = folder_.file("a.ptin");
  const std::vector<std::string> build = source_.build(output);
  const std::vector<std::string> poor =
      joined({"-n", "1", "sh", "-c", "ulimit -f 64; exec \"$@\"", "sh", mpi_program()}, build);
  const Outcome outcome =
      StartedProgram(with_groups({joined({"-n", "1", mpi_program()}, build), poor}),
                     mpi_environment())
          .wait();
  EXPECT_EQ(outcome.status, 7) << outcome.err;
  EXPECT_EQ(says(outcome.err, "--resume"),
            std::filesystem::exists(folder_.file(".a.ptin.ptin-build")))
      << outcome.err;
  EXPECT_FALSE(std::filesystem::exists(output));
  const Outcome resumed = run_ranks(3, source_.build(output, {"--resume"}));
  EXPECT_EQ(resumed.status, 0) << resumed.err;
  EXPECT_TRUE(read_file(output) == expected_);
}

TEST_F(Ranks, SayWhatIsWrongOnceAndLeaveNothing) {
  const Outcome outcome =
      run_ranks(3, {"build", folder_.file("none.tif"), "-o", folder_.file("a.ptin"), "-q"});
  EXPECT_EQ(
      outcome.status,
      run_ptin({"build", folder_.file("none.tif"), "-o", folder_.file("a.ptin"), "-q"}).status);
  const std::string sentence = "there is no such raster";
  EXPECT_TRUE(says(outcome.err, sentence)) << outcome.err;
  EXPECT_EQ(outcome.err.find(sentence, outcome.err.find(sentence) + 1), std::string::npos)
      << outcome.err;
  EXPECT_FALSE(std::filesystem::exists(folder_.file(".a.ptin.ptin-build")));
}

TEST_F(Ranks, WaitForOneThatWasStoppedForTwoSeconds) {
  const std::string output = folder_.file("a.ptin");
  StartedProgram program(joined(mpirun({"-n", "3", mpi_program()}), source_.build(output)),
                         mpi_environment());
  pid_t stopped = 0;
  while (stopped == 0 && program.is_running()) {
    const auto ranks = program.children();
    const bool has_begun = std::filesystem::exists(folder_.file(".a.ptin.ptin-build/pages"));
    if (has_begun && !ranks.empty()) {
      stopped = *std::max_element(ranks.begin(), ranks.end());
    }
  }
  ASSERT_NE(stopped, 0);
  ::kill(stopped, SIGSTOP);
  std::this_thread::sleep_for(std::chrono::seconds(2));
  ::kill(stopped, SIGCONT);
  const Outcome outcome = program.wait();
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_TRUE(read_file(output) == expected_);
}

TEST(BuildWithoutMpi, RefusesToBeStartedByMpirun) {
#ifdef PTIN_MPI
  GTEST_SKIP() << "needs a program without MPI";
#endif
  const TestFolder folder;
  const std::vector<std::string> build{
      PTIN_PROGRAM, "build", testing::test_data("mountains_257.tif"), "-o", folder.file("a.ptin")};
  // As mpirun and srun tell it, one of four processes and a single one.
  for (const std::vector<std::string>& environment :
       {std::vector<std::string>{"OMPI_COMM_WORLD_SIZE=4", "PMIX_RANK=2"},
        std::vector<std::string>{"PMIX_RANK=0", "SLURM_STEP_NUM_TASKS=4"}}) {
    const Outcome outcome = StartedProgram(build, environment).wait();
    EXPECT_EQ(outcome.status, 2);
    EXPECT_TRUE(says(outcome.err, "made without MPI")) << outcome.err;
    EXPECT_EQ(testing::lines_in(outcome.err), 1U) << outcome.err;
    EXPECT_TRUE(folder.names().empty());
  }
  for (const std::vector<std::string>& environment :
       {std::vector<std::string>{"OMPI_COMM_WORLD_SIZE=1", "PMIX_RANK=0"},
        std::vector<std::string>{"PMIX_RANK=0", "SLURM_STEP_NUM_TASKS=1"}}) {
    const Outcome outcome = StartedProgram(build, environment).wait();
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    std::filesystem::remove(folder.file("a.ptin"));
  }
}

// -------------------------------------------------------------------------------------------------
// Jobs of a batch system.

TEST_F(BuildPartCommand, IsRunByGnuParallel) {
  plan(3);
  try {
    const Outcome outcome =
        StartedProgram({"bash", script("local_build"), plan_, "2", "--memory", "300M"},
                       {"PTIN=" PTIN_PROGRAM})
            .wait();
    if (says(outcome.err, "GNU parallel is not installed")) GTEST_SKIP() << outcome.err;
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    EXPECT_TRUE(says(outcome.out, "records")) << outcome.out;
  } catch (const std::runtime_error& e) {
    GTEST_SKIP() << "needs bash: " << e.what();
  }
  expect_the_same_bytes();
}

/// A sbatch that does jobs at once, as Slurm would, and refuses one whose predecessor it does not
/// know.
constexpr const char* kSbatch = R"(#!/usr/bin/env bash
set -euo pipefail
folder=$(dirname "$0")
array=none
for argument; do
  case $argument in
    --array=*) array=${argument#--array=} ;;
    --dependency=afterok:*) test -e "$folder/job-${argument##*:}" ;;
    --wrap=*) command=${argument#--wrap=} ;;
  esac
done
number=$(($(cat "$folder/count" 2> /dev/null || echo 100) + 1))
echo "$number" > "$folder/count"
if [ "$array" = none ]; then
  bash -c "$command" > /dev/null
else
  limits=${array%\%*}
  for i in $(seq "${limits%-*}" "${limits#*-}"); do SLURM_ARRAY_TASK_ID=$i bash -c "$command" > /dev/null; done
fi
touch "$folder/job-$number"
echo "$number;cluster"
)";

TEST_F(BuildPartCommand, IsSubmittedToSlurm) {
  plan(3);
  const TestFolder bin;
  testing::write_file(bin.file("sbatch"), kSbatch);
  std::filesystem::permissions(bin.file("sbatch"), std::filesystem::perms::owner_all);
  const Outcome outcome =
      StartedProgram({"bash", script("slurm_build"), plan_, "--mem=1G"},
                     {"PTIN=" PTIN_PROGRAM, "PTIN_AT_ONCE=2",
                      "PATH=" + bin.path().string() + ":" + std::getenv("PATH")})
          .wait();
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_EQ(outcome.out, "collapse 101, join 102, tighten 103, publish 104\n");
  expect_the_same_bytes();
}

}  // namespace
}  // namespace ptin::tools
