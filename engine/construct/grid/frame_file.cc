// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/grid/frame_file.h"

namespace ptin {

namespace {

/// Without a byte that means nothing: the same frame makes the same file.
struct PlainFrame {
  AffineMap map;
  std::uint64_t height_type;
  double height_step, height_offset;
  double height_rounding, height_quantum, min_height, max_height;
  std::uint32_t vertical_crs_known, geographic;
};

}  // namespace

void put_frame(ArrayFileWriter& file, const TerrainFrame& f) {
  const PlainFrame plain{f.map,
                         static_cast<std::uint64_t>(f.heights.type),
                         f.heights.step,
                         f.heights.offset,
                         f.height_rounding,
                         f.height_quantum,
                         f.min_height,
                         f.max_height,
                         f.vertical_crs_known ? 1U : 0U,
                         f.geographic ? 1U : 0U};
  file.put(std::span(&plain, 1));
  for (const std::string& text : {f.crs_wkt, f.horizontal_unit, f.vertical_unit}) {
    file.put_text(text);
  }
}

TerrainFrame take_frame(ArrayFileReader& file) {
  const PlainFrame plain = file.take<PlainFrame>()[0];
  TerrainFrame f;
  f.map = plain.map;
  f.heights = {static_cast<HeightType>(plain.height_type), plain.height_step, plain.height_offset};
  f.height_rounding = plain.height_rounding;
  f.height_quantum = plain.height_quantum;
  f.min_height = plain.min_height;
  f.max_height = plain.max_height;
  f.vertical_crs_known = plain.vertical_crs_known != 0;
  f.geographic = plain.geographic != 0;
  f.crs_wkt = file.take_text();
  f.horizontal_unit = file.take_text();
  f.vertical_unit = file.take_text();
  return f;
}

}  // namespace ptin
