// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/ptin/stop_on_signals.h"

#include <chrono>
#include <csignal>
#include <functional>
#include <mutex>
#include <thread>
#include <utility>

#include <pthread.h>

namespace ptin::tools {

namespace {

struct HangUp {
  std::mutex mutex;  ///< Held while it is called: it is not taken away meanwhile.
  std::function<void()> then;
};

/// Never destroyed: the thread of signals outlives main().
HangUp& hang_up() {
  static auto* const one = new HangUp;
  return *one;
}

/// The next signal that stops.
int next_stop(const sigset_t& signals) {
  while (true) {
    int signal = 0;
    sigwait(&signals, &signal);
    if (signal != SIGHUP) return signal;
    const std::scoped_lock lock(hang_up().mutex);
    if (!hang_up().then) return signal;
    hang_up().then();
  }
}

/// Waits for signals on a thread of its own, since a stop may not be requested in a signal handler.
void wait_for_signals(sigset_t signals, std::stop_source stop) {
  int signal = next_stop(signals);
  stop.request_stop();
  const auto asked = std::chrono::steady_clock::now();
  do {  // `timeout` and terminals signal a process and its group: twice within a moment is once
    signal = next_stop(signals);
  } while (std::chrono::steady_clock::now() - asked < std::chrono::milliseconds(300));
  std::signal(signal, SIG_DFL);
  pthread_sigmask(SIG_UNBLOCK, &signals, nullptr);
  raise(signal);
}

}  // namespace

std::stop_token stop_on_signals() {
  std::signal(SIGXFSZ, SIG_IGN);  // a write beyond RLIMIT_FSIZE fails with EFBIG instead
  sigset_t signals;
  sigemptyset(&signals);
  sigaddset(&signals, SIGINT);
  sigaddset(&signals, SIGTERM);
  struct sigaction hangup {};
  sigaction(SIGHUP, nullptr, &hangup);
  if (hangup.sa_handler != SIG_IGN) sigaddset(&signals, SIGHUP);  // nohup stays in force
  pthread_sigmask(SIG_BLOCK, &signals, nullptr);  // threads started later inherit this
  const std::stop_source stop;
  std::thread(wait_for_signals, signals, stop).detach();
  return stop.get_token();
}

OnHangUp::OnHangUp(std::function<void()> then) {
  const std::scoped_lock lock(hang_up().mutex);
  hang_up().then = std::move(then);
}

OnHangUp::~OnHangUp() {
  const std::scoped_lock lock(hang_up().mutex);
  hang_up().then = nullptr;
}

}  // namespace ptin::tools
