// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/collapse/tile_compact.h"

#include <algorithm>
#include <span>
#include <utility>

#include "engine/construct/collapse/carried_samples.h"

namespace ptin {

void lay_out_samples(Tile& tile) {
  SampleLists lists;
  lists.reserve(tile.samples.used() + tile.samples.used() / 4);
  for (CarriedState& carried : tile.carried) {
    const std::span<const Sample> from = std::as_const(tile.samples).samples(carried.samples);
    carried.samples = lists.take(static_cast<std::uint32_t>(from.size()));
    std::copy(from.begin(), from.end(), lists.samples(carried.samples).begin());
  }
  tile.samples = std::move(lists);
}

namespace {

/// Moves lists up in place, in the order that they have, and cuts them down to `most` samples. In a
/// tile of carried samples lists are most of the memory, and lay_out_samples() would have them
/// twice.
void close_gaps_of_samples(Tile& tile, std::size_t most) {
  std::vector<SampleSlot*> slots;
  std::vector<Sample> chosen;
  for (TriangleId t = 0; t < tile.carried.size(); ++t) {
    SampleSlot& slot = tile.carried[t].samples;
    if (slot.count > most) {
      const std::span<Sample> all = tile.samples.samples(slot);
      chosen.assign(all.begin(), all.end());
      choose_carried_samples(tile, t, chosen, most);
      std::copy(chosen.begin(), chosen.end(), all.begin());
      slot.count = static_cast<std::uint32_t>(chosen.size());
    }
    if (slot.count > 0) {
      slots.push_back(&slot);
    }
  }
  tile.samples.close_gaps(std::move(slots));
}

}  // namespace

Renumbering compact(Tile& tile, std::size_t most_samples) {
  keep_numbered(compact_triangles(tile.tin), tile.carried);
  Renumbering vertices = compact_vertices(tile.tin);
  keep_numbered(vertices, tile.vertex_state);
  if (most_samples == kAllSamples) {
    lay_out_samples(tile);
  } else {
    close_gaps_of_samples(tile, most_samples);
  }
  return vertices;
}

}  // namespace ptin
