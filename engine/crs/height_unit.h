// SPDX-License-Identifier: GPL-3.0-or-later
//
// Units of length by name: what bands and LandXML call them, and how long they are.
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace ptin {

/// One name for each unit, as a CRS would give it: "metre" for "m", "Meter" and "metres". Capitals
/// do not matter. A name that nobody knows stays as it is; an empty one is "unknown".
[[nodiscard]] std::string height_unit_named(const std::string& text);

/// Metres in a unit, by the name that height_unit_named() gives it; none where the name is not
/// known.
[[nodiscard]] std::optional<double> metres_in(std::string_view unit) noexcept;

/// The name of a unit of length that a CRS calls `name` and gives so many metres: that of a known unit
/// of this length, which CRSs spell in many ways or give none; else `name`, or "unknown". A unit named
/// "unknown" of the length 1, which libraries put in the place of one that nobody stated, stays
/// "unknown".
[[nodiscard]] std::string unit_called(const std::string& name, double metres);

}  // namespace ptin
