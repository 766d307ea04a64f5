// SPDX-License-Identifier: GPL-3.0-or-later
//
// Where locate, profile and sight put their answers: on stdout, in a table or in a layer.
#pragma once

#include <cstdint>
#include <string>

#include <nlohmann/json.hpp>

#include "tools/ptin/command.h"

namespace ptin::tools {

/// -o and --overwrite.
struct AnswerOptions {
  std::string output;  ///< Empty: CSV on stdout.
  bool overwrite = false;
};
/// @param also  Further formats, as ".png (a plot)"; may be empty.
void add_answer_options(CLI::App& app, AnswerOptions& options, const std::string& also = "");

enum class AnswerForm : std::uint8_t {
  kStdout,  ///< CSV on stdout.
  kCsv,
  kLayer,  ///< A format of tools/formats/vector_file.h, or GeoJSON on stdout.
  kOther,  ///< A further extension.
};
/// The form that is asked for. Called before the work, so that nobody waits for an answer that
/// cannot be kept.
/// @param other  A further extension that the subcommand writes, as ".png"; may be empty.
/// @throws Error as check_output(); invalid_argument  unknown extension; both the answer and --json
///                                                    would go to stdout
[[nodiscard]] AnswerForm form_of(const AnswerOptions& options, bool json,
                                 const std::string& other = "");

/// Writes CSV where the form asks for it; nothing for other forms. With `json` stdout is taken.
/// @throws Error as OutputFile, as write_to_stdout()
void write_csv(const AnswerOptions& options, AnswerForm form, bool json, const std::string& text);

/// The name in JSON: null on stdout.
[[nodiscard]] nlohmann::json output_json(const AnswerOptions& options);

}  // namespace ptin::tools
