// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/python/interruptible.h"

#include <chrono>
#include <vector>

#include "tools/python/binding.h"

namespace ptin::python {

namespace {

/// What is known of all questions. The GIL guards it.
struct Questions {
  std::vector<const Question*> running;
  unsigned long main_thread = 0;
  bool is_ending = false;
};

Questions& questions() {
  static Questions all;
  return all;
}

bool is_main_thread() noexcept { return PyThread_get_thread_ident() == questions().main_thread; }

/// Stops what runs, and waits until its threads have the GIL again; Ctrl-C ends the waiting.
void end_all() {
  constexpr std::chrono::milliseconds kBetweenLooks{1};
  Questions& all = questions();
  all.is_ending = true;
  while (!all.running.empty()) {
    std::vector<std::stop_source> stops;
    for (const Question* const question : all.running) stops.push_back(question->stop());
    {
      const py::gil_scoped_release release;
      for (std::stop_source& stop : stops) stop.request_stop();
      std::this_thread::sleep_for(kBetweenLooks);
    }
    if (PyErr_CheckSignals() != 0) raise_what_is_set();
  }
}

/// The child of a fork has the thread that forked, and none that answers.
void begin_anew_in_child() {
  questions().running.clear();
  questions().main_thread = PyThread_get_thread_ident();
}

}  // namespace

Question::Question(std::stop_source stop) : stop_(std::move(stop)) {
  exit_if_ended_by_python();
  questions().running.push_back(this);
}

Question::~Question() { std::erase(questions().running, this); }

bool Question::wait(std::unique_lock<std::mutex>& lock, std::condition_variable& changed,
                    const std::function<bool()>& is_done) {
  constexpr std::chrono::milliseconds kBetweenLooks{50};
  const bool has_signals = is_main_thread();
  const py::gil_scoped_release release;
  if (!has_signals) {
    changed.wait(lock, is_done);
    return false;
  }
  while (!changed.wait_for(lock, kBetweenLooks, is_done)) {
    // The worker may wait for the GIL while it holds nothing of this mutex; the other way round
    // both would wait.
    lock.unlock();
    bool is_interrupted = false;
    {
      const py::gil_scoped_acquire acquire;
      is_interrupted = PyErr_CheckSignals() != 0;
    }
    lock.lock();
    if (!is_interrupted) continue;
    stop_.request_stop();
    changed.wait(lock, is_done);
    return true;
  }
  return false;
}

bool is_ended_by_python() noexcept { return questions().is_ending && !is_main_thread(); }

void exit_if_ended_by_python() {
  if (!is_ended_by_python()) return;
  PyErr_SetNone(PyExc_SystemExit);
  raise_what_is_set();
}

void raise_what_is_set() { throw py::error_already_set(); }

void add_questions(py::module_& /*module*/) {
  const py::object main = py::module_::import("threading").attr("main_thread")();
  questions().main_thread = main.attr("ident").cast<unsigned long>();
  py::module_::import("atexit").attr("register")(py::cpp_function(end_all));
  py::module_::import("os").attr("register_at_fork")(py::arg("after_in_child") =
                                                         py::cpp_function(begin_anew_in_child));
}

}  // namespace ptin::python
