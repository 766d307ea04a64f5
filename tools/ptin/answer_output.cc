// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/ptin/answer_output.h"

#include <utility>

#include "engine/error.h"
#include "tools/formats/vector_file.h"
#include "tools/output/file_name.h"
#include "tools/output/output_file.h"
#include "tools/output/standard_output.h"
#include "tools/plot/canvas.h"

namespace ptin::tools {

void add_answer_output(ask::Parameters& rows, OutputOptions& options, AnswerKinds kinds) {
  std::string help = "Write .csv";
  if (kinds.layer) help += ", a layer (" + known_vector_extensions() + ")";
  if (kinds.plot) help += ", a plot (" + known_picture_extensions() + ")";
  help += kinds.layer ? ", or - for GeoJSON on stdout; default: CSV to stdout"
                      : ", or - for CSV on stdout";
  add_output(rows, options, std::move(help), false);
}

AnswerForm form_of(const OutputOptions& options, bool json, AnswerKinds kinds) {
  if (options.output.empty()) return AnswerForm::kStdout;
  if (options.output == "-") {
    check_file_or_stdout(options, "the answer", json);
    return kinds.layer ? AnswerForm::kLayer : AnswerForm::kStdout;
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

void write_csv(const OutputOptions& options, AnswerForm form, bool json, const std::string& text) {
  if (form == AnswerForm::kStdout && !json) write_to_stdout(text);
  if (form != AnswerForm::kCsv) return;
  OutputFile out(options.output, options.overwrite);
  out.write(text);
  out.publish();
}

nlohmann::json output_json(const OutputOptions& options) {
  return options.output.empty() ? nlohmann::json() : nlohmann::json(options.output);
}

}  // namespace ptin::tools
