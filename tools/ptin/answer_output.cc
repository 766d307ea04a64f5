// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/ptin/answer_output.h"

#include "engine/error.h"
#include "tools/formats/vector_file.h"
#include "tools/output/file_name.h"
#include "tools/output/output_file.h"
#include "tools/output/standard_output.h"
#include "tools/plot/canvas.h"

namespace ptin::tools {

void add_answer_options(CLI::App& app, AnswerOptions& options, bool has_plot) {
  app.add_option("-o,--output", options.output,
                 "Write .csv, a layer (" + known_vector_extensions() + ")" +
                     (has_plot ? ",\na plot (" + known_picture_extensions() + ")" : "") +
                     ", or - for\nGeoJSON on stdout; default: CSV to stdout")
      ->type_name("OUT");
  app.add_flag("--overwrite", options.overwrite, "Replace an existing output");
}

AnswerForm form_of(const AnswerOptions& options, bool json, bool has_plot) {
  if (options.output.empty()) return AnswerForm::kStdout;
  if (options.output == "-") {
    if (!json) return AnswerForm::kLayer;
    throw Error(ErrorCode::invalid_argument,
                "--json and -o - both write to stdout; give the answer a file name");
  }
  const std::string extension = lower_extension(options.output);
  AnswerForm form = AnswerForm::kLayer;
  if (extension == ".csv") {
    form = AnswerForm::kCsv;
  } else if (has_plot && is_picture_name(options.output)) {
    form = AnswerForm::kPlot;
  } else if (find_vector_format(options.output) == nullptr) {
    throw Error(ErrorCode::invalid_argument,
                "unknown format; end the name in .csv, " + known_vector_extensions() +
                    (has_plot ? ", " + known_picture_extensions() : "") +
                    ", or write - for GeoJSON on stdout",
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
