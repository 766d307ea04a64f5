// SPDX-License-Identifier: GPL-3.0-or-later
//
// Declarations of coordinates in comments: of texts, of points and of TINs alike.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "engine/construct/grid/source_point.h"
#include "engine/construct/grid/source_warning.h"

namespace ptin {

/// Takes comments, one after the other, and follows those that can be taken in one way only:
///   - a CRS: `crs: EPSG:2154`, also `srs`, `epsg`, `projection`, `coordinate system` and their like,
///     with one code, WKT or a text of PROJ; GMT's `@Je2154` and `@Jp"+proj=..."`;
///   - a vertical CRS: `vertical crs: EPSG:5773`;
///   - units: `units: ft`, `File units = feet`, `unit m`; of heights alone `z units: ft` or
///     `height_units: ft`, which goes before the others;
///   - a value that means no height: `nodata -9999`.
/// All else that speaks of a CRS, a datum, a unit, an axis, a shift, a scale or a rotation is kept
/// to be warned of, as are two declarations that contradict each other. What says that there is
/// none ("scale: 1", "offset 0 0 0", "crs: unknown") is passed over. Not thread-safe.
class DeclaredComments {
 public:
  /// @param comment  Without its mark.
  /// Cost: a microsecond, a millisecond where it names a CRS.
  void note(std::string_view comment);

  /// Anything that GDAL understands, or that stands where a CRS belongs; "" for none.
  [[nodiscard]] const std::string& crs() const noexcept { return crs_.value; }
  [[nodiscard]] const std::string& vertical_crs() const noexcept { return vertical_crs_.value; }
  /// Those of the plane are left out where the CRS has others.
  [[nodiscard]] DeclaredUnits units() const;
  [[nodiscard]] std::optional<double> nodata() const;
  /// One warning that quotes all that is not followed.
  void tell(const std::string& path, SourceWarnings& warnings) const;

 private:
  struct Declared {
    std::string value, comment;
    bool is_contradicted = false;
  };
  [[nodiscard]] bool follow(std::string_view comment);
  [[nodiscard]] bool follow_gmt(std::string_view comment);
  [[nodiscard]] bool follow_remark(std::string_view comment);
  [[nodiscard]] bool take_crs(std::string_view key, std::string_view value, bool is_vertical);
  [[nodiscard]] bool take_unit(std::string_view value, bool is_vertical, bool is_plane);
  [[nodiscard]] bool take_nodata(std::string_view value);
  void set(Declared& declared, std::string value);
  void quote(std::string_view comment);

  std::string_view comment_;  ///< The one that is looked at.
  /// It began with a vertical CRS: a unit behind that is the heights'.
  bool is_of_heights_ = false;
  Declared crs_, vertical_crs_, nodata_;
  Declared plane_, heights_,
      both_;  ///< Units of x and y alone, of heights alone, and of all three.
  std::vector<std::string> not_followed_;
};

}  // namespace ptin
