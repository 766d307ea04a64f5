// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/tools/program.h"

#include <algorithm>
#include <csignal>
#include <cstdio>
#include <fstream>
#include <iostream>
#include <sstream>
#include <stdexcept>
#include <thread>

#include <fcntl.h>
#include <gtest/gtest.h>
#include <spawn.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include "tools/ptin/cli.h"

extern char** environ;

namespace ptin::tools::testing {

namespace {

/// Starts the program with stdin, stdout and stderr in files; returns its process.
pid_t start_ptin(const std::vector<std::string>& arguments, const std::string& out,
                 const std::string& err, const std::string& in = "/dev/null") {
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addopen(&actions, 0, in.c_str(), O_RDONLY, 0);
  posix_spawn_file_actions_addopen(&actions, 1, out.c_str(), O_WRONLY | O_CREAT, 0600);
  posix_spawn_file_actions_addopen(&actions, 2, err.c_str(), O_WRONLY | O_CREAT, 0600);
  std::vector<char*> argv{const_cast<char*>(PTIN_PROGRAM)};
  for (const std::string& argument : arguments) argv.push_back(const_cast<char*>(argument.c_str()));
  argv.push_back(nullptr);
  pid_t child = 0;
  const int spawned = posix_spawn(&child, PTIN_PROGRAM, &actions, nullptr, argv.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  if (spawned != 0) throw std::runtime_error("cannot run " PTIN_PROGRAM);
  return child;
}

int status_of(pid_t child) {
  int status = 0;
  waitpid(child, &status, 0);
  return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

bool has_ended(pid_t child) {
  siginfo_t info{};
  return ::waitid(P_PID, static_cast<id_t>(child), &info, WEXITED | WNOHANG | WNOWAIT) != 0 ||
         info.si_pid == child;
}

/// Has the streams of this process go elsewhere while it lives.
class RedirectedStreams {
 public:
  RedirectedStreams(const std::string& out, const std::string& err) {
    flush();
    for (int fd = 0; fd < 3; ++fd) before_[fd] = ::fcntl(fd, F_DUPFD_CLOEXEC, 3);
    redirect(0, "/dev/null", O_RDONLY);
    redirect(1, out, O_WRONLY | O_CREAT | O_TRUNC);
    redirect(2, err, O_WRONLY | O_CREAT | O_TRUNC);
  }
  RedirectedStreams(const RedirectedStreams&) = delete;
  RedirectedStreams& operator=(const RedirectedStreams&) = delete;
  ~RedirectedStreams() {
    flush();
    for (int fd = 0; fd < 3; ++fd) {
      ::dup2(before_[fd], fd);
      ::close(before_[fd]);
    }
  }

 private:
  static void flush() {
    std::cout.flush();
    std::fflush(stdout);
    std::fflush(stderr);
  }
  static void redirect(int fd, const std::string& path, int flags) {
    const int file = ::open(path.c_str(), flags | O_CLOEXEC, 0600);
    if (file < 0) return;  // what is said then shows that nothing was redirected
    ::dup2(file, fd);
    ::close(file);
  }
  int before_[3] = {-1, -1, -1};
};

}  // namespace

Outcome run_ptin(const std::vector<std::string>& arguments) {
  const TestFolder folder;
  std::vector<const char*> argv{"ptin"};
  for (const std::string& argument : arguments) argv.push_back(argument.c_str());
  Outcome outcome;
  {
    const RedirectedStreams streams(folder.file("out"), folder.file("err"));
    Context context;
    outcome.status = run_program(static_cast<int>(argv.size()), argv.data(), context);
  }
  outcome.out = read_file(folder.file("out"));
  outcome.err = read_file(folder.file("err"));
  return outcome;
}

namespace {

/// A set of signals that /proc tells of a process; 0 when it has ended.
std::uint64_t signals_of(const std::string& status, const std::string& set) {
  const std::size_t at = status.find(set);
  return at == std::string::npos ? 0 : std::stoull(status.substr(at + set.size(), 18), nullptr, 16);
}

/// Waits until a process takes a signal in its own way, by a handler or by a thread that waits for
/// it, or has ended: before that the signal would end it untidily.
void await_readiness(pid_t child, int signal) {
  while (signal != SIGKILL && !has_ended(child)) {
    const std::string status = read_file("/proc/" + std::to_string(child) + "/status");
    const std::uint64_t taken = signals_of(status, "SigCgt:") | signals_of(status, "SigBlk:");
    if ((taken >> (signal - 1) & 1) != 0) return;
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
}

/// Waits until a process has worked for so long, whatever else the machine does meanwhile, or has
/// ended.
void await_work(pid_t child, std::chrono::milliseconds time) {
  clockid_t clock{};
  if (::clock_getcpuclockid(child, &clock) != 0) return;
  while (!has_ended(child)) {
    timespec worked{};
    if (::clock_gettime(clock, &worked) != 0) return;
    if (std::chrono::seconds(worked.tv_sec) + std::chrono::nanoseconds(worked.tv_nsec) >= time) {
      return;
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
}

/// Waits until the output of a process holds a text, or it has ended.
std::string await_output(pid_t child, const TestFolder& folder, const std::string& told) {
  while (true) {
    const bool is_over = has_ended(child);
    std::string out = read_file(folder.file("out"));
    if (is_over || out.find(told) != std::string::npos) return out;
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
}

Outcome outcome_of(pid_t child, const TestFolder& folder) {
  rusage used{};
  int status = 0;
  ::wait4(child, &status, 0, &used);
  Outcome outcome;
  outcome.status = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  outcome.worked =
      std::chrono::milliseconds((used.ru_utime.tv_sec + used.ru_stime.tv_sec) * 1000 +
                                (used.ru_utime.tv_usec + used.ru_stime.tv_usec) / 1000);
  outcome.out = read_file(folder.file("out"));
  outcome.err = read_file(folder.file("err"));
  return outcome;
}

}  // namespace

Outcome spawn_ptin(const std::vector<std::string>& arguments, std::optional<int> signal,
                   std::chrono::milliseconds after) {
  const TestFolder folder;
  const pid_t child = start_ptin(arguments, folder.file("out"), folder.file("err"));
  if (signal) {
    await_readiness(child, *signal);
    await_work(child, after);
    kill(child, *signal);
  }
  return outcome_of(child, folder);
}

Outcome spawn_ptin_until(const std::string& told, int signal,
                         const std::vector<std::string>& arguments) {
  const TestFolder folder;
  const pid_t child = start_ptin(arguments, folder.file("out"), folder.file("err"));
  static_cast<void>(await_output(child, folder, told));
  kill(child, signal);
  return outcome_of(child, folder);
}

StartedPtin::StartedPtin(const std::vector<std::string>& arguments)
    : process_(start_ptin(arguments, folder_.file("out"), folder_.file("err"))) {}

StartedPtin::~StartedPtin() {
  ::kill(process_, SIGTERM);
  status_of(process_);
}

std::string StartedPtin::err() const { return read_file(folder_.file("err")); }

void StartedPtin::send(int signal) const { ::kill(process_, signal); }

std::string StartedPtin::out_with(const std::string& text) const {
  return await_output(process_, folder_, text);
}

Outcome spawn_ptin_into(const std::string& output, const std::vector<std::string>& arguments) {
  const TestFolder folder;
  Outcome outcome;
  outcome.status = status_of(start_ptin(arguments, output, folder.file("err")));
  outcome.err = read_file(folder.file("err"));
  return outcome;
}

Outcome spawn_ptin_reading(const std::string& input, const std::vector<std::string>& arguments) {
  const TestFolder folder;
  write_file(folder.file("in"), input);
  Outcome outcome;
  outcome.status =
      status_of(start_ptin(arguments, folder.file("out"), folder.file("err"), folder.file("in")));
  outcome.out = read_file(folder.file("out"));
  outcome.err = read_file(folder.file("err"));
  return outcome;
}

std::size_t lines_in(const std::string& text) {
  std::istringstream in(text);
  std::string line;
  std::size_t count = 0;
  while (std::getline(in, line)) count += !line.empty();
  return count;
}

nlohmann::json answer_of(const std::vector<std::string>& arguments) {
  const Outcome outcome = run_ptin(arguments);
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  return nlohmann::json::parse(outcome.out, nullptr, false);
}

void expect_done(const std::vector<std::string>& arguments) {
  const Outcome outcome = run_ptin(arguments);
  ASSERT_EQ(outcome.status, 0) << outcome.err;
}

}  // namespace ptin::tools::testing
