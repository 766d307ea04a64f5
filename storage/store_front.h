// SPDX-License-Identifier: GPL-3.0-or-later
//
// What is read and checked when a file is opened: header, section table, metadata, T0, table of
// errors.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "storage/file/readable_file.h"
#include "storage/floor.h"
#include "storage/index_shape.h"
#include "storage/layout.h"
#include "storage/page_columns.h"
#include "storage/page_slots.h"
#include "storage/point_directory.h"
#include "storage/store_file.h"

namespace ptin {

struct StoreFront {
  layout::FileHeader header;
  /// Ascending by offset. Sections of unknown kinds, from later minor versions, are among them.
  std::vector<layout::SectionEntry> sections;
  StoreFacts facts;
  PageForm form;
  std::string metadata;
  CoarsestTin t0;
  std::vector<ErrorBin> bins;
  PageSlots slots;
  IndexShape index;
  std::uint64_t index_offset = 0;
  std::uint64_t root_checksum = 0;
  std::optional<DirectoryPlace> directory;
  std::optional<FloorPlace> floor;
};

/// Reads the front of a file and checks everything that storage/FORMAT.md lists under "At opening".
/// Cost: five reads, O(|T0|).
/// @throws Error corruption, unsupported_version, io_error
[[nodiscard]] StoreFront read_front(const ReadableFile& file);

/// The name of a section as `ptin info` shows it: "metadata", "t0 vertices", ..., "unknown".
[[nodiscard]] const char* name_of(layout::SectionKind kind) noexcept;

}  // namespace ptin
