// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/ptin/answer_output.h"

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "engine/error.h"
#include "tools/formats/vector_file.h"
#include "tools/output/file_name.h"
#include "tools/output/output_file.h"
#include "tools/output/standard_output.h"
#include "tools/plot/canvas.h"

namespace ptin::tools {

void add_answer_options(CLI::App& app, AnswerOptions& options, AnswerKinds kinds) {
  std::string help = "Write .csv";
  if (kinds.layer) help += ", a layer (" + known_vector_extensions() + ")";
  if (kinds.plot) help += ",\na plot (" + known_picture_extensions() + ")";
  help += kinds.layer ? ", or - for\nGeoJSON on stdout; default: CSV to stdout"
                      : ", or - for CSV on\nstdout";
  app.add_option("-o,--output", options.output, help)->type_name("OUT");
  app.add_flag("--overwrite", options.overwrite, "Replace an existing output");
}

AnswerForm form_of(const AnswerOptions& options, bool json, AnswerKinds kinds) {
  if (options.output.empty()) return AnswerForm::kStdout;
  if (options.output == "-") {
    if (!json) return kinds.layer ? AnswerForm::kLayer : AnswerForm::kStdout;
    throw Error(ErrorCode::invalid_argument,
                "--json and -o - both write to stdout; give the answer a file name");
  }
  const std::string extension = lower_extension(options.output);
  AnswerForm form = AnswerForm::kLayer;
  if (extension == ".csv") {
    form = AnswerForm::kCsv;
  } else if (kinds.plot && is_picture_name(options.output)) {
    form = AnswerForm::kPlot;
  } else if (!kinds.layer || find_vector_format(options.output) == nullptr) {
    throw Error(ErrorCode::invalid_argument,
                "unknown format; end the name in .csv" +
                    (kinds.layer ? ", " + known_vector_extensions() : "") +
                    (kinds.plot ? ", " + known_picture_extensions() : "") + ", or write - for " +
                    (kinds.layer ? "GeoJSON" : "CSV") + " on stdout",
                options.output);
  }
  check_output(options.output, options.overwrite);
  return form;
}

void write_csv(const AnswerOptions& options, AnswerForm form, bool json, const std::string& text) {
  if (form == AnswerForm::kStdout && !json) write_to_stdout(text);
  if (form != AnswerForm::kCsv) return;
  OutputFile out(options.output, options.overwrite);
  out.write(text);
  out.publish();
}

nlohmann::json output_json(const AnswerOptions& options) {
  return options.output.empty() ? nlohmann::json() : nlohmann::json(options.output);
}

}  // namespace ptin::tools
