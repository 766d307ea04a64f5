// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/python/interruptible.h"

#include <chrono>

#include <pybind11/pybind11.h>

namespace ptin::python {

namespace py = pybind11;

bool wait_for_signals_too(std::unique_lock<std::mutex>& lock, std::condition_variable& changed,
                          std::stop_source& stop, const std::function<bool()>& is_done) {
  constexpr std::chrono::milliseconds kBetweenLooks{50};
  const py::gil_scoped_release release;
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
    stop.request_stop();
    changed.wait(lock, is_done);
    return true;
  }
  return false;
}

void raise_what_is_set() { throw py::error_already_set(); }

}  // namespace ptin::python
