// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/ptin/stop_on_signals.h"

#include <chrono>
#include <csignal>
#include <thread>

#include <pthread.h>

namespace ptin::tools {

namespace {

/// Waits for signals on a thread of its own, since a stop may not be requested in a signal handler.
void wait_for_signals(sigset_t signals, std::stop_source stop) {
  int signal = 0;
  sigwait(&signals, &signal);
  stop.request_stop();
  const auto asked = std::chrono::steady_clock::now();
  do {  // `timeout` and terminals signal a process and its group: twice within a moment is once
    sigwait(&signals, &signal);
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

}  // namespace ptin::tools
