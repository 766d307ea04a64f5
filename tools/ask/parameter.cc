// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/ask/parameter.h"

#include <algorithm>
#include <type_traits>

#include "engine/crs/ground.h"
#include "engine/crs/height_unit.h"
#include "engine/error.h"
#include "engine/number.h"
#include "tools/facts/human.h"
#include "tools/facts/nearest_name.h"
#include "tools/output/file_name.h"
#include "tools/region/on_terrain.h"

namespace ptin::ask {

namespace {

const Parameter* find(std::span<const Parameter> parameters, std::string_view name) {
  const auto found = std::find_if(parameters.begin(), parameters.end(),
                                  [&](const Parameter& p) { return p.name == name; });
  return found == parameters.end() ? nullptr : &*found;
}

template <typename... Types>
bool holds_any_of(const Into& into) noexcept {
  return (std::holds_alternative<Types>(into) || ...);
}

/// "in the height's unit"; empty where there is none to tell.
std::string words_of(Unit unit, Door door) {
  switch (unit) {
    case Unit::kMap:
      return "in map units";
    case Unit::kHeight:
      return door == Door::kProgram ? "in the height's unit" : "in the unit of the heights";
    case Unit::kGround:
      return "in map units, or metres in a geographic CRS";
    case Unit::kNone:
      break;
  }
  return {};
}

bool has_own_unit(const Parameter& p, Door door) {
  return door == Door::kProgram && (p.unit == Unit::kHeight || p.unit == Unit::kGround);
}

[[noreturn]] void refuse_value(const Parameter& p, Door door, const std::string& words,
                               const std::string& text) {
  refuse("must be " + words + "; " + (text.empty() ? "\"\"" : tools::shown(text)) + " is none" +
             (p.hint.empty() || door == Door::kService
                  ? ""
                  : ". " + std::string(p.hint) + tools::shown(text)),
         name_at(p, door));
}

std::uint64_t whole_of(const Parameter& p, Door door, const std::string& text) {
  const auto number = parse_number<std::uint64_t>(trimmed(text));
  if (number && range_at(p, door).holds(static_cast<double>(*number))) return *number;
  refuse_value(p, door, words_of(range_at(p, door), true), text);
}

bool truth_of(const Parameter& p, Door door, const std::string& text) {
  if (text.empty() || text == "false" || text == "0") return false;
  if (text == "true" || text == "1") return true;
  refuse_value(p, door, "true or false", text);
}

/// The text, or the choice that it is.
std::string choice_of(const Parameter& p, Door door, const std::string& text) {
  if (p.choices.empty()) return text;
  std::vector<std::string> names(p.choices.begin(), p.choices.end());
  for (const std::string& name : names) {
    if (tools::lower_case(name) == tools::lower_case(text)) return name;
  }
  std::string list;
  for (const std::string& name : names) list += (list.empty() ? "" : ", ") + name;
  const std::string nearest = tools::nearest_name(text, names);
  refuse(tools::shown(text) + " is none of " + list +
             (nearest.empty() ? "" : "; did you mean " + nearest + "?"),
         name_at(p, door));
}

/// Metres in the unit of plain numbers.
double metres_of_plain(Unit unit, const CrsFacts& crs, const std::string& parameter,
                       const std::string& text) {
  std::optional<double> metres;
  if (unit == Unit::kHeight) {
    metres = metres_in(height_unit_named(unit_of_ground(crs)));
  } else if (crs.geographic) {
    metres = 1.0;
  } else if (const auto of_plane = metres_per_map_unit(crs, {})) {
    metres = of_plane->x;
  }
  if (metres) return *metres;
  refuse(std::string("the unit of the terrain's ") + (unit == Unit::kHeight ? "heights" : "map") +
             " is unknown, so " + text + " cannot be turned into it; give a number without a unit",
         parameter);
}

}  // namespace

std::string_view trimmed(std::string_view text) {
  while (!text.empty() && text.front() == ' ') text.remove_prefix(1);
  while (!text.empty() && text.back() == ' ') text.remove_suffix(1);
  return text;
}

std::vector<std::string_view> parts_of(std::string_view text, char mark) {
  std::vector<std::string_view> parts;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find(mark), text.size());
    parts.push_back(text.substr(0, end));
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  return parts;
}

std::string name_at(const Parameter& p, Door door) {
  if (door == Door::kService) return std::string(p.name);
  if (p.words.empty()) return "--" + std::string(p.name);
  const std::size_t begin = p.words.find("--");
  if (begin == std::string_view::npos) return std::string(p.words);
  return std::string(p.words.substr(begin, p.words.find(',', begin) - begin));
}

std::string help_at(const Parameter& p, Door door) {
  const std::string unit = words_of(p.unit, door);
  if (unit.empty()) return p.help;
  const char* const own = !has_own_unit(p, door)    ? ""
                          : p.unit == Unit::kHeight ? ", or as 50cm"
                                                    : ", or as 50m, 5km, 3mi";
  return p.help + " (" + unit + own + ")";
}

NumberRange range_at(const Parameter& p, Door door) noexcept {
  if (door == Door::kProgram) return p.range;
  NumberRange range = p.range_over_http.value_or(p.range);
  range.least = std::max(range.least, NumberRange::kFinite.least);
  range.most = std::min(range.most, NumberRange::kFinite.most);
  range.has_nan = false;
  return range;
}

Parameter& Parameter::with_default() {
  default_value = std::visit(
      [](const auto& place) -> std::string {
        using Type = std::decay_t<decltype(place)>;
        if constexpr (std::is_same_v<Type, std::string*>) return *place;
        if constexpr (std::is_same_v<Type, double*>) return tools::exact_number(*place);
        if constexpr (std::is_integral_v<std::remove_pointer_t<Type>> &&
                      !std::is_same_v<Type, bool*>) {
          return std::to_string(*place);
        }
        return {};
      },
      into);
  return *this;
}

bool is_whole(const Parameter& p) noexcept {
  return holds_any_of<int*, std::vector<int>*, std::uint32_t*, std::uint64_t*,
                      std::optional<std::uint64_t>*>(p.into);
}

bool is_text(const Parameter& p) noexcept {
  return holds_any_of<std::string*, std::vector<std::string>*,
                      std::function<void(const std::string&)>,
                      std::function<void(const std::vector<std::string>&)>>(p.into);
}

bool is_list(const Parameter& p) noexcept {
  return p.most_values > 1 || std::holds_alternative<std::optional<Window>*>(p.into);
}

double Reading::number_of(const Parameter& p, const std::string& text) const {
  std::optional<double> number = parse_number<double>(trimmed(text));
  if (!number && has_own_unit(p, door_)) {
    if (const auto length = tools::length_of(text)) number = length->number;
  }
  if (number && range_at(p, door_).holds(*number)) return *number;
  const std::string unit = words_of(p.unit, door_);
  if (!number && !p.source_unit.empty() && tools::length_of(text)) {
    refuse("must be a plain number, " + std::string(p.source_unit) +
               ": those of the source are not known before it is read; " + text + " has a unit",
           name_at(p, door_));
  }
  std::string words = words_of(range_at(p, door_)) + (unit.empty() ? "" : ", " + unit);
  if (!p.source_unit.empty()) words.append(", ").append(p.source_unit);
  if (!number && has_own_unit(p, door_)) {
    words += ", or with a unit behind it (" + tools::known_length_units() + "), as 10ft";
  }
  refuse_value(p, door_, words, text);
}

template <typename Value>
void Reading::put(const Parameter& p, std::span<const std::string> values, Value& value) {
  const std::string text = values.empty() ? std::string() : values.back();
  if constexpr (std::is_same_v<Value, bool>) {
    value = values.empty() || truth_of(p, door_, text);
  } else if constexpr (std::is_integral_v<Value>) {
    value = static_cast<Value>(whole_of(p, door_, text));
  } else if constexpr (std::is_same_v<Value, double>) {
    value = number_of(p, text);
    const auto length = has_own_unit(p, door_) ? tools::length_of(text) : std::nullopt;
    if (length && length->has_unit()) {
      waiting_.push_back({name_at(p, door_), text, *length, p.unit, &value});
    }
  } else if constexpr (std::is_same_v<Value, std::string>) {
    value = choice_of(p, door_, text);
  } else if constexpr (std::is_same_v<Value, Window>) {
    std::vector<double> numbers;
    for (const std::string& number : values) numbers.push_back(number_of(p, number));
    value = tools::window_of(numbers, name_at(p, door_), door_ == Door::kService);
  } else if constexpr (requires { value.emplace(); }) {
    put(p, values, value.emplace());
  } else {
    if constexpr (requires { value.resize(values.size()); }) value.resize(values.size());
    for (std::size_t i = 0; i < value.size(); ++i) put(p, values.subspan(i, 1), value[i]);
  }
}

void Reading::take(const Parameter& p, std::span<const std::string> values) {
  given_[std::string(p.name)].assign(values.begin(), values.end());
  is_by_gdal_ = is_by_gdal_ || p.is_by_gdal;
  const bool is_window = std::holds_alternative<std::optional<Window>*>(p.into);
  if (is_list(p) && !is_window &&
      (values.size() < p.least_values || values.size() > p.most_values)) {
    refuse("takes " + tools::counted(p.least_values, "value") +
               (p.most_values > p.least_values ? " or more" : "") + "; " +
               std::to_string(values.size()) + (values.size() == 1 ? " was" : " were") + " given",
           name_at(p, door_));
  }
  const auto put_all = [&](const auto& into) {
    using Place = std::decay_t<decltype(into)>;
    if constexpr (std::is_pointer_v<Place>) {
      put(p, values, *into);
    } else {
      constexpr bool kIsOfAll = std::is_invocable_v<Place, const std::vector<std::string>&>;
      std::conditional_t<kIsOfAll, std::vector<std::string>, std::string> value;
      put(p, values, value);
      try {
        into(value);
      } catch (const Error& e) {
        throw Error(e.code(), e.message(), name_at(p, door_));
      }
    }
  };
  std::visit(put_all, p.into);
}

void Reading::check(std::span<const Parameter> parameters) const {
  for (const Parameter& p : parameters) {
    const std::string name = name_at(p, door_);
    if (!given_.contains(p.name)) {
      if (!is_at(p.required, door_)) continue;
      refuse("is required: " + help_at(p, door_) +
                 (p.example.empty() ? "" : ", as " + std::string(p.example)),
             name);
    }
    if (!is_at(p.bound_at, door_)) continue;
    for (const std::string_view other : parts_of(p.excludes, ' ')) {
      const Parameter* const given = given_.contains(other) ? find(parameters, other) : nullptr;
      if (given != nullptr)
        refuse("excludes " + name_at(*given, door_) + "; give one of them", name);
    }
    for (const std::string_view other : parts_of(p.needs, ' ')) {
      const Parameter* const needed = given_.contains(other) ? nullptr : find(parameters, other);
      if (needed != nullptr) refuse("needs " + name_at(*needed, door_) + "; give both", name);
    }
  }
}

void Reading::settle(const CrsFacts& crs) {
  for (const Waiting& w : waiting_) {
    *w.number = w.length.in(metres_of_plain(w.unit, crs, w.parameter, w.text));
  }
  waiting_.clear();
}

}  // namespace ptin::ask
