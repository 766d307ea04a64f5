// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/tools/mpi_run.h"

#include <algorithm>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <memory>
#include <random>
#include <sstream>
#include <stdexcept>
#include <thread>

#include <fcntl.h>
#include <gtest/gtest.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

extern char** environ;

namespace ptin::tools::testing {

namespace {

std::vector<char*> pointers_to(const std::vector<std::string>& texts) {
  std::vector<char*> pointers;
  for (const std::string& text : texts) pointers.push_back(const_cast<char*>(text.c_str()));
  return pointers;
}

std::string points_as_text(int count) {
  std::mt19937 random(9);
  std::string text;
  for (int i = 0; i < count; ++i) {
    const auto x = random() % 20000, y = random() % 20000;
    text += std::to_string(x) + " " + std::to_string(y) + " " +
            std::to_string((x / 9 + y / 13) % 700) + "\n";
  }
  return text;
}

/// Squares of two triangles, as OBJ.
std::string triangles_as_text(int side) {
  std::string text;
  for (int i = 0; i < side * side; ++i) {
    const int x = i % side, y = i / side;
    text += "v " + std::to_string(x * 10 + y % 3) + " " + std::to_string(y * 10 + x % 4) + " " +
            std::to_string(hills(x, y)) + "\n";
  }
  for (int i = 0; i < side * (side - 1); ++i) {
    if (i % side == side - 1) continue;
    const std::string a = std::to_string(i + 1), b = std::to_string(i + 2),
                      c = std::to_string(i + side + 2), d = std::to_string(i + side + 1);
    text += "f " + a + " " + b + " " + c + "\nf " + a + " " + c + " " + d + "\n";
  }
  return text;
}

}  // namespace

StartedProgram::StartedProgram(const std::vector<std::string>& command,
                               const std::vector<std::string>& environment) {
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addopen(&actions, 0, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_addopen(&actions, 1, folder_.file("out").c_str(), O_WRONLY | O_CREAT,
                                   0600);
  posix_spawn_file_actions_addopen(&actions, 2, folder_.file("err").c_str(), O_WRONLY | O_CREAT,
                                   0600);
  // Programs of Open MPI that start side by side take the folder of their session from each other
  // (github.com/open-mpi/ompi/issues/8510), so each gets a place of its own.
  std::vector<std::string> own = environment;
  own.push_back("OMPI_MCA_orte_tmpdir_base=" + folder_.path().string());
  std::vector<char*> argv = pointers_to(command), envp = pointers_to(own);
  argv.push_back(nullptr);
  for (char** variable = environ; *variable != nullptr; ++variable) {
    const std::string text = *variable;
    const std::string name = text.substr(0, text.find('=') + 1);
    const bool is_replaced =
        std::any_of(own.begin(), own.end(), [&](const auto& e) { return e.starts_with(name); });
    if (!is_replaced) envp.push_back(*variable);
  }
  envp.push_back(nullptr);
  const int spawned = posix_spawnp(&pid_, argv[0], &actions, nullptr, argv.data(), envp.data());
  posix_spawn_file_actions_destroy(&actions);
  if (spawned != 0) throw std::runtime_error("cannot run " + command.front());
}

StartedProgram::~StartedProgram() {
  if (is_running()) {
    ::kill(pid_, SIGKILL);
    ::waitpid(pid_, nullptr, 0);
  }
}

std::vector<pid_t> StartedProgram::children() const {
  std::vector<pid_t> found;
  std::error_code ignored;
  const std::string tasks = "/proc/" + std::to_string(pid_) + "/task";
  for (const auto& thread : std::filesystem::directory_iterator(tasks, ignored)) {
    std::ifstream list(thread.path() / "children");
    for (pid_t child = 0; list >> child;) found.push_back(child);
  }
  return found;
}

bool StartedProgram::is_running() {
  int status = 0;
  if (!has_ended_ && ::waitpid(pid_, &status, WNOHANG) == pid_) {
    has_ended_ = true;
    status_ = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  }
  return !has_ended_;
}

Outcome StartedProgram::wait() {
  const auto until = std::chrono::steady_clock::now() + std::chrono::minutes(2);
  while (is_running() && std::chrono::steady_clock::now() < until) {
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  if (is_running()) {
    ADD_FAILURE() << "still running after two minutes";
    ::kill(pid_, SIGKILL);
    ::waitpid(pid_, nullptr, 0);
    has_ended_ = true;
  }
  return {status_, read_file(folder_.file("out")), read_file(folder_.file("err"))};
}

std::string mpi_program() {
  const std::string beside = PTIN_PROGRAM "_with_mpi";
  return std::filesystem::exists(beside) ? beside : PTIN_PROGRAM;
}

std::vector<std::string> mpi_environment() {
  return {"OMPI_ALLOW_RUN_AS_ROOT=1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1",
          "OMPI_MCA_btl_vader_single_copy_mechanism=none"};
}

std::vector<std::string> mpirun(const std::vector<std::string>& arguments) {
  std::vector<std::string> command{"mpirun", "--oversubscribe", "--bind-to", "none"};
  command.insert(command.end(), arguments.begin(), arguments.end());
  return command;
}

const std::string& why_no_mpi() {
  static const std::string why = []() -> std::string {
    if (mpi_program() == PTIN_PROGRAM) {
#ifndef PTIN_MPI
      return "needs the program with MPI (Debian packages libopenmpi-dev, openmpi-bin; not under "
             "sanitizers)";
#endif
    }
    try {
      const Outcome tried = StartedProgram(mpirun({"-n", "2", "true"}), mpi_environment()).wait();
      return tried.status == 0 ? "" : "needs an mpirun that runs two processes: " + tried.err;
    } catch (const std::runtime_error&) {
      return "needs mpirun (Debian package openmpi-bin)";
    }
  }();
  return why;
}

Outcome run_ranks(int ranks, const std::vector<std::string>& arguments) {
  std::vector<std::string> command = mpirun({"-n", std::to_string(ranks), mpi_program()});
  if (ranks == 0) command = {mpi_program()};
  command.insert(command.end(), arguments.begin(), arguments.end());
  return StartedProgram(command, mpi_environment()).wait();
}

std::vector<std::string> ClusterSource::build(const std::string& output,
                                              const std::vector<std::string>& more) const {
  std::vector<std::string> arguments{"build", input, "-o", output, "-q"};
  arguments.insert(arguments.end(), options.begin(), options.end());
  arguments.insert(arguments.end(), more.begin(), more.end());
  return arguments;
}

ClusterSource cluster_source(const TestFolder& folder, const std::string& kind) {
  if (kind == "raster") return {test_data("mountains_257.tif"), {"--tile", "32"}};
  if (kind == "points") {
    write_file(folder.file("points.xyz"), points_as_text(20000));
    return {folder.file("points.xyz"), {"--tile", "30"}};
  }
  write_file(folder.file("mesh.obj"), triangles_as_text(100));
  return {folder.file("mesh.obj"), {"--tile", "20"}};
}

void expect_same_bytes_on_ranks(const std::string& kind, const std::vector<int>& ranks) {
  SCOPED_TRACE(kind);
  const TestFolder folder;
  const ClusterSource source = cluster_source(folder, kind);
  const std::string output = folder.file("a.ptin");
  std::string expected;
  for (const std::string threads : {"1", "2"}) {
    expect_done(source.build(output, {"--threads", threads, "--overwrite"}));
    EXPECT_TRUE(expected.empty() || read_file(output) == expected);
    expected = read_file(output);
  }
  for (const int number : ranks) {
    const Outcome outcome = run_ranks(number, source.build(output, {"--overwrite"}));
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    EXPECT_TRUE(read_file(output) == expected) << number;
    EXPECT_FALSE(std::filesystem::exists(folder.file(".a.ptin.ptin-build")));
  }
}

namespace {

/// Waits until a build of this name in the folder has begun, or has ended.
void await_begin(StartedProgram& program, const TestFolder& folder, const std::string& name) {
  const std::string manifest = folder.file("." + name + ".ptin-build/manifest");
  while (program.is_running() && !std::filesystem::exists(manifest)) {
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
}

}  // namespace

void expect_kills_lose_nothing(const std::string& kind, int times) {
  const TestFolder folder;
  const ClusterSource source = cluster_source(folder, kind);
  const std::string plain = folder.file("plain.ptin"), killed_one = folder.file("k.ptin");
  const auto started = [&](const std::vector<std::string>& build) {
    std::vector<std::string> command = mpirun({"-n", "3", mpi_program()});
    command.insert(command.end(), build.begin(), build.end());
    return std::make_unique<StartedProgram>(command, mpi_environment());
  };
  const auto undisturbed = started(source.build(plain));
  await_begin(*undisturbed, folder, "plain.ptin");
  const auto begin = std::chrono::steady_clock::now();
  const Outcome first = undisturbed->wait();
  ASSERT_EQ(first.status, 0) << first.err;
  const auto whole = std::chrono::duration_cast<std::chrono::milliseconds>(
      std::chrono::steady_clock::now() - begin);
  const std::string expected = read_file(plain);
  std::mt19937 random(static_cast<unsigned>(times));
  int killed = 0;
  // A build that was through before its moment counts for nothing; on a busy machine many are.
  for (int moment = 0; moment < 20 * times && killed < times; ++moment) {
    const auto program = started(source.build(killed_one, {"--resume"}));
    // Some are killed before they have begun, and do not count: to start takes the ranks long.
    if (moment % 4 != 3) await_begin(*program, folder, "k.ptin");
    std::this_thread::sleep_for(
        std::chrono::milliseconds(random() % static_cast<unsigned>(whole.count() + 1)));
    const std::vector<pid_t> ranks = program->children();
    const bool has_begun = std::filesystem::exists(folder.file(".k.ptin.ptin-build/manifest"));
    if (!ranks.empty()) ::kill(ranks[random() % ranks.size()], SIGKILL);
    const Outcome outcome = program->wait();
    killed += outcome.status != 0 && has_begun ? 1 : 0;
    const bool is_complete = std::filesystem::exists(killed_one);
    EXPECT_TRUE(!is_complete || read_file(killed_one) == expected);
    if (outcome.status != 0) {
      constexpr int kRanks[] = {0, 2, 4};
      const Outcome resumed =
          run_ranks(kRanks[random() % 3], source.build(killed_one, {"--resume"}));
      EXPECT_TRUE(resumed.status == 0 || (is_complete && resumed.status == 2)) << resumed.err;
    }
    EXPECT_TRUE(read_file(killed_one) == expected);
    std::filesystem::remove(killed_one);
    EXPECT_FALSE(std::filesystem::exists(folder.file(".k.ptin.ptin-build")));
  }
  EXPECT_EQ(killed, times);
}

}  // namespace ptin::tools::testing
