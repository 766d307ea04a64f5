// SPDX-License-Identifier: GPL-3.0-or-later
//
// Options that are lengths or heights: numbers in the terrain's units, or with a unit behind them.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "engine/crs/crs_facts.h"
#include "tools/facts/numbers.h"
#include "tools/facts/quantity.h"

namespace ptin::tools {

/// The quantity that an option measures, and with it the unit of its plain numbers.
enum class MeasureKind : std::uint8_t {
  kHeight,  ///< The height's unit; where nobody knows it, what is taken for it (unit_of_ground()).
  kGround,  ///< Map units; in a geographic CRS metres.
};

/// Options that take 5km and 10ft beside plain numbers. What has a unit is turned into the terrain's
/// when that is known: settle() then changes what was parsed. Copies share what waits for it.
class Measures {
 public:
  /// Declare an option that is one measure, or several. `target` gets the number as written, in
  /// whatever unit, and outlives settle().
  CLI::Option* add(CLI::App& app, const std::string& names, double& target, MeasureKind kind,
                   NumberRange range, const std::string& help);
  CLI::Option* add(CLI::App& app, const std::string& names, std::optional<double>& target,
                   MeasureKind kind, NumberRange range, const std::string& help);
  CLI::Option* add(CLI::App& app, const std::string& names, std::vector<double>& target,
                   MeasureKind kind, NumberRange range, const std::string& help);

  /// Whether something waits for a terrain.
  [[nodiscard]] bool wait() const noexcept { return !waiting_->empty(); }
  /// Turns what was given with a unit into the terrain's; the second time nothing is left to do.
  /// @throws Error invalid_argument  the terrain's unit is not known
  void settle(const CrsFacts& crs) const;

 private:
  struct Waiting {
    std::string option, text;
    Length length;
    MeasureKind kind;
    std::function<void(double)> put;
  };
  CLI::Option* add_one(CLI::App& app, const std::string& names, std::function<void(double)> put,
                       MeasureKind kind, NumberRange range, const std::string& help) const;
  /// Puts the number of a text, and notes what waits to be put anew.
  void take(const std::string& option, const std::string& text, MeasureKind kind,
            const std::function<void(double)>& put) const;

  std::shared_ptr<std::vector<Waiting>> waiting_ = std::make_shared<std::vector<Waiting>>();
};

/// The check of a length or a height that must be a plain number, since it is asked for before anybody
/// knows the source's units.
/// @param unit  "in CRS units".
[[nodiscard]] CLI::Validator plain_measure(NumberRange range, const std::string& unit);

}  // namespace ptin::tools
