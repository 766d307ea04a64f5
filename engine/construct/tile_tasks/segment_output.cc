// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/tile_tasks/segment_output.h"

namespace ptin {

void add_segment(SegmentOutput& output, StarredRecords& records) {
  const PreparedSegment segment = output.packer().prepare(records);
  output.packer().place(segment.pages, output.page_bytes());
  output.add(segment.description);
}

}  // namespace ptin
