// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/ptin/export_report.h"

#include <cstdio>
#include <limits>

#include <nlohmann/json.hpp>

#include "engine/crs/crs_facts.h"
#include "tools/ask/questions.h"
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
  if (made.is_source) return "the source raster bit for bit";
  const bool is_height = made.what == "height";
  const Certificate& certificate = made.certificate;
  if (!is_height && certificate.error == 0 && certificate.deviation == 0)
    return made.what + " of the full TIN";
  return (is_height ? "" : made.what + " of a TIN that is ") + "within " +
         short_number(certificate.error) + " at every sample" + left_out + ", " +
         short_number(certificate.deviation) + " at any point";
}

}  // namespace

ask::Fields<Exported> exported_fields() {
  using Row = Exported;
  const auto of_raster = [](auto member) {
    return [member](const Row& made) {
      return made.is_raster ? ask::Json(made.*member) : ask::kLeftOut;
    };
  };
  const auto of_mesh = [](auto member) {
    return [member](const Row& made) {
      return made.is_raster ? ask::kLeftOut : ask::Json(made.*member);
    };
  };
  const auto of_changes = [](auto member) {
    return [member](const Row& made) {
      return made.changes ? ask::Json(*made.changes.*member) : ask::Json();
    };
  };
  ask::Fields<Row> fields;
  fields.add("output", "string", "", "The file, as it was named.", &Row::output);
  fields.add(
      "format", "string", "",
      "`PLY`, `OBJ`, `2DM`, `LandXML`, `DXF`, `STL`, `GPKG`, `FlatGeobuf`, `GTiff` or `COG`.",
      &Row::format);
  fields.add("bytes", "integer", "bytes", "The output's size.", &Row::bytes);
  fields.add("seconds", "number", "seconds", "On the clock.", &Row::seconds);
  fields.add("vertices", "integer", "", "Of triangles: written.", of_mesh(&Row::vertices));
  fields.add("triangles", "integer", "", "Of triangles: written.", of_mesh(&Row::triangles));
  fields.add("cells", "integer", "",
             "Of triangles: squares that the terrain was cut into for the work.",
             of_mesh(&Row::cells));
  fields.add_object("local_frame", "object",
                    "Of STL: where its coordinates stand, local = (map - origin) * scale.",
                    ask::frame_fields(), &Row::frame);
  fields.add("width", "integer", "pixels", "Of a raster.", of_raster(&Row::columns));
  fields.add("height", "integer", "pixels", "Of a raster.", of_raster(&Row::rows));
  fields.add("pixel_size", "array of numbers", ask::kMapUnit,
             "Width and height of a raster's pixel.", of_raster(&Row::pixel_size));
  fields.add("what", "string", "", "Of a raster: `height`, `slope`, `aspect` or `hillshade`.",
             of_raster(&Row::what));
  fields.add("slope_unit", "string", "", "Of a raster of slopes: `degree` or `percent`.",
             [](const Row& made) {
               return made.slope_unit.empty() ? ask::kLeftOut : ask::Json(made.slope_unit);
             });
  fields.add("samples_made_void", "integer or null", "",
             "Samples with a height (vertices of the file's finest TIN) in the region that lie in "
             "no surface triangle at this level of detail. Null: not counted, since nothing bounds "
             "how far the border moved, or the ground around it does not fit `--memory`.",
             of_changes(&ClassChanges::to_void));
  fields.add("samples_made_surface", "integer or null", "",
             "Samples without a height in the region that lie in no void triangle at this level.",
             of_changes(&ClassChanges::to_surface));
  fields.add("lone_samples", "integer", "",
             "Of the whole source, as `build` counted them: they are void, and no certificate "
             "speaks of them. 0 with `--source`.",
             &Row::lone_samples);
  return fields;
}

void print_json_of(const Exported& made, const StoreFile& store) {
  const Certificate& certificate = made.certificate;
  const CrsFacts crs = crs_facts(store);
  ask::AnswerFacts facts = ask::facts_of(
      certificate, certificate.complete && store.facts().base_error == 0 && made.rounding == 0,
      store, crs);
  facts.transformed = &made.transformed;
  // The certificate speaks of heights.
  if (made.what != "height") {
    facts.certified_error = facts.certified_deviation = std::numeric_limits<double>::infinity();
  }
  print_answer({}, exported_fields(), made, facts);
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
