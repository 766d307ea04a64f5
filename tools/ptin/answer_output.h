// SPDX-License-Identifier: GPL-3.0-or-later
//
// Where locate, profile, sight and volume put their answers: on stdout, in a table, a layer or a plot.
#pragma once

#include <cstdint>
#include <string>

#include <nlohmann/json_fwd.hpp>

#include "tools/formats/vector_file.h"
#include "tools/ptin/query_options.h"

namespace ptin::tools {

/// Kinds of files that a subcommand can write beside CSV.
struct AnswerKinds {
  bool layer = true;  ///< Then - is GeoJSON on stdout, else it is CSV there.
  bool plot = false;
};
/// -o, without which CSV goes to stdout, and --overwrite.
void add_answer_output(ask::Parameters& rows, OutputOptions& options, AnswerKinds kinds = {});

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
[[nodiscard]] AnswerForm form_of(const OutputOptions& options, bool json, AnswerKinds kinds = {});

/// Writes CSV where the form asks for it; nothing for other forms. With `json` stdout is taken.
/// @throws Error as OutputFile, as write_to_stdout()
void write_csv(const OutputOptions& options, AnswerForm form, bool json, const std::string& text);

/// Writes rows as a layer or as CSV, where the form asks for one; with --json stdout is taken.
/// @param all   The fields, of which the form has some.
/// @param rows  How many there are. `row_at` and `geometry_at` make one by its number.
/// @throws Error as VectorFile, as write_csv()
template <typename Row, typename RowAt, typename GeometryAt>
void write_rows(const OutputOptions& out, AnswerForm form, const Context& context,
                VectorFile::Layer layer, const ask::Fields<Row>& all, std::size_t rows,
                const RowAt& row_at, const GeometryAt& geometry_at) {
  if (form == AnswerForm::kLayer) {
    const auto fields = all.told(ask::Told::kProgram & ask::Told::kFeature);
    layer.fields = ask::layer_fields_of(fields);
    warn_of_unnamed_crs(out, layer.crs, context);
    VectorFile file(out.output, out.overwrite, layer);
    for (std::size_t i = 0; i < rows; ++i) {
      file.add(geometry_at(i), ask::layer_values_of(fields.values_of(row_at(i))));
    }
    file.publish();
  } else if (form == AnswerForm::kCsv || !context.json) {
    ask::LongText text;
    ask::add_csv(text, all.told(ask::Told::kProgram & ask::Told::kTableRow), rows, row_at);
    write_csv(out, form, context.json, text.take());
  }
}
/// Rows as objects.
template <typename Row, typename RowAt>
[[nodiscard]] ask::Json objects_of(const ask::Fields<Row>& all, std::size_t rows,
                                   const RowAt& row_at) {
  const auto fields = all.told(ask::Told::kProgram & ask::Told::kObject);
  ask::Json objects = ask::Json::array();
  for (std::size_t i = 0; i < rows; ++i) objects.push_back(fields.object_of(row_at(i)));
  return objects;
}

/// The name in JSON: null on stdout.
[[nodiscard]] nlohmann::json output_json(const OutputOptions& options);

}  // namespace ptin::tools
