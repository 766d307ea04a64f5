// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/hierarchy/tile_files.h"

#include <algorithm>

#include "engine/check.h"

namespace ptin {

namespace {

/// CarriedState without what the record has (box and chain) and what the reader makes (the slot).
struct StoredCarried {
  std::uint32_t record;
  std::uint32_t samples;
  std::uint32_t holds;  ///< Bit 0: heights, bit 1: voids.
};

}  // namespace

void write_pushed(ArrayFileWriter& out, const Tile& tile) {
  std::vector<float> reaches;
  for (const VertexState& v : tile.vertex_state) {
    reaches.push_back(v.reach);
  }
  std::vector<StoredCarried> carried;
  std::vector<Sample> samples;
  for (const CarriedState& c : tile.carried) {
    const std::span<const Sample> own = tile.samples.samples(c.samples);
    carried.push_back({c.record, static_cast<std::uint32_t>(own.size()),
                       (c.holds_heights ? 1U : 0U) | (c.holds_voids ? 2U : 0U)});
    samples.insert(samples.end(), own.begin(), own.end());
  }
  out.values(tile.samples_fill_grid, tile.has_voids, tile.tin.vertices, tile.tin.has_height,
             reaches, tile.tin.triangles, tile.tin.classes, carried, samples, tile.records);
}

Tile read_pushed(ArrayFileReader& in, const MeasureUnits& units) {
  Tile tile;
  tile.units = units;
  in.values(tile.samples_fill_grid, tile.has_voids, tile.tin.vertices, tile.tin.has_height);
  for (const float reach : in.take<float>()) {
    tile.vertex_state.push_back({reach, 0, false});
  }
  in.values(tile.tin.triangles, tile.tin.classes);
  const auto carried = in.take<StoredCarried>();
  const auto samples = in.take<Sample>();
  tile.records = in.take_copy<VertexSplit>();
  tile.carried.reserve(carried.size());
  auto next = samples.begin();
  for (const StoredCarried& c : carried) {
    CarriedState state;
    if (c.record != kNone) {
      carry_record(state, tile.records[c.record], c.record);
    }
    state.samples = tile.samples.take(c.samples);
    std::copy_n(next, c.samples, tile.samples.samples(state.samples).begin());
    next += c.samples;
    state.holds_heights = (c.holds & 1U) != 0;
    state.holds_voids = (c.holds & 2U) != 0;
    tile.carried.push_back(state);
  }
  in.require_undamaged();
  return tile;
}

void write_segment(ArrayFileWriter& out, const InnerSegment& segment) {
  out.values(segment.foreign, segment.child_begin, segment.records, segment.stars.corners,
             segment.stars.successors, segment.stars.ring_end, segment.exported);
}

SegmentFile::SegmentFile(const TileId& id, const std::string& path, const ArrayFileFacts& facts)
    : file_(path, facts) {
  view_.id = id;
  view_.foreign = file_.take<RecordBounds>();
  view_.child_begin = file_.take<std::uint32_t>();
  view_.records = file_.take<VertexSplit>();
  view_.corners = file_.take<RingCorner>();
  view_.successors = file_.take<std::uint32_t>();
  view_.ring_end = file_.take<std::uint32_t>();
  view_.exported = file_.take<std::uint32_t>();
}

}  // namespace ptin
