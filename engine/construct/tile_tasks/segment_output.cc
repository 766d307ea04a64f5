// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/tile_tasks/segment_output.h"

#include <array>

namespace ptin {

void write_description(ArrayFileWriter& file, const PreparedSegment& segment) {
  const std::array<std::uint64_t, 2> numbers{segment.max_rank, segment.void_records};
  file.put(std::span(numbers));
  file.put(std::span(&segment.left_out, 1));
  file.put(segment.errors);
  file.put(segment.descriptors);
}

PreparedSegment read_description(ArrayFileReader& file) {
  PreparedSegment segment;
  const std::vector<std::uint64_t> numbers = file.take_copy<std::uint64_t>();
  segment.max_rank = static_cast<std::uint16_t>(numbers.at(0));
  segment.void_records = numbers.at(1);
  segment.left_out = file.take_copy<RecordBounds>().at(0);
  segment.errors = file.take_copy<ErrorBin>();
  segment.descriptors = file.take_copy<layout::NodeEntry>();
  return segment;
}

}  // namespace ptin
