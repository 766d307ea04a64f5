// SPDX-License-Identifier: GPL-3.0-or-later
//
// ptin refine: one question to the store, one mesh file.
#include <cmath>
#include <cstdio>

#include <nlohmann/json.hpp>

#include "engine/crs/crs_facts.h"
#include "tools/ask/questions.h"
#include "tools/error_status.h"
#include "tools/facts/answers.h"
#include "tools/facts/human.h"
#include "tools/formats/mesh_writer.h"
#include "tools/formats/solid_stream.h"
#include "tools/output/output_file.h"
#include "tools/ptin/model_options.h"
#include "tools/ptin/query_options.h"
#include "tools/region/cut.h"
#include "tools/region/mesh_crs.h"
#include "tools/region/tin_mesh.h"

namespace ptin::tools {

namespace {

struct RefineOptions {
  TerrainOptions terrain;
  ask::RegionText region;
  RefineRequest request;
  ModelOptions model;
  bool clip = false;
  bool cut = false;
  std::optional<std::uint64_t> memory;
  OutputOptions out;
  bool stats = false;
};

void check_options(const RefineOptions& options) {
  if ((options.clip || options.cut) && !options.region.given()) {
    throw Error(ErrorCode::invalid_argument,
                "--clip and --cut need a region; add --window or --polygon");
  }
  if (options.cut && !options.region.point.empty()) {
    throw Error(ErrorCode::invalid_argument,
                "--cut needs an area; a point has none (--clip keeps its triangle)");
  }
  static_cast<void>(mesh_format_of(options.out.output));
  check_model(options.model, options.out.output);
  check_output(options.out.output, options.out.overwrite);
}

/// Why so many vertices or triangles are written and not as many as were asked for; empty where as
/// many are, or where no number was asked for.
/// @param vertices  Of the terrain.
std::string difference_of(const RefineOptions& options, const RefinedTin& refined, const Mesh& mesh,
                          std::uint64_t vertices) {
  const bool by_vertices = options.request.detail.vertices.has_value();
  if (!by_vertices && !options.request.triangles) return {};
  const std::uint64_t asked =
      by_vertices ? *options.request.detail.vertices : *options.request.triangles;
  const std::uint64_t found = by_vertices ? refined.vertices : refined.triangles;
  const std::uint64_t written = by_vertices ? mesh.vertices.size() : mesh.triangles.size();
  if (written == asked) return {};
  const std::string what =
      by_vertices ? counted(asked, "vertex", "vertices") : "at most " + counted(asked, "triangle");
  if (options.clip || options.cut) return what + "; the region's part of that mesh is written";
  std::string why;
  if (found < asked) {
    const bool is_whole = refined.vertices == vertices;
    const bool next_adds_two = !by_vertices && !is_whole && found + 1 == asked;
    why = next_adds_two ? "; the next vertex adds two"
                        : std::string("; the ") + (is_whole ? "terrain" : "region") + " has " +
                              grouped(found);
  }
  if (written < found) {
    why += "; " + grouped(found - written) +
           (by_vertices ? " in void triangles alone are left out" : " void ones are left out");
  }
  return what + why;
}

void print_written(const RefineOptions& options, const RefinedTin& refined, const Mesh& mesh,
                   const StoreFile& store) {
  std::printf("%s: %s, %s written\n", options.out.output.c_str(),
              counted(mesh.vertices.size(), "vertex", "vertices").c_str(),
              counted(mesh.triangles.size(), "triangle").c_str());
  const std::uint64_t vertices = store.t0().vertices.size() + store.record_count();
  const std::string difference = difference_of(options, refined, mesh, vertices);
  if (!difference.empty()) std::printf("  asked for  %s\n", difference.c_str());
  if (has_frame(options.out.output))
    std::printf("  frame      %s\n", frame_text(mesh.frame).c_str());
}

void print_stats(const RefineOptions& options, const RefinedTin& refined) {
  const QueryCost& cost = refined.cost;
  std::printf("  mesh       %s (%s without a height), %s; T0 has %s\n",
              counted(refined.vertices, "vertex", "vertices").c_str(),
              grouped(refined.void_vertices).c_str(),
              counted(refined.triangles, "triangle").c_str(),
              counted(refined.t0_vertices, "vertex", "vertices").c_str());
  std::printf("  certified  %s at every sample%s, %s at any point%s\n",
              short_number(refined.certified_error).c_str(),
              options.region.given() ? " of the region" : "",
              short_number(refined.certified_deviation).c_str(), refined.exact ? "; exact" : "");
  std::printf(
      "  cost       %s retrieved of %s examined, %s applied; %s, %s, %s, "
      "%.3f s\n",
      counted(cost.records_retrieved, "record").c_str(), grouped(cost.records_examined).c_str(),
      grouped(cost.records_applied).c_str(), counted(cost.io.index_nodes, "index node").c_str(),
      counted(cost.io.pages, "page").c_str(), human_bytes(cost.io.bytes_read).c_str(),
      cost.seconds);
  if (cost.io.remote_rounds == 0) return;
  std::printf("  elsewhere  %s in %s, %s\n", counted(cost.io.remote_requests, "request").c_str(),
              counted(cost.io.remote_rounds, "round").c_str(),
              human_bytes(cost.io.remote_bytes).c_str());
}

int run_refine(const RefineOptions& options, const Context& context) {
  check_options(options);
  const Terrain terrain = open_terrain(options.terrain, options.request.detail.tolerance, context);
  const CrsFacts crs = crs_facts(terrain.store());
  RefineRequest request = options.request;
  const AskedRegion asked = region_of(options.region, terrain.store().facts(), crs, context);
  request.region = asked.region;
  request.form = options.clip ? ResultForm::kMeetingRegion : ResultForm::kWholeDomain;
  request.limits = limits_of(options.memory, context);
  const RefinedTin refined = terrain.refine(request);

  const StoreFacts& facts = terrain.store().facts();
  Mesh mesh =
      options.cut ? cut_to_region(refined, facts, *request.region) : surface_mesh(refined, facts);
  set_crs(mesh, crs, facts);
  apply_model(options.model, options.out.output, mesh.frame.scale);
  apply_model(options.model, options.out.output, mesh.metres_per_unit);
  const Mesh solid = options.model.base ? solid_of(mesh, *options.model.base) : Mesh{};
  const Mesh& written = options.model.base ? solid : mesh;
  write_mesh(written, options.out.output, options.out.overwrite);
  if (mesh.triangles.empty() && !context.quiet) {
    std::fprintf(stderr, "ptin: warning: the region holds no surface; %s has no triangle\n",
                 options.out.output.c_str());
  }
  if (context.json) {
    print_answer({{"output", options.out.output}}, ask::mesh_fields(),
                 {&refined, written.vertices.size(), written.triangles.size(),
                  has_frame(options.out.output) ? &written.frame : nullptr},
                 ask::facts_of(refined, terrain.store(), crs, &asked.transformed));
  } else if (!context.quiet) {
    print_written(options, refined, mesh, terrain.store());
    if (options.model.base) {
      std::printf("  solid      %s with walls and base\n",
                  counted(solid.triangles.size(), "triangle").c_str());
    }
    if (options.stats) print_stats(options, refined);
  }
  return kExitDone;
}

void add_question(ask::Parameters& rows, RefineOptions& options) {
  add_terrain(rows, options.terrain, true);
  ask::add_region(rows, options.region, ask::Door::kProgram);
  rows.add("point", &options.region.point, "X Y", "A point")
      .in(ask::Unit::kMap)
      .values(2, 2)
      .excluding("window polygon");
  ask::add_detail(
      rows, options.request.detail, "",
      "A mesh of exactly this many vertices, the most important ones of the region; not written "
      "are those in void triangles alone, and what --clip and --cut leave out");
  rows.add("triangles", &options.request.triangles, "N",
           "The mesh of the most important vertices that has at most this many triangles, void "
           "ones included; --clip and --cut leave some of them out")
      .excluding("error vertices");
  rows.add("clip", &options.clip, "", "Keep only the triangles that meet the region, whole");
  rows.add("cut", &options.cut, "", "Cut the triangles at the border of the region")
      .excluding("clip");
  std::string formats;
  for (const MeshFormat& format : mesh_formats()) {
    formats.append(formats.empty() ? "." : ", .").append(format.extension);
  }
  add_output(rows, options.out, "The mesh to write; its extension chooses the format: " + formats);
  add_model(rows, options.model);
  rows.add("stats", &options.stats, "", "Print what is certified and what it cost, too");
  ask::add_memory(rows, options.memory);
}

}  // namespace

Declared declare_refine(Context& context) { return declared<RefineOptions>(context, run_refine); }

}  // namespace ptin::tools
