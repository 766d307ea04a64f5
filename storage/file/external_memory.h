// SPDX-License-Identifier: GPL-3.0-or-later
//
// Where steps that outgrow memory put what does not fit.
#pragma once

#include <cstdint>
#include <string>

#include "storage/file/file_layer.h"

namespace ptin {

/// Where a step of reading or sorting keeps its temporary files, and how much memory it may take.
struct ExternalMemory {
  FileLayer& files;
  std::string folder;  ///< Must exist. Files in it have no names: they are gone with the process.
  std::uint64_t bytes = std::uint64_t{64} << 20;  ///< Memory that the step may take.
};

}  // namespace ptin
