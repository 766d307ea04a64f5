// SPDX-License-Identifier: GPL-3.0-or-later
//
// Progress on stderr: one line rewritten on a terminal, GDAL's sparse `0...10...20` otherwise.
#pragma once

#include <chrono>
#include <cstdint>
#include <cstdio>
#include <string>

namespace ptin::tools {

/// Shows how far a long piece of work is. One object a command; not thread-safe.
class Progress {
 public:
  enum class Style {
    kSilent,    ///< Nothing.
    kTerminal,  ///< One line, rewritten in place.
    kSparse,    ///< A line a stage: "stage: 0...10...20 ... 100 - done."
  };
  /// kSilent when `quiet`, else by whether `stream` is a terminal.
  [[nodiscard]] static Style style_for(bool quiet, std::FILE* stream);

  explicit Progress(Style style, std::FILE* stream = stderr) : style_(style), stream_(stream) {}
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;
  /// Ends an open line, so that what is printed next starts on its own.
  ~Progress();

  /// Says that `done` of `total` units of `stage` are done; total 0 means unknown. A new stage ends
  /// the one before.
  void report(const char* stage, std::uint64_t done, std::uint64_t total,
              const std::string& detail = "");
  /// Ends the current stage, if there is one.
  /// @param complete  On: a sparse line goes on to 100 and says "done". Off: it stops where it is.
  void finish(bool complete = true);

 private:
  void report_terminal(double share, const std::string& detail);
  void report_sparse(double share);

  Style style_;
  std::FILE* stream_;
  std::string stage_;
  int last_tick_ = -1;  ///< Sparse: the last of 0..40 printed. Terminal: the last per mille shown.
  std::chrono::steady_clock::time_point stage_start_{};
};

}  // namespace ptin::tools
