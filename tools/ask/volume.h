// SPDX-License-Identifier: GPL-3.0-or-later
//
// The question of volumes: `ptin volume`.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "tools/ask/field.h"
#include "tools/ask/groups.h"

namespace ptin::ask {

struct VolumeQuestion {
  Levels levels;
  std::string against;  ///< The other terrain; empty: levels.
  RegionText region;
  DetailRequest detail;
};
void add_volume(Parameters& rows, VolumeQuestion& question);

/// The volumes of a level, or over the other terrain.
struct VolumeRow {
  const VolumeResult* result;
  std::optional<double> level;
};
[[nodiscard]] Fields<VolumeRow> volume_row_fields();

struct VolumeAnswer {
  std::vector<VolumeRow> rows;
  /// What is told of the other terrain.
  struct Against {
    std::string file;
    double certified_error, certified_deviation, border_moved_at_most;
  };
  std::optional<Against> against;
  std::string ground_unit;
};
[[nodiscard]] Fields<VolumeAnswer> volume_fields();

}  // namespace ptin::ask
