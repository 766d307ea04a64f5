// SPDX-License-Identifier: GPL-3.0-or-later
//
// A parameter of a question: one row says what it is called, where its value goes, which values mean
// something and what people are told. The command line, HTTP, OpenAPI, the manual page and the
// completion script read rows; nothing else writes these facts.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <limits>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "engine/crs/crs_facts.h"
#include "engine/number.h"
#include "engine/query/questions.h"
#include "tools/facts/quantity.h"

namespace ptin::ask {

/// Where questions are asked: on the command line, and over HTTP.
enum class Door : std::uint8_t { kNone = 0, kProgram = 1, kService = 2, kBoth = 3 };
[[nodiscard]] constexpr bool is_at(Door where, Door door) noexcept {
  return (static_cast<unsigned>(where) & static_cast<unsigned>(door)) != 0;
}

/// The unit of plain numbers. On the command line a height and a length may have their own unit
/// behind them, as 10ft.
enum class Unit : std::uint8_t {
  kNone,
  kMap,     ///< The unit of positions.
  kHeight,  ///< The height's unit; where nobody knows it, what is taken for it (unit_of_ground()).
  kGround,  ///< A distance: map units; in a geographic CRS metres.
};

/// Where a value goes: a flag, numbers, whole numbers, texts, a window; or what reads a text, or
/// all texts of a list, and throws Error where one is none of its values.
using Into =
    std::variant<bool*, double*, std::optional<double>*, std::vector<double>*, int*,
                 std::vector<int>*, std::uint32_t*, std::uint64_t*, std::optional<std::uint64_t>*,
                 std::string*, std::vector<std::string>*, std::optional<Window>*,
                 std::optional<std::array<double, 4>>*, std::function<void(const std::string&)>,
                 std::function<void(const std::vector<std::string>&)>>;

inline constexpr std::uint32_t kAnyNumberOfValues = std::numeric_limits<std::uint32_t>::max();

struct Parameter {
  std::string_view name;  ///< Over HTTP; on the command line it is --name.
  /// Its spelling on the command line where that differs: "-i,--interval"; "FILE" of an argument.
  std::string_view words{};
  Into into{};
  std::string_view metavar{};  ///< The value's name in help: "E", "X Y".
  Unit unit = Unit::kNone;
  NumberRange range{};
  std::string_view source_unit{};  ///< "in CRS units": of the source, so no number has its own.
  std::optional<NumberRange> range_over_http{};  ///< Where HTTP takes more; empty: `range`.
  std::vector<std::string_view> choices{};       ///< Values of a text; empty: any text.
  std::uint32_t least_values = 1, most_values = 1;
  std::string_view excludes{}, needs{};  ///< Names between blanks.
  /// Where these hold. Elsewhere what is beside it is not looked at.
  Door bound_at = Door::kBoth;
  bool repeats = false;           ///< It may be given several times, a value each time.
  bool splits_at_commas = false;  ///< On the command line several values may be one word.
  Door required = Door::kNone;    ///< Where it must be given.
  std::string default_value{};    ///< What it is where it is not given, to be told; empty: nothing.
  Door doors = Door::kBoth;
  bool is_by_gdal = false;  ///< On the command line GDAL reads what it names.
  bool is_json = false;     ///< In a body over HTTP other values of JSON than text mean something.
  std::string_view example{};  ///< Over HTTP; empty: none.
  std::string help{};          ///< For people, without the unit.
  std::string_view hint{};     ///< Behind a refusal: what may have been meant.

  // Each sets what its name says, so that a row is one statement.
  Parameter& spelled(std::string_view on_command_line) { return words = on_command_line, *this; }
  Parameter& in(Unit of) { return unit = of, *this; }
  Parameter& within(const NumberRange& of) { return range = of, *this; }
  Parameter& within_over_http(const NumberRange& of) { return range_over_http = of, *this; }
  Parameter& of(std::vector<std::string_view> all) { return choices = std::move(all), *this; }
  Parameter& values(std::uint32_t least, std::uint32_t most) {
    least_values = least;
    most_values = most;
    return *this;
  }
  Parameter& excluding(std::string_view names) { return excludes = names, *this; }
  Parameter& needing(std::string_view names) { return needs = names, *this; }
  Parameter& bound(Door where) { return bound_at = where, *this; }
  Parameter& required_at(Door where) { return required = where, *this; }
  /// Has the value told that it has now.
  Parameter& with_default();
  Parameter& at(Door where) { return doors = where, *this; }
  Parameter& as_json() { return is_json = true, *this; }
  Parameter& read_by_gdal() { return is_by_gdal = true, *this; }
  Parameter& repeated() { return repeats = true, *this; }
  Parameter& split_at_commas() { return splits_at_commas = true, *this; }
  Parameter& like(std::string_view value) { return example = value, *this; }
  Parameter& hinting(std::string_view at_what) { return hint = at_what, *this; }
};
/// The parameters of a question, in the order of its help. They point into what holds its values.
class Parameters : public std::vector<Parameter> {
 public:
  using std::vector<Parameter>::vector;

  Parameter& add(std::string_view name, Into into, std::string_view metavar, std::string help) {
    return emplace_back(Parameter{
        .name = name, .into = std::move(into), .metavar = metavar, .help = std::move(help)});
  }
  /// Leaves those of one door.
  void keep(Door door) {
    std::erase_if(*this, [door](const Parameter& row) { return !is_at(row.doors, door); });
  }
};

/// "--interval", "FILE"; "interval" over HTTP.
[[nodiscard]] std::string name_at(const Parameter& parameter, Door door);
/// The parameter's help with its unit, as the door has it.
[[nodiscard]] std::string help_at(const Parameter& parameter, Door door);
/// The numbers that a door takes: over HTTP finite ones, since JSON has no others.
[[nodiscard]] NumberRange range_at(const Parameter& parameter, Door door) noexcept;
/// True for a flag, which has no value on the command line.
[[nodiscard]] inline bool is_flag(const Parameter& p) noexcept {
  return std::holds_alternative<bool*>(p.into);
}
/// True for whole numbers.
[[nodiscard]] bool is_whole(const Parameter& parameter) noexcept;
/// True for text, and for what is read from it.
[[nodiscard]] bool is_text(const Parameter& parameter) noexcept;
/// True for parameters of several values.
[[nodiscard]] bool is_list(const Parameter& parameter) noexcept;

/// Puts the values that a door is given where the rows say. All throw Error invalid_argument, whose
/// context is the parameter's name at the door.
class Reading {
 public:
  explicit Reading(Door door) : door_(door) {}

  /// Takes the values of one parameter; of a flag on the command line there are none.
  void take(const Parameter& parameter, std::span<const std::string> values);
  /// What was given, by the names of the parameters.
  [[nodiscard]] const auto& given() const noexcept { return given_; }
  /// Whether GDAL reads some of it.
  [[nodiscard]] bool is_by_gdal() const noexcept { return is_by_gdal_; }
  /// Looks at what is missing, and at what was given together, of the parameters of the door.
  void check(std::span<const Parameter> parameters) const;
  /// Whether something waits for the terrain's units.
  [[nodiscard]] bool waits() const noexcept { return !waiting_.empty(); }
  /// Turns what was given with a unit into the terrain's; the second time nothing is left to do.
  /// @throws Error invalid_argument  the terrain's unit is not known
  void settle(const CrsFacts& crs);

 private:
  /// A number that has a unit behind it.
  struct Waiting {
    std::string parameter, text;
    tools::Length length;
    Unit unit;
    double* number;
  };
  [[nodiscard]] double number_of(const Parameter& parameter, const std::string& text) const;
  /// Puts a value, the last one; the values of a list. Notes a number that waits for its unit.
  template <typename Value>
  void put(const Parameter& parameter, std::span<const std::string> values, Value& value);

  Door door_;
  std::map<std::string, std::vector<std::string>, std::less<>> given_;
  bool is_by_gdal_ = false;
  std::vector<Waiting> waiting_;
};

/// Without blanks before and behind.
[[nodiscard]] std::string_view trimmed(std::string_view text);
/// The parts of a text between marks; none of an empty one.
[[nodiscard]] std::vector<std::string_view> parts_of(std::string_view text, char mark);

}  // namespace ptin::ask
