// SPDX-License-Identifier: GPL-3.0-or-later
//
// Where locate, profile, sight and volume put their answers: on stdout, in a table, a layer or a plot.
#pragma once

#include <cstdint>
#include <string>

#include <nlohmann/json_fwd.hpp>

#include "tools/ptin/command.h"

namespace ptin::tools {

/// -o and --overwrite.
struct AnswerOptions {
  std::string output;  ///< Empty: CSV on stdout.
  bool overwrite = false;
};
/// Kinds of files that a subcommand can write beside CSV.
struct AnswerKinds {
  bool layer = true;  ///< Then - is GeoJSON on stdout, else it is CSV there.
  bool plot = false;
};
void add_answer_options(CLI::App& app, AnswerOptions& options, AnswerKinds kinds = {});

enum class AnswerForm : std::uint8_t {
  kStdout,  ///< CSV on stdout.
  kCsv,
  kLayer,  ///< A format of tools/formats/vector_file.h, or GeoJSON on stdout.
  kPlot,   ///< A picture (tools/plot/canvas.h).
};
/// The form that is asked for. Called before the work, so that nobody waits for an answer that
/// cannot be kept.
/// @throws Error as check_output(); invalid_argument  unknown extension; both the answer and --json
///                                                    would go to stdout
[[nodiscard]] AnswerForm form_of(const AnswerOptions& options, bool json, AnswerKinds kinds = {});

/// Writes CSV where the form asks for it; nothing for other forms. With `json` stdout is taken.
/// @throws Error as OutputFile, as write_to_stdout()
void write_csv(const AnswerOptions& options, AnswerForm form, bool json, const std::string& text);

/// The name in JSON: null on stdout.
[[nodiscard]] nlohmann::json output_json(const AnswerOptions& options);

}  // namespace ptin::tools
