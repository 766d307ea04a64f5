// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/ptin/model_options.h"

#include <optional>

#include "engine/error.h"
#include "engine/number.h"
#include "tools/output/file_name.h"

namespace ptin::tools {

namespace {

/// How many times smaller a model is.
double reduction_of(const std::string& text) {
  const std::optional<double> number =
      parse_number<double>(ask::trimmed(text.starts_with("1:") ? text.substr(2) : text));
  if (number && NumberRange::kPositive.holds(*number)) return *number;
  refuse("\"" + text + "\" is no scale; write it as 1:25000, or as 25000");
}

}  // namespace

void add_model(ask::Parameters& rows, ModelOptions& options) {
  rows.add("solid", &options.base, "BASE",
           ".stl, .glb: a closed solid to print, with walls down to a flat base at this height")
      .in(ask::Unit::kHeight);
  rows.add(
      "scale", [&options](const std::string& text) { options.reduction = reduction_of(text); },
      "1:N", ".stl, .glb: a model at this scale, as 1:25000; an STL is in millimetres then");
  rows.add("exaggeration", &options.exaggeration, "F",
           ".stl, .glb: heights are so many times as large")
      .within(NumberRange::kPositive)
      .with_default();
}

void check_model(const ModelOptions& options, const std::string& output) {
  const bool is_asked = options.base || options.reduction > 0 || options.exaggeration != 1;
  const std::string extension = lower_extension(output);
  if (is_asked && extension != ".stl" && extension != ".glb") {
    throw Error(ErrorCode::invalid_argument,
                "--solid, --scale and --exaggeration are for models: write .stl or .glb", output);
  }
}

void apply_model(const ModelOptions& options, const std::string& output,
                 std::array<double, 3>& metres_per_unit) {
  const double units_in_metre = lower_extension(output) == ".stl" ? 1000 : 1;
  const double factor = options.reduction > 0 ? units_in_metre / options.reduction : 1;
  for (double& unit : metres_per_unit) unit *= factor;
  metres_per_unit[2] *= options.exaggeration;
}

}  // namespace ptin::tools
