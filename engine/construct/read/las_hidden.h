// SPDX-License-Identifier: GPL-3.0-or-later
//
// Classes and returns of LAS 1.4 in extra bytes, where LASzip wrote a file for programs of LAS 1.3 and older (its "compatibility
// mode"): classes beyond 31, returns beyond 7, the overlap flag. As LASzip 3.4 reads it, src/laszip_dll.cpp.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "engine/construct/read/las_file.h"

namespace ptin {

/// Where it lies among the extra bytes of a point.
struct HiddenLas14 {
  std::uint32_t returns =
      0;                    ///< What is added to the number of the return (4 bits) and of returns.
  std::uint32_t cls = 0;    ///< What is added to the class.
  std::uint32_t flags = 0;  ///< Bit 0: overlap.
};

/// @return  None where the file says nothing of it, which only formats 1, 3, 4 and 5 before LAS 1.4 do.
/// @throws Error  io_error          the file cannot be read
///                invalid_argument  it says so, and does not name the extra bytes, or has no room for them
[[nodiscard]] std::optional<HiddenLas14> hidden_las14(const LasFile& file, const LasHeader& header);

/// Makes flags, returns and class at the beginning of records of formats 0 to 5 those of formats 6 to 10.
/// @param step   Bytes from one record to the next.
/// @param extra  Where the extra bytes of a record begin.
void show_las14(const HiddenLas14& hidden, std::uint64_t step, std::uint64_t extra,
                std::vector<unsigned char>& records);

}  // namespace ptin
