// SPDX-License-Identifier: GPL-3.0-or-later
//
// Each row of the table of options is in everything that is made from it.
#include "engine/construct/build_option_table.h"

#include <cmath>
#include <limits>
#include <set>
#include <string>
#include <type_traits>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "engine/construct/build.h"
#include "engine/construct/source_kind.h"
#include "engine/error.h"
#include "tests/construct/made_raster.h"

namespace ptin {
namespace {

/// Options of which one has another value than it has by itself.
BuildOptions with(const BuildOption& option) {
  BuildOptions options;
  const auto give = [&](const auto& field) {
    using Field = std::decay_t<decltype(field)>;
    if constexpr (std::is_same_v<Field, WordOption>) {
      field.set(options, field.words.size() - 1);
    } else {
      auto& value = options.*field;
      using Value = std::decay_t<decltype(value)>;
      if constexpr (std::is_same_v<Value, bool>) {
        value = true;
      } else if constexpr (std::is_same_v<Value, std::string>) {
        value = "EPSG:5773";
      } else if constexpr (std::is_same_v<Value, std::vector<std::string>>) {
        value = {"x", "y", "z"};
      } else if constexpr (std::is_same_v<Value, std::vector<int>>) {
        value = {2};
      } else if constexpr (std::is_same_v<Value, std::optional<std::array<double, 4>>>) {
        value = {0.0, 0.0, 5.0, 5.0};
      } else {
        value = 7;
      }
    }
  };
  std::visit(give, option.field);
  return options;
}

void set_number(BuildOptions& options, const BuildOption& option, double number) {
  if (const auto* const field = std::get_if<double BuildOptions::*>(&option.field)) {
    options.*(*field) = number;
  } else if (const auto* const may =
                 std::get_if<std::optional<double> BuildOptions::*>(&option.field)) {
    options.*(*may) = number;
  }
}

template <class Call>
std::string refusal(Call&& call) {
  try {
    call();
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ErrorCode::invalid_argument);
    return e.message();
  }
  return "";
}

TEST(BuildOptionTable, HasEachNameAndKeyOnce) {
  std::set<std::string> names, keys;
  for (const BuildOption& option : build_option_table()) {
    EXPECT_TRUE(names.insert(option.name).second) << option.name;
    EXPECT_TRUE(keys.insert(key_of(option)).second) << option.name;
  }
}

TEST(BuildOptionTable, MakesTheMetadataAndWhatResumingCompares) {
  const nlohmann::json none = options_json({});
  for (const BuildOption& option : build_option_table()) {
    SCOPED_TRACE(option.name);
    EXPECT_FALSE(is_given(option, {}));
    EXPECT_EQ(none.contains(key_of(option)), option.is_always_kept);
    const BuildOptions options = with(option);
    EXPECT_TRUE(is_given(option, options));
    EXPECT_EQ(options_json(options).at(key_of(option)), json_of(option, options));
    EXPECT_NE(options_json(options), none) << "--resume would take up a build with another value";
  }
  BuildOptions options;
  options.boundary = "/somewhere/area.gpkg";
  options.breaklines = {"a/b.shp", "c.shp"};
  EXPECT_EQ(options_json(options)["boundary"], "area.gpkg");
  EXPECT_EQ(options_json(options)["breaklines"], (nlohmann::json{"b.shp", "c.shp"}));
  options.nodata = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(options_json(options)["nodata"], "nan");
}

TEST(BuildOptionTable, MakesRefusalsOfNumbers) {
  for (const BuildOption& option : build_option_table()) {
    for (const double number : {-1.0, 0.0, 1.0, std::nan(""), HUGE_VAL}) {
      BuildOptions options;
      set_number(options, option, number);
      const std::string expected =
          option.noun == nullptr || option.range.holds(number)
              ? ""
              : std::string(option.noun) + " must be " + words_of(option.range);
      EXPECT_EQ(refusal([&] { check_options(options); }), expected) << option.name << number;
    }
  }
}

TEST(BuildOptionTable, MakesRefusalsForInputsThatAnOptionIsNotFor) {
  const oracle::ScratchFolder folder;
  const std::string points = folder.file("a.xyz"), tin = folder.file("a.obj");
  oracle::write_text(points, "0 0 1\n10 0 2\n0 10 3\n10 10 4\n");
  oracle::write_text(tin, "v 0 0 1\nv 10 0 2\nv 0 10 3\nf 1 2 3\n");
  const std::vector<std::pair<unsigned, std::string>> inputs{
      {BuildOption::kRasters, PTIN_TEST_DATA "/coast_257.tif"},
      {BuildOption::kPoints, points},
      {BuildOption::kTins, tin}};
  for (const BuildOption& option : build_option_table()) {
    for (const auto& [set, input] : inputs) {
      const BuildOptions options = with(option);
      const bool makes_points = !options.layer.empty() || !options.z_field.empty();
      if (set == BuildOption::kRasters && makes_points) {
        continue;  // whatever has layers and attributes holds points
      }
      // A TIN that is to be repaired is one, whatever else is asked.
      const bool fits = (option.inputs & set) != 0;
      const std::string told = refusal([&] { std::ignore = source_kind({input}, options); });
      EXPECT_EQ(told.empty(), fits) << option.name << " " << input << ": " << told;
      EXPECT_TRUE(fits || told.find(std::string("--") + option.name) != std::string::npos) << told;
      BuildOptions repaired = options;
      repaired.repair = true;
      const bool fits_repaired = (option.inputs & (set | BuildOption::kRepairedTins)) != 0;
      if (set == BuildOption::kTins) {
        EXPECT_EQ(refusal([&] { std::ignore = source_kind({input}, repaired); }).empty(),
                  fits_repaired)
            << option.name;
      }
    }
  }
}

}  // namespace
}  // namespace ptin
