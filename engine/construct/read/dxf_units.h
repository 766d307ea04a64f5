// SPDX-License-Identifier: GPL-3.0-or-later
//
// The unit that a DXF file declares, which OGR does not hand on.
#pragma once

#include <string>

namespace ptin {

/// The unit of a DXF's coordinates by $INSUNITS of its header, as height_unit_named() has it; "" where
/// the file states none, or one that is not known.
/// @throws Error  not_found, io_error
/// Cost: reads the header, some hundred lines.
[[nodiscard]] std::string unit_of_dxf(const std::string& path);

/// True where the objects of a DXF state a CRS (GEODATA), which OGR does not read. False for a
/// binary one.
/// @throws Error not_found, io_error
/// Cost: reads the file.
[[nodiscard]] bool has_geodata(const std::string& path);

}  // namespace ptin
