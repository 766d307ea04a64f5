// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/ptin/export_report.h"

#include <cstdio>

#include <nlohmann/json.hpp>

#include "engine/crs/crs_facts.h"
#include "tools/facts/answers.h"
#include "tools/facts/human.h"
#include "tools/ptin/query_options.h"
#include "tools/region/mesh_crs.h"

namespace ptin::tools {

namespace {

std::string size_text(const Exported& made) {
  if (!made.is_raster) {
    return counted(made.vertices, "vertex", "vertices") + ", " +
           counted(made.triangles, "triangle") + " in " + counted(made.cells, "cell");
  }
  return grouped(static_cast<std::uint64_t>(made.columns)) + " x " +
         grouped(static_cast<std::uint64_t>(made.rows)) + " pixels of " +
         short_number(made.pixel_size[0]) + " x " + short_number(made.pixel_size[1]);
}

/// The samples of which the certificate does not speak.
const char* left_out_text(bool has_moved, bool has_lone) {
  if (has_moved)
    return has_lone ? " (but where voids moved, and lone ones)" : " (but where voids moved)";
  return has_lone ? " (but lone ones)" : "";
}

/// "within 2 at every sample, 3.1 at any point", "slope of the full TIN".
std::string certainty_text(const Exported& made, const std::string& left_out) {
  const bool is_height = made.what == "height";
  const Certificate& certificate = made.certificate;
  if (!is_height && certificate.error == 0 && certificate.deviation == 0)
    return made.what + " of the full TIN";
  return (is_height ? "" : made.what + " of a TIN that is ") + "within " +
         short_number(certificate.error) + " at every sample" + left_out + ", " +
         short_number(certificate.deviation) + " at any point";
}

}  // namespace

nlohmann::json json_of(const Exported& made, const StoreFile& store) {
  const Certificate& certificate = made.certificate;
  nlohmann::json answer = {
      {"output", made.output},
      {"format", made.format},
      {"certified_error", certificate.error},
      {"certified_deviation", certificate.deviation},
      {"border_moved_at_most", border_move_json(store, certificate.error)},
      {"samples_made_void", made.changes ? nlohmann::json(made.changes->to_void) : nullptr},
      {"samples_made_surface", made.changes ? nlohmann::json(made.changes->to_surface) : nullptr},
      {"lone_samples", made.lone_samples},
      {"exact", certificate.complete && store.facts().base_error == 0 && made.rounding == 0},
      {"transformed", transformed_json(made.transformed)},
      {"units", units_json(crs_facts(store))},
      {"bytes", made.bytes},
      {"seconds", made.seconds}};
  if (made.is_raster) {
    answer["width"] = made.columns;
    answer["height"] = made.rows;
    answer["pixel_size"] = made.pixel_size;
    answer["what"] = made.what;
  } else {
    answer["vertices"] = made.vertices;
    answer["triangles"] = made.triangles;
    answer["cells"] = made.cells;
  }
  if (!made.slope_unit.empty()) answer["slope_unit"] = made.slope_unit;
  if (made.what != "height") answer["certified_error"] = answer["certified_deviation"] = nullptr;
  if (made.frame) answer["local_frame"] = frame_json(*made.frame);
  return answer;
}

void print_exported(const Exported& made, const StoreFacts& facts) {
  const bool may_move = !facts.free_of_voids && !made.certificate.complete;
  const bool has_moved =
      may_move && (!made.changes || made.changes->to_void + made.changes->to_surface > 0);
  std::printf("%s: %s, %s, %.2f s; %s\n", made.output.c_str(), size_text(made).c_str(),
              human_bytes(made.bytes).c_str(), made.seconds,
              certainty_text(made, left_out_text(has_moved, made.lone_samples > 0)).c_str());
  if (made.lone_samples > 0) {
    std::printf("  lone     %s of the source without a triangle, treated as void\n",
                counted(made.lone_samples, "sample").c_str());
  }
  if (may_move && made.changes) {
    std::printf("  classes  %s became void, %s surface\n",
                counted(made.changes->to_void, "sample").c_str(),
                grouped(made.changes->to_surface).c_str());
  }
  if (made.frame) std::printf("  frame  %s\n", frame_text(*made.frame).c_str());
}

}  // namespace ptin::tools
