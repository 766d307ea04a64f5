// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/measure/measure_io.h"

#include <chrono>

#include "tools/measure/device_speed.h"
#include "tools/measure/io_run.h"

namespace ptin::tools {

IoReport measure_io(const IoRequest& request) {
  const auto begin = std::chrono::steady_clock::now();
  IoRun run(request);
  IoReport report;
  report.file_bytes = run.cache().file_bytes();
  report.file_system = run.cache().file_system();
  report.why_not_cold = run.why_not_cold();
  report.why_no_uring = run.why_no_uring();
  report.has_device_bytes = run.has_device_bytes();
  if (report.why_not_cold.empty()) {
    run.tell("device", 0.0);
    report.device = measure_device(request.file, request.stop);
  }
  run_questions(run, 0.65 * request.seconds, report);
  run_threads(run, 0.15 * request.seconds, report);
  run_indexes(run, 0.15 * request.seconds, report);
  report.seconds = seconds_since(begin);
  return report;
}

}  // namespace ptin::tools
