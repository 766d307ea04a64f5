// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/progress.h"

#include <algorithm>

#include <unistd.h>

namespace ptin::tools {

Progress::Style Progress::style_for(bool quiet, std::FILE* stream) {
  if (quiet) return Style::kSilent;
  return isatty(fileno(stream)) != 0 ? Style::kTerminal : Style::kSparse;
}

Progress::~Progress() { finish(false); }

void Progress::report(const char* stage, std::uint64_t done, std::uint64_t total,
                      const std::string& detail) {
  if (style_ == Style::kSilent) return;
  if (stage_ != stage) {
    finish();
    stage_ = stage;
    last_tick_ = -1;
    stage_start_ = std::chrono::steady_clock::now();
    if (style_ == Style::kSparse) std::fprintf(stream_, "%s: ", stage);
  }
  const double share =
      total == 0 ? 0.0 : std::min(1.0, static_cast<double>(done) / static_cast<double>(total));
  style_ == Style::kTerminal ? report_terminal(share, detail) : report_sparse(share);
  std::fflush(stream_);
}

void Progress::report_terminal(double share, const std::string& detail) {
  const int per_mille = static_cast<int>(share * 1000.0);
  if (per_mille == last_tick_) return;
  last_tick_ = per_mille;
  constexpr int kWidth = 30;
  const std::string bar(static_cast<std::size_t>(share * kWidth), '=');
  const double seconds =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - stage_start_).count();
  std::fprintf(stream_, "\r\x1b[K%-12s [%-*s] %5.1f %%", stage_.c_str(), kWidth, bar.c_str(),
               share * 100.0);
  if (!detail.empty()) {
    std::fprintf(stream_, "  %s", detail.c_str());
  }
  if (share > 0.02 && share < 1.0 && seconds > 1.0) {
    std::fprintf(stream_, "  %.0f s left", seconds / share - seconds);
  }
}

void Progress::report_sparse(double share) {
  const int tick = static_cast<int>(share * 40.0);
  while (last_tick_ < tick) {
    ++last_tick_;
    last_tick_ % 4 == 0 ? std::fprintf(stream_, "%d", last_tick_ / 4 * 10)
                        : std::fputc('.', stream_);
  }
}

void Progress::finish(bool complete) {
  if (stage_.empty()) return;
  if (style_ == Style::kTerminal) {
    std::fprintf(stream_, "\r\x1b[K");
  } else {
    if (complete) report_sparse(1.0);
    std::fprintf(stream_, complete ? " - done.\n" : "\n");
  }
  std::fflush(stream_);
  stage_.clear();
}

}  // namespace ptin::tools
