// SPDX-License-Identifier: GPL-3.0-or-later
//
// Which stored values stand for no height: one rule, in the type in which the file stores.
#pragma once

#include <limits>
#include <optional>

#include <gdal.h>

namespace ptin {

/// How a band stores its values.
struct StoredType {
  GDALDataType type = GDT_Unknown;
  bool signed_bytes = false;  ///< Values are -128 to 127, though the type is Byte (GDAL < 3.7).
  int significant_bits = 0;   ///< Bits of floats that are stored with fewer than theirs; else 0.
};

/// The stored values from `low` to `high`; none by default.
struct NodataRange {
  double low = std::numeric_limits<double>::infinity();
  double high = -std::numeric_limits<double>::infinity();
  [[nodiscard]] bool is_empty() const noexcept { return !(low <= high); }
  [[nodiscard]] bool holds(double stored) const noexcept { return low <= stored && stored <= high; }
};

/// The stored values that count as the nodata value: those to which the type may have rounded it. It
/// is often written with other digits than the type has:
///   - of integers the value itself, and none where the type does not have it;
///   - of Float32 the float next to it; of Float64 also what a float makes of it, since many doubles
///     were floats once; of floats with fewer bits those on either side of it;
///   - from 1e30 on, where no height is, all within a thousandth of it (-3.4e38 is meant for
///     -3.4028235e38); where the type does not reach as far, its largest values and the infinite.
/// NaN is void without a rule.
[[nodiscard]] NodataRange nodata_range(std::optional<double> nodata, const StoredType& stored);

/// The bits that a band keeps of each float, where its NBITS are fewer than its type's; else 0.
[[nodiscard]] int significant_bits_of(GDALDataType type, const char* nbits);

}  // namespace ptin
