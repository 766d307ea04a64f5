// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/build_option_table.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <tuple>
#include <type_traits>

#include <nlohmann/json.hpp>

#include "engine/construct/read/class_names.h"
#include "engine/construct/read/column_names.h"
#include "engine/crs/base_map.h"
#include "engine/crs/credits.h"
#include "engine/error.h"

namespace ptin {

namespace {

// Words in the order of their enumerations.
constexpr std::array kCosts{"error", "roi", "elevation"};
constexpr std::array kMerges{"mean", "min", "max", "first"};
constexpr std::array kReturns{"all", "first", "last"};

constexpr WordOption kCostWords{
    kCosts, [](const BuildOptions& o) { return std::optional(static_cast<std::size_t>(o.cost)); },
    [](BuildOptions& o, std::size_t i) { o.cost = static_cast<CostModel>(i); }};
constexpr WordOption kMergeWords{
    kMerges,
    [](const BuildOptions& o) {
      return o.duplicates ? std::optional(static_cast<std::size_t>(*o.duplicates)) : std::nullopt;
    },
    [](BuildOptions& o, std::size_t i) { o.duplicates = static_cast<PointMerge>(i); }};
constexpr WordOption kReturnWords{
    kReturns,
    [](const BuildOptions& o) { return std::optional(static_cast<std::size_t>(o.returns)); },
    [](BuildOptions& o, std::size_t i) { o.returns = static_cast<ReturnChoice>(i); }};

const char* fault_of_bbox(const BuildOptions& o) {
  const bool is_one = !o.bbox || ((*o.bbox)[0] < (*o.bbox)[2] && (*o.bbox)[1] < (*o.bbox)[3]);
  return is_one ? nullptr : "the bbox is inverted or empty; its order is xmin ymin xmax ymax";
}

const char* fault_of_tile(const BuildOptions& o) {
  const bool is_one = !o.tile || (*o.tile >= 2 && *o.tile <= (std::int64_t{1} << 20));
  return is_one ? nullptr : "a tile must be 2 to 1,048,576 grid units along a side";
}

/// Names of columns are looked up, which throws by itself.
const char* fault_of_columns(const BuildOptions& o) {
  if (!o.columns.empty()) {
    std::ignore = columns_of(o.columns, point_roles());
  }
  return nullptr;
}

const char* fault_of_breakline_layer(const BuildOptions& o) {
  return o.breakline_layer.empty() || !o.breaklines.empty()
             ? nullptr
             : "--breakline-layer is for files that --breaklines names; name them, or leave it out";
}

const char* fault_of_boundary_layer(const BuildOptions& o) {
  return o.boundary_layer.empty() || !o.boundary.empty()
             ? nullptr
             : "--boundary-layer is for the file that --boundary names; name it, or leave it out";
}

const char* fault_of_title(const BuildOptions& o) {
  return is_credit(o.title) ? nullptr
                            : "a title is at most 1,000 bytes of UTF-8 without control characters";
}

const char* fault_of_attribution(const BuildOptions& o) {
  return is_credit(o.attribution)
             ? nullptr
             : "an attribution is at most 1,000 bytes of UTF-8 without control characters";
}

const char* fault_of_base_map(const BuildOptions& o) {
  return fault_of(BaseMap{o.base_map, o.base_map_attribution});
}

using Option = BuildOption;
using Options = BuildOptions;
constexpr unsigned kPointsAndRepaired = Option::kPoints | Option::kRepairedTins;
constexpr const char* kForPointsAndRepaired = "points, and for TINs with --repair";

const std::vector<BuildOption>& table() {
  static const std::vector<BuildOption> kTable{
      {.name = "nodata",
       .help = "This stored value (before scale and offset) means void; overrides the source's",
       .field = &Options::nodata,
       .value = "V",
       .is_always_kept = true},
      {.name = "resolution",
       .help = "Points, TINs: the grid unit, in CRS units",
       .field = &Options::resolution,
       .value = "R",
       .range = NumberRange::kPositive,
       .unit = "in CRS units",
       .noun = "the resolution",
       .inputs = Option::kPoints | Option::kTins | Option::kRepairedTins,
       .is_for = "points and TINs",
       .is_always_kept = true},
      {.name = "class",
       .help =
           "LAS: keep points of these classes, as ground, or 2,8-12; behind ! those to leave "
           "out, as '!noise' (default: all, noise and overlap too; withheld points never count)",
       .field = &Options::classes,
       .value = "N",
       .key = "classes",
       .inputs = Option::kPoints,
       .is_for = "LAS",
       .numbers_of = classes_of},
      {.name = "returns",
       .help =
           "LAS: keep the last return of each pulse (near the ground), the first, or all (default)",
       .field = kReturnWords,
       .value = "WHICH",
       .inputs = Option::kPoints,
       .is_for = "LAS"},
      {.name = "duplicates",
       .help = "Points, --repair: the height of those that fall together: mean (default), min, "
               "max, or first (of the first input that has one)",
       .field = kMergeWords,
       .value = "RULE",
       .inputs = kPointsAndRepaired,
       .is_for = kForPointsAndRepaired},
      {.name = "layer",
       .help = "Points of this layer, where a file holds several",
       .field = &Options::layer,
       .value = "NAME",
       .inputs = Option::kPoints | Option::kSurfaces,
       .is_for = "points and for the surfaces of LandXML"},
      {.name = "columns",
       .help =
           "Text: the names of its columns from the left; x, y, z or as a header may name them, by "
           "any other name columns that are passed over (default: a header's, else x y z)",
       .field = &Options::columns,
       .value = "NAME",
       .inputs = Option::kPoints,
       .is_for = "points as text",
       .has_many = true,
       .fault = fault_of_columns},
      {.name = "skip-invalid",
       .help = "Text: pass over rows that are no points, and say how many there are (default: the "
               "first one is refused)",
       .field = &Options::skip_invalid,
       .inputs = Option::kPoints,
       .is_for = "points as text"},
      {.name = "z-field",
       .help = "The attribute that holds the height of a layer's points (default: their z)",
       .field = &Options::z_field,
       .value = "NAME",
       .inputs = Option::kPoints,
       .is_for = "points"},
      {.name = "repair",
       .help = "TINs: leave the triangles and triangulate the vertices anew; voids by --max-edge",
       .field = &Options::repair,
       .inputs = Option::kTins | Option::kRepairedTins,
       .is_for = "TINs"},
      {.name = "max-edge",
       .help = "Points, --repair: triangles with an edge longer than this become void; CRS units, "
               "or metres where those are degrees",
       .field = &Options::max_edge,
       .value = "L",
       .range = NumberRange::kPositive,
       .unit = "in CRS units, or metres where those are degrees",
       .noun = "the longest edge",
       .inputs = kPointsAndRepaired,
       .is_for = kForPointsAndRepaired},
      {.name = "breaklines",
       .help =
           "Points, --repair: lines that become edges of the TIN, from layers that OGR reads or "
           "LandXML; without heights they are laid on the surface; several files, behind INPUT",
       .field = &Options::breaklines,
       .value = "FILE",
       .inputs = kPointsAndRepaired,
       .is_for = kForPointsAndRepaired,
       .is_file = true,
       .has_many = true},
      {.name = "breakline-layer",
       .help = "Breaklines of this layer, where a file holds several",
       .field = &Options::breakline_layer,
       .value = "NAME",
       .fault = fault_of_breakline_layer},
      {.name = "boundary",
       .help = "Points, --repair: polygons outside of which all is void, from a layer that OGR "
               "reads or LandXML; without heights they are laid on the surface",
       .field = &Options::boundary,
       .value = "FILE",
       .inputs = kPointsAndRepaired,
       .is_for = kForPointsAndRepaired,
       .is_file = true},
      {.name = "boundary-layer",
       .help = "The boundary is this layer, where its file holds several",
       .field = &Options::boundary_layer,
       .value = "NAME",
       .fault = fault_of_boundary_layer},
      {.name = "bbox",
       .help = "Leave out samples outside of this box, in CRS units",
       .field = &Options::bbox,
       .value = "XMIN YMIN XMAX YMAX",
       .unit = "in CRS units",
       .inputs = Option::kRasters | kPointsAndRepaired,
       .is_always_kept = true,
       .fault = fault_of_bbox,
       .misfit = "a TIN is not cut by --bbox; build it whole, then refine or export a window"},
      {.name = "a-srs",
       .help = "The CRS; overrides the source's (EPSG code, WKT, PROJ string)",
       .field = &Options::a_srs,
       .value = "CRS",
       .words = "--a-srs,--a_srs"},
      {.name = "vertical-crs",
       .help = "The vertical CRS, as EPSG:5773",
       .field = &Options::vertical_crs,
       .value = "CRS"},
      {.name = "cost",
       .help = "In which order vertices go: error (default, for levels of detail), roi (point "
               "location) or elevation (isolines)",
       .field = kCostWords,
       .is_always_kept = true,
       .reads = false},
      {.name = "max-error",
       .help = "Leave out detail below this error, in the height's unit",
       .field = &Options::max_error,
       .value = "E",
       .range = NumberRange::kNotNegative,
       .unit = "in the height's unit",
       .noun = "the largest error to leave out",
       .is_always_kept = true,
       .reads = false},
      {.name = "void-slope",
       .help = "Error charged for each ground unit that the border of a void moves: at an error E "
               "it moves by E / S at most",
       .field = &Options::void_slope,
       .value = "S",
       .range = NumberRange::kNotNegative,
       .unit = "",
       .noun = "the void slope",
       .is_always_kept = true,
       .shows_default = true,
       .reads = false},
      {.name = "tile",
       .help = "Samples along a leaf of the tile hierarchy, of points and TINs about as many "
               "(default: by the number of samples)",
       .field = &Options::tile,
       .value = "SIDE",
       .is_always_kept = true,
       .reads = false,
       .fault = fault_of_tile},
      {.name = "title",
       .help = "What the terrain is called, for people: shown wherever the file is",
       .field = &Options::title,
       .value = "TEXT",
       .reads = false,
       .fault = fault_of_title},
      {.name = "attribution",
       .help = "Whom to name where the terrain is shown, as its licence asks",
       .field = &Options::attribution,
       .value = "TEXT",
       .reads = false,
       .fault = fault_of_attribution},
      {.name = "base-map",
       .help =
           "Tiles of Web Mercator that viewers may lay over the terrain when their users want it, "
           "as https://tiles.example.org/{z}/{x}/{y}.png, or with {TileMatrix}, {TileCol} and "
           "{TileRow}",
       .field = &Options::base_map,
       .value = "TEMPLATE",
       .reads = false,
       .fault = fault_of_base_map},
      {.name = "base-map-attribution",
       .help = "Whom to name where the base map is shown; its host without it",
       .field = &Options::base_map_attribution,
       .value = "TEXT",
       .reads = false},
  };
  return kTable;
}

/// JSON has no numbers for NaN and the infinities: they are words.
nlohmann::json number_or_word(double value) {
  if (std::isfinite(value)) {
    return value;
  }
  return std::isnan(value) ? "nan" : (value > 0 ? "inf" : "-inf");
}

std::string without_folder(const std::string& path) {
  return std::filesystem::path(path).filename().string();
}

/// What is wrong with a number; "" for nothing.
std::string fault_of_range(const BuildOption& option, const BuildOptions& options) {
  std::optional<double> number;
  if (const auto* const field = std::get_if<double Options::*>(&option.field)) {
    number = options.*(*field);
  } else if (const auto* const may = std::get_if<std::optional<double> Options::*>(&option.field)) {
    number = options.*(*may);
  }
  const bool is_sound = !number || option.noun == nullptr || option.range.holds(*number);
  return is_sound ? "" : std::string(option.noun) + " must be " + words_of(option.range);
}

}  // namespace

std::span<const BuildOption> build_option_table() { return table(); }

std::string key_of(const BuildOption& option) {
  std::string key = option.key != nullptr ? option.key : option.name;
  std::replace(key.begin(), key.end(), '-', '_');
  return key;
}

nlohmann::json json_of(const BuildOption& option, const BuildOptions& options) {
  const auto value_of = [&](const auto& field) -> nlohmann::json {
    using Field = std::decay_t<decltype(field)>;
    if constexpr (std::is_same_v<Field, WordOption>) {
      const std::optional<std::size_t> number = field.get(options);
      return number ? nlohmann::json(field.words[*number]) : nlohmann::json();
    } else {
      const auto& value = options.*field;
      using Value = std::decay_t<decltype(value)>;
      if constexpr (std::is_same_v<Value, double>) {
        return number_or_word(value);
      } else if constexpr (std::is_same_v<Value, std::optional<double>>) {
        return value ? number_or_word(*value) : nlohmann::json();
      } else if constexpr (std::is_same_v<Value, bool>) {
        return value ? nlohmann::json(true) : nlohmann::json();
      } else if constexpr (std::is_same_v<Value, std::string>) {
        const std::string text = option.is_file ? without_folder(value) : value;
        return text.empty() ? nlohmann::json() : nlohmann::json(text);
      } else if constexpr (std::is_same_v<Value, std::vector<std::string>>) {
        nlohmann::json list;
        for (const std::string& text : value) {
          list.push_back(option.is_file ? without_folder(text) : text);
        }
        return list;
      } else if constexpr (std::is_same_v<Value, std::vector<int>>) {
        return value.empty() ? nlohmann::json() : nlohmann::json(value);
      } else {
        return value ? nlohmann::json(*value) : nlohmann::json();
      }
    }
  };
  return std::visit(value_of, option.field);
}

bool is_given(const BuildOption& option, const BuildOptions& options) {
  return json_of(option, options) != json_of(option, BuildOptions{});
}

std::string misfit_of(const BuildOption& option, const std::string& input) {
  if (option.misfit != nullptr) {
    return option.misfit;
  }
  return std::string("--") + option.name + " is for " + option.is_for + ", and " + input +
         "; leave it out";
}

nlohmann::json options_json(const BuildOptions& options) {
  nlohmann::json json = nlohmann::json::object();
  for (const BuildOption& option : table()) {
    if (option.is_always_kept || is_given(option, options)) {
      json[key_of(option)] = json_of(option, options);
    }
  }
  return json;
}

void check_options(const BuildOptions& options) {
  for (const BuildOption& option : table()) {
    const std::string range = fault_of_range(option, options);
    const char* const other =
        range.empty() && option.fault != nullptr ? option.fault(options) : nullptr;
    if (!range.empty() || other != nullptr) {
      throw Error(ErrorCode::invalid_argument, range.empty() ? other : range);
    }
  }
}

}  // namespace ptin
