// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/ptin/measures.h"

#include <utility>

#include "engine/crs/ground.h"
#include "engine/crs/height_unit.h"
#include "engine/error.h"

namespace ptin::tools {

namespace {

/// The number in a text that may have a unit behind it; none: it is neither.
std::optional<double> number_in(const std::string& text) {
  if (const std::optional<double> number = given_number(text)) return number;
  const std::optional<Length> length = length_of(text);
  return length ? std::optional(length->number) : std::nullopt;
}

/// "must be a finite number > 0, in the height's unit; -1 is none", "..., or with a unit behind it, as
/// 10ft (mm, cm, ...); 10yards is none".
CLI::Validator measures(NumberRange range, MeasureKind kind) {
  const std::string unit = kind == MeasureKind::kHeight
                               ? "in the height's unit"
                               : "in map units, or metres in a geographic CRS";
  return {[range, unit](const std::string& text) {
            const std::optional<double> number = number_in(text);
            if (number && is_in(range, *number)) return std::string();
            std::string words = std::string("must be ") + words_of(range) + ", " + unit;
            if (!number) {
              words += ", or with a unit behind it (" + known_length_units() + "), as 10ft";
            }
            return words + "; " + (text.empty() ? "\"\"" : text) + " is none";
          },
          ""};
}

/// The long one of an option's names: "--level" of "--level,--fl"; else the only one.
std::string name_in(const std::string& names) {
  const std::size_t begin = names.find("--");
  if (begin == std::string::npos) return names;
  return names.substr(begin, names.find(',', begin) - begin);
}

/// Metres in the unit of plain numbers.
double metres_of_plain(MeasureKind kind, const CrsFacts& crs, const std::string& option,
                       const std::string& text) {
  std::optional<double> metres;
  if (kind == MeasureKind::kHeight) {
    metres = metres_in(height_unit_named(unit_of_ground(crs)));
  } else if (crs.geographic) {
    metres = 1.0;
  } else if (const auto of_plane = metres_per_map_unit(crs, {})) {
    metres = of_plane->x;
  }
  if (metres) return *metres;
  throw Error(ErrorCode::invalid_argument,
              std::string("the unit of the terrain's ") +
                  (kind == MeasureKind::kHeight ? "heights" : "map") + " is unknown, so " + text +
                  " cannot be turned into it; give a number without a unit",
              option);
}

}  // namespace

CLI::Option* Measures::add_one(CLI::App& app, const std::string& names,
                               std::function<void(double)> put, MeasureKind kind, NumberRange range,
                               const std::string& help) const {
  const auto taken = [self = *this, name = name_in(names), put = std::move(put),
                      kind](const std::string& text) { self.take(name, text, kind, put); };
  return app.add_option_function<std::string>(names, taken, help)->check(measures(range, kind));
}

CLI::Option* Measures::add(CLI::App& app, const std::string& names, double& target,
                           MeasureKind kind, NumberRange range, const std::string& help) {
  return add_one(
      app, names, [&target](double number) { target = number; }, kind, range, help);
}

CLI::Option* Measures::add(CLI::App& app, const std::string& names, std::optional<double>& target,
                           MeasureKind kind, NumberRange range, const std::string& help) {
  return add_one(
      app, names, [&target](double number) { target = number; }, kind, range, help);
}

CLI::Option* Measures::add(CLI::App& app, const std::string& names, std::vector<double>& target,
                           MeasureKind kind, NumberRange range, const std::string& help) {
  const auto taken = [self = *this, name = name_in(names), &target,
                      kind](const std::vector<std::string>& texts) {
    target.resize(texts.size());
    for (std::size_t i = 0; i < texts.size(); ++i) {
      self.take(name, texts[i], kind, [&target, i](double number) { target[i] = number; });
    }
  };
  return app.add_option_function<std::vector<std::string>>(names, taken, help)
      ->check(measures(range, kind));
}

void Measures::take(const std::string& option, const std::string& text, MeasureKind kind,
                    const std::function<void(double)>& put) const {
  put(*number_in(text));
  const std::optional<Length> length = length_of(text);
  if (length && length->has_unit()) waiting_->push_back({option, text, *length, kind, put});
}

CLI::Validator plain_measure(NumberRange range, const std::string& unit) {
  return {
      [range, unit](const std::string& text) {
        const std::optional<double> number = number_in(text);
        if (number && is_in(range, *number)) {
          const std::optional<Length> length = length_of(text);
          if (!length || !length->has_unit()) return std::string();
          return "must be a plain number, " + unit +
                 ": those of the source are not known before it is read; " + text + " has a unit";
        }
        return std::string("must be ") + words_of(range) + ", " + unit + "; " + text + " is none";
      },
      ""};
}

void Measures::settle(const CrsFacts& crs) const {
  for (const Waiting& w : *waiting_) {
    w.put(w.length.in(metres_of_plain(w.kind, crs, w.option, w.text)));
  }
  waiting_->clear();
}

}  // namespace ptin::tools
