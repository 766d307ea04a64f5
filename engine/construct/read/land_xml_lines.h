// SPDX-License-Identifier: GPL-3.0-or-later
//
// Breaklines and boundaries of LandXML. For read/line_file.cc.
#pragma once

#include "engine/construct/read/line_file.h"

namespace ptin {

/// As read_line_file(), of LandXML.
[[nodiscard]] LineFileCrs read_land_xml_lines(const std::string& path, const LayerWish& wish,
                                              const TakeLine& take, const std::stop_token& stop);

}  // namespace ptin
