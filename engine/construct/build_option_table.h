// SPDX-License-Identifier: GPL-3.0-or-later
//
// The table of the options of a build: what each is called, which values it takes, and for which
// inputs it is. Checks, metadata, --resume, refusals, the command line and its documents are made
// from it.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "engine/construct/build_options.h"
#include "engine/number.h"

namespace ptin {

/// An option whose value is one of some words.
struct WordOption {
  std::span<const char* const> words;                              ///< By number.
  std::optional<std::size_t> (*get)(const BuildOptions& options);  ///< None: it is not given.
  void (*set)(BuildOptions& options, std::size_t number);
};

/// Where an option has its value. One without a value, false or "" is not given.
using OptionField =
    std::variant<bool BuildOptions::*, double BuildOptions::*,
                 std::optional<double> BuildOptions::*, std::optional<std::int64_t> BuildOptions::*,
                 std::optional<std::array<double, 4>> BuildOptions::*, std::string BuildOptions::*,
                 std::vector<std::string> BuildOptions::*, std::vector<int> BuildOptions::*,
                 WordOption>;

/// One option that decides the bytes of the file.
struct BuildOption {
  /// Inputs that it is for, in sets.
  enum Inputs : unsigned {
    kRasters = 1,
    kPoints = 2,
    kTins = 4,
    kRepairedTins = 8,  ///< Their vertices alone, as points (BuildOptions::repair).
    kSurfaces = 16,     ///< LandXML, which may hold several TINs.
    kAll = kRasters | kPoints | kTins | kRepairedTins
  };

  const char* name;  ///< On the command line behind "--".
  const char* help;
  OptionField field;
  const char* value = nullptr;  ///< What help calls its value; null: what its type is called.
  /// Its key in the metadata; null: the name, with "_" for "-".
  const char* key = nullptr;
  /// Its names on the command line, between commas; null: "--name".
  const char* words = nullptr;
  NumberRange range = NumberRange::kFinite;  ///< The numbers it takes, where `unit` is not null.
  const char* unit = nullptr;                ///< In which numbers are, for refusals; "" for none.
  const char* noun = nullptr;                ///< A number: what it is called in a refusal.
  unsigned inputs = kAll;
  const char* is_for = nullptr;  ///< These inputs in words.
  bool is_always_kept = false;   ///< In the metadata also where it is not given.
  bool is_file = false;          ///< Or files: kept without their folders.
  bool has_many = false;         ///< A list that goes on to the next option; else commas divide it.
  bool shows_default = false;    ///< In help.
  bool reads = true;             ///< It says what is read, and not how tiles are made of it.
  /// A list of numbers: reads them from words.
  std::vector<int> (*numbers_of)(const std::vector<std::string>& words) = nullptr;
  /// What is wrong with a value beside its range; null: nothing.
  const char* (*fault)(const BuildOptions& options) = nullptr;
  /// Instead of the words that refuse it where inputs are others; may be null.
  const char* misfit = nullptr;
};

/// All options, in the order of help.
[[nodiscard]] std::span<const BuildOption> build_option_table();

[[nodiscard]] std::string key_of(const BuildOption& option);
/// The value as JSON; null where it is not given. Files are without their folders.
[[nodiscard]] nlohmann::json json_of(const BuildOption& option, const BuildOptions& options);
/// True when the value is not the one of BuildOptions{}.
[[nodiscard]] bool is_given(const BuildOption& option, const BuildOptions& options);
/// "--class is for LAS, and this is a raster; leave it out".
/// @param input  "this is a raster", "these are points".
[[nodiscard]] std::string misfit_of(const BuildOption& option, const std::string& input);

/// The options that decide the bytes of a file, as its metadata has them, and as --resume compares
/// them.
[[nodiscard]] nlohmann::json options_json(const BuildOptions& options);

}  // namespace ptin
