// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/ptin/model_options.h"

#include "engine/error.h"
#include "tools/facts/numbers.h"
#include "tools/facts/quantity.h"
#include "tools/output/file_name.h"

namespace ptin::tools {

namespace {

/// How many times smaller the model is; 0 where none was asked for.
double reduction_of(const ModelOptions& options) {
  if (options.scale.empty()) return 0;
  const bool has_one = options.scale.starts_with("1:");
  const auto number = quantity_of(has_one ? options.scale.substr(2) : options.scale);
  if (!number || !number->unit.empty() || !(number->number > 0)) {
    throw Error(ErrorCode::invalid_argument,
                "\"" + options.scale + "\" is no scale; write it as 1:25000, or as 25000",
                "--scale");
  }
  return number->number;
}

}  // namespace

void add_model_options(CLI::App& app, Measures& measures, ModelOptions& options) {
  measures
      .add(app, "--solid", options.base, MeasureKind::kHeight, NumberRange::kFinite,
           ".stl, .glb: a closed solid to print, with walls down to a flat base at this height")
      ->type_name("BASE");
  app.add_option("--scale", options.scale,
                 ".stl, .glb: a model at this scale, as 1:25000; an STL is in millimetres then")
      ->type_name("1:N");
  app.add_option("--exaggeration", options.exaggeration,
                 ".stl, .glb: heights are so many times as large")
      ->check(numbers(NumberRange::kPositive, ""))
      ->type_name("F")
      ->capture_default_str();
}

void check_model(const ModelOptions& options, const std::string& output) {
  const bool is_asked = options.base || !options.scale.empty() || options.exaggeration != 1;
  const std::string extension = lower_extension(output);
  if (is_asked && extension != ".stl" && extension != ".glb") {
    throw Error(ErrorCode::invalid_argument,
                "--solid, --scale and --exaggeration are for models: write .stl or .glb", output);
  }
  static_cast<void>(reduction_of(options));
}

void apply_model(const ModelOptions& options, const std::string& output,
                 std::array<double, 3>& metres_per_unit) {
  const double reduction = reduction_of(options);
  const double units_in_metre = lower_extension(output) == ".stl" ? 1000 : 1;
  const double factor = reduction > 0 ? units_in_metre / reduction : 1;
  for (double& unit : metres_per_unit) unit *= factor;
  metres_per_unit[2] *= options.exaggeration;
}

}  // namespace ptin::tools
