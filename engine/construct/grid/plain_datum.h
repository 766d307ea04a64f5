// SPDX-License-Identifier: GPL-3.0-or-later
//
// Datums of a CRS as WKT: a plain one in place of an ensemble.
#pragma once

#include <string>
#include <string_view>

namespace ptin {

/// Returns `wkt` with DATUM (VDATUM for heights) in place of each ENSEMBLE, named as the ensemble
/// without the word: `ENSEMBLE["World Geodetic System 1984 ensemble", MEMBER[...], ELLIPSOID[...],
/// ENSEMBLEACCURACY[2.0]]` becomes `DATUM["World Geodetic System 1984", ELLIPSOID[...]]`, as
/// WKT2:2015 writes it. PROJ 9.1 gives either for the same CRS, by what was asked of it earlier in
/// the process; the same source must give the same bytes.
/// @param wkt WKT2:2019 on one line, as PROJ writes it. Other text is returned as it is.
[[nodiscard]] std::string with_plain_datums(std::string_view wkt);

}  // namespace ptin
