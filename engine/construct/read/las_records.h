// SPDX-License-Identifier: GPL-3.0-or-later
//
// The variable length records of a LAS file, before its points and behind them.
#pragma once

#include <cstdint>
#include <functional>
#include <string>

#include "engine/construct/read/las_file.h"
#include "engine/construct/read/las_reader.h"

namespace ptin {

/// A record, whose content lies in the file.
struct LasRecordHead {
  std::string user;      ///< Whose kind of record it is.
  std::uint16_t id = 0;  ///< The number of the kind among those of the user.
  std::uint64_t at = 0, bytes = 0;
};

/// Where records lie, and what the header says of them.
struct LasRecordPlace {
  std::uint64_t begin = 0, end = 0;  ///< Bytes of the file.
  std::uint64_t count = 0;
  bool extended = false;  ///< Records have lengths of 64 bits.
};

/// Those before the points, which end where the points begin.
[[nodiscard]] LasRecordPlace records_before_points(const LasFile& file, const LasHeader& header);
/// Those behind the points, which end with the file.
[[nodiscard]] LasRecordPlace records_behind_points(const LasFile& file, const LasHeader& header);

/// Visits the head of each record, of the first 65 536.
/// @return  How many there are before place.end.
/// @throws Error io_error; whatever `visit` throws
std::uint64_t walk_records(const LasFile& file, const LasRecordPlace& place,
                           const std::function<void(const LasRecordHead& record)>& visit);

}  // namespace ptin
