// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/ptin/cli.h"

#include <algorithm>
#include <array>
#include <cstdio>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <cpl_conv.h>
#include <cpl_error.h>
#include <gdal.h>
#include <nlohmann/json.hpp>

#include "engine/crs/proj_messages.h"
#include "tools/error_status.h"
#include "tools/facts/human.h"
#include "tools/output/standard_output.h"
#include "tools/ptin/command_line.h"
#include "tools/ptin/kept_inputs.h"
#include "tools/ptin/usage_fault.h"
#include "tools/refused_memory.h"

namespace ptin::tools {

namespace {

constexpr auto kCommands = std::to_array<Command>({
    {"build", "Build a .ptin file from a raster, points or a TIN",
     "Examples:\n"
     "  ptin build dem.tif -o dem.ptin\n"
     "  ptin build north.vrt -o north.ptin --max-error 5 --vertical-crs EPSG:5773\n"
     "  ptin build points.csv -o points.ptin --a-srs EPSG:2154 --resolution 0.01\n"
     "  ptin build survey.txt -o survey.ptin --columns id n e z code\n"
     "  ptin build scan_*.laz --class 2 -o ground.ptin\n"
     "  ptin build survey.gpkg --layer spots --z-field height -o survey.ptin\n",
     declare_build},
    {"build-part", "Do one job of a build that was divided by `ptin build --parts`",
     "The phases follow each other: collapse (each part), join, tighten (each part), publish. A "
     "job\n"
     "that is done again does nothing; one that died has left nothing that counts.\n\n"
     "Examples:\n"
     "  ptin build huge.vrt -o huge.ptin --parts 16 --plan huge.plan\n"
     "  ptin build-part huge.plan collapse 3\n"
     "  ptin build-part huge.plan join\n"
     "  ptin build-part huge.plan tighten 3\n"
     "  ptin build-part huge.plan publish\n",
     declare_build_part},
    {"info", "Tell what a .ptin file holds",
     "Examples:\n"
     "  ptin info dem.ptin\n"
     "  ptin info dem.ptin --json | jq .vertices_at_tolerance\n",
     declare_info, true},
    {"verify",
     "Check a .ptin file: checksums, structure, records, and its errors against the source",
     "Every checksum and rule of the format is looked at, and every split applied: it must find\n"
     "its triangles, and the records that it needs must contain its own. Exit status 0 when\n"
     "everything holds, 1 with the first faults listed when not.\n\n"
     "Examples:\n"
     "  ptin verify dem.ptin\n"
     "  ptin verify dem.ptin --against dem.tif\n"
     "  ptin verify dem.ptin --against dem.tif --tolerance 0 5 20\n",
     declare_verify},
    {"refine", "Write a TIN that is as fine as asked exactly where asked",
     "Without a region the whole terrain is refined. With a region the result covers the whole "
     "terrain, coarse outside\n"
     "of the region; --clip keeps the triangles that meet it, --cut cuts them at its border.\n"
     "Without --error, --vertices and --triangles the result is exact: every triangle of the full "
     "TIN in the region.\n\n"
     "Examples:\n"
     "  ptin refine dem.ptin --window 385000 3790000 390000 3795000 --clip -o valley.ply\n"
     "  ptin refine dem.ptin --polygon parish.geojson --cut --error 2 -o parish.glb\n"
     "  ptin refine dem.ptin --vertices 50000 -o small.obj --stats\n"
     "  ptin refine dem.ptin --triangles 20000 -o game.glb\n"
     "  ptin refine dem.ptin --point 387500 3792500 --clip -o triangle.2dm\n",
     declare_refine, true},
    {"isoline", "Write isolines (contours) as lines, or as polygons between them",
     "Lines keep higher ground on their right; a vertex at a level counts as above it. They are "
     "those of one TIN\n"
     "whatever the window and the memory: cut at two windows they meet in the same coordinates. "
     "The layer is `contour`\n"
     "with the fields ID and elev, or elev_min and elev_max, as gdal_contour's.\n\n"
     "Examples:\n"
     "  ptin isoline dem.ptin --interval 20 -o contours.gpkg\n"
     "  ptin isoline dem.ptin --level 500 1000 --3d -o two.fgb --error 2\n"
     "  ptin isoline dem.ptin --interval 100 --base 50 --polygons -o bands.gpkg\n"
     "  ptin isoline dem.ptin --interval 2 --window 385000 3790000 390000 3795000 -o site.dxf\n"
     "  ptin isoline dem.ptin --level 0 --window 385000 3790000 390000 3795000 -o - | jq "
     ".features\n",
     declare_isoline, true},
    {"export", "Write the whole TIN, or a raster of it, however large",
     "Works through the terrain part by part within --memory; the output does not depend on the "
     "parts.\n"
     "With a region: the triangles that meet it, whole. Triangles become POLYGON Z in .gpkg and "
     ".fgb.\n"
     "Rasters are sampled at pixel centres, which stand at multiples of the pixel's size from the "
     "terrain's\n"
     "south-western sample.\n\n"
     "Examples:\n"
     "  ptin export dem.ptin -o dem.ply\n"
     "  ptin export dem.ptin --error 2 --memory 256M -o dem_2m.gpkg\n"
     "  ptin export dem.ptin --error 0.1 --window 385000 3790000 390000 3795000 -o site.xml\n"
     "  ptin export dem.ptin --error 5 --pixel-size 90m -o coarse.tif\n"
     "  ptin export dem.ptin --what slope --slope-unit percent -o slope.tif\n"
     "  ptin export dem.ptin --window 385000 3790000 390000 3795000 --format COG -o valley.tif\n",
     declare_export, true},
    {"stream", "Send a terrain progressively, the most important first",
     "T0, then vertex splits in frames of which any first few are a valid TIN with a certified "
     "error; a receiver may stop\n"
     "anywhere. With --have... only what the receiver does not have is sent; `ptin unstream` tells "
     "what it has (--have).\n\n"
     "Examples:\n"
     "  ptin stream dem.ptin -o dem.pts\n"
     "  ptin stream dem.ptin --error 5 -o - | ssh field 'ptin unstream - -o dem.ply'\n"
     "  ptin stream dem.ptin --window 385000 3790000 390000 3795000 --have-error 5 -o more.pts\n"
     "  ptin stream dem.ptin --error 1 --have-error 1 --have-splits 20000 -o rest.pts\n"
     "  ptin stream dem.ptin --level 500 1000 -o isolines.pts\n",
     declare_stream, true},
    {"unstream", "Receive what `ptin stream` sent, cut off anywhere or not, as a mesh",
     "Several streams follow each other: the first begins with T0, each other goes on from "
     "there.\n\n"
     "Examples:\n"
     "  ptin unstream dem.pts -o dem.ply\n"
     "  head -c 100000 dem.pts | ptin unstream - -o coarse.glb\n"
     "  ptin unstream dem.pts more.pts -o dem.ply --json\n"
     "  ptin unstream isolines.pts --level 500 1000 -o contours.gpkg\n"
     "  ptin unstream isolines.pts --level 500 --steps -o arriving.gpkg\n",
     declare_unstream, true},
    {"viewer", "Write a web page that shows a stream and refines it while it arrives",
     "The page needs no program on the host: any that gives out files will do. It opens the stream "
     "beside it, or one that\n"
     "its address names: index.html?stream=https://example.org/dem.ptins\n\n"
     "Examples:\n"
     "  ptin stream dem.ptin -o dem.ptins && ptin viewer -o site --stream dem.ptins\n"
     "  ptin viewer -o site && python3 -m http.server --directory site\n",
     declare_viewer, true},
    {"tiles", "Write heights as tiles of a web map, in one file for any host",
     "Terrain-RGB for MapLibre, deck.gl and their like: Web Mercator, XYZ, as `ptin serve` gives "
     "them out at\n"
     "/collections/NAME/dem. Heights are metres above the datum of the terrain's heights; each "
     "zoom is as exact as its\n"
     "pixels, the last one is the full TIN.\n\n"
     "Examples:\n"
     "  ptin tiles dem.ptin -o dem.pmtiles\n"
     "  ptin tiles dem.ptin -o dem.pmtiles --encoding terrarium --format webp --size 512\n"
     "  ptin tiles dem.ptin -o overview.pmtiles --zooms 0 9\n",
     declare_tiles},
    {"highest", "Find the highest or lowest point of a window or a polygon",
     "Exact, of the full TIN. Reads little more than what lies around the answer.\n\n"
     "Examples:\n"
     "  ptin highest dem.ptin\n"
     "  ptin highest dem.ptin --window 385000 3790000 390000 3795000 -k 10 --json\n"
     "  ptin highest dem.ptin --polygon park.gpkg --lowest\n",
     declare_highest, true},
    {"volume", "Measure cut and fill against a level, or between two terrains",
     "Cut is what lies above the level or above OTHER, fill what lies below, net is cut less fill. "
     "Integrals over the\n"
     "triangles, or over those of the overlay of both TINs; with --error, and always with "
     "--max-error files, the volumes\n"
     "of the sources lie in the intervals.\n\n"
     "Examples:\n"
     "  ptin volume dem.ptin --level 1000\n"
     "  ptin volume lake.ptin --interval 0.5 -o stages.csv\n"
     "  ptin volume lake.ptin --level 410 411 412 413 -o stages.svg\n"
     "  ptin volume before.ptin --against after.ptin --polygon pit.gpkg\n"
     "  ptin volume lake.ptin --level 412.5 --window 385000 3790000 390000 3795000 --error 2 "
     "--json\n",
     declare_volume, true},
    {"locate", "Tell the triangle and the height at points",
     "Three answers, told apart: a height (surface), void, outside. None is an error.\n\n"
     "Examples:\n"
     "  ptin locate dem.ptin 387500 3792500 --json\n"
     "  ptin locate dem.ptin --points survey.txt --columns id y x z code\n"
     "  ptin locate dem.ptin --points tour.gpx --layer waypoints --error 5\n"
     "  ptin locate dem.ptin --points wells.gpkg --vertices 20000\n"
     "  cut -d, -f2,3 track.csv | ptin locate dem.ptin --points - > heights.csv\n",
     declare_locate, true},
    {"profile", "Tell the height along a line, with a break at every edge crossed",
     "Examples:\n"
     "  ptin profile dem.ptin --line 'LINESTRING(385000 3790000, 390000 3795000)'\n"
     "  ptin profile dem.ptin --line road.geojson --error 1 -o road.png\n"
     "  ptin profile dem.ptin --line road.geojson --stations 50m --stations-only -o stations.csv\n"
     "  ptin profile dem.ptin --line tracks.gpkg -o - | jq .features[0].properties\n",
     declare_profile},
    {"sight", "Tell whether one point sees another, and what is in the way",
     "Hidden: some inner point of the line lies below the surface. Touching is visible; voids do "
     "not obstruct.\n"
     "Heights are above ground, or with --absolute absolute.\n\n"
     "Examples:\n"
     "  ptin sight dem.ptin 385000 3790000 2 390000 3795000 10 --json\n"
     "  ptin sight dem.ptin 385000 3790000 20 390000 3795000 30 --frequency 5.8GHz -o link.png\n"
     "  ptin sight dem.ptin --pairs links.csv --frequency 5.8GHz > links_seen.csv\n"
     "  ptin sight dem.ptin --pairs - --verdict --curvature 0 < pairs.txt\n",
     declare_sight, true},
    {"viewshed", "Find what one observer sees",
     "A target is hidden when some point of the straight line to it lies strictly below the "
     "surface; "
     "touching is\n"
     "visible, and voids hide nothing. The surface is the TIN, without interpolation of cells.\n\n"
     "Examples:\n"
     "  ptin viewshed dem.ptin 387500 3792500 1.7 --radius 10000 -o seen.tif\n"
     "  ptin viewshed dem.ptin 387500 3792500 30 --radius 40000 --curvature 0 -o seen.gpkg\n",
     declare_viewshed},
    {"render", "Draw shaded relief, triangles or pages as PNG, SVG or PDF",
     "Examples:\n"
     "  ptin render dem.ptin -o dem.png\n"
     "  ptin render dem.ptin --error 20 --wireframe -o coarse.png\n"
     "  ptin render dem.ptin --window 385000 3790000 390000 3795000 --pages --size 1600 1200 -o "
     "pages.png\n",
     declare_render, true},
    {"bench", "Measure how fast this disk answers questions, and which way of reading is best",
     "Points, sight lines, windows and isolines at seeded places, cold (dropped from the page "
     "cache) and warm: announced\n"
     "pages of a mapping, faults, pread, io_uring; several threads; the packed R-tree beside "
     "libspatialindex's. FILE is\n"
     "only read. A machine that does other things meanwhile measures those too.\n\n"
     "Examples:\n"
     "  ptin bench dem.ptin\n"
     "  ptin bench /mnt/usb/dem.ptin --seconds 300 -o usb.png\n"
     "  ptin bench dem.ptin --error 5 --threads 16 --json | jq .best\n",
     declare_bench},
    {"serve", "Answer questions over HTTP: heights, contours, lines of sight, meshes, streams",
     "GET / lists what there is, GET /api as OpenAPI. Every limit on what a client may ask is an "
     "option. Loopback unless\n"
     "--listen says otherwise; TLS is a proxy's (tools/serve/README.md). A file that is replaced "
     "by renaming another one onto\n"
     "it is picked up at the next question, SIGHUP reads the configuration's collections anew. "
     "SIGTERM finishes what is at\n"
     "hand, and ends with status 0.\n\n"
     "Examples:\n"
     "  ptin serve dem.ptin\n"
     "  ptin serve alps=/data/alps.ptin coast=/data/coast.ptin --listen 0.0.0.0:8080 --cors '*'\n"
     "  ptin serve --config /etc/ptin.toml --limit points=1000\n"
     "  curl "
     "'http://127.0.0.1:8080/collections/dem/position?coords=POINT(-118.2%2034.3)&error=5'\n",
     declare_serve},
    {"completion", "Print a completion script for a shell, or the manual page",
     "Example:\n"
     "  ptin completion bash > ~/.local/share/bash-completion/completions/ptin\n"
     "  ptin completion man | man -l -\n",
     declare_completion, true},
});

constexpr const char* kExitStatuses =
    "Exit status: 0 done; 1 negative answer (verify); 2 wrong use or input; 3 not found; 4 damaged "
    "file;\n"
    "5 file of a newer version; 6 input/output error; 7 out of memory or disk; 8 cancelled; 70 a "
    "fault of ours.\n";

/// The first word of the command line, where it is no option and names no subcommand; else empty.
std::string unknown_subcommand(std::span<const std::string> words) {
  if (words.empty() || words[0].starts_with('-')) return {};
  const bool known = std::any_of(kCommands.begin(), kCommands.end(),
                                 [&](const Command& command) { return words[0] == command.name; });
  return known ? std::string() : words[0];
}

/// A terrain is no source of another one, no region and no points of a question, which the plugin of
/// tools/gdal would make of it, in a VRT and at a URL too: so its driver is one of those that GDAL is
/// to pass over, however often drivers are registered. (A build refuses a file that is one by itself.)
void pass_over_terrains() {
  std::string skipped = CPLGetConfigOption("GDAL_SKIP", "");
  if (skipped.find("PTIN") != std::string::npos) return;
  if (!skipped.empty()) skipped += skipped.find(',') == std::string::npos ? ' ' : ',';
  CPLSetConfigOption("GDAL_SKIP", (skipped + "PTIN").c_str());
}

/// Writes a sentence about wrong use, and how to get help.
/// @returns the exit status
int report_wrong_use(const Command* command, const std::string& message, bool json) {
  const std::string name = command == nullptr ? "" : command->name + std::string(" ");
  report_error({ErrorCode::invalid_argument, message + "; see ptin " + name + "--help"}, json);
  return status_of(ErrorCode::invalid_argument).exit;
}

/// The words of the command line. `ptin help build` is `ptin build --help`.
std::vector<std::string> words_of(int argc, const char* const* argv) {
  std::vector<std::string> words(argv + std::min(argc, 1), argv + argc);
  if (words.empty() || words[0] != "help") return words;
  words.erase(words.begin());
  words.insert(words.begin() + (words.empty() ? 0 : 1), "--help");
  return words;
}

}  // namespace

std::span<const Command> commands() noexcept { return kCommands; }

const char* exit_statuses() noexcept { return kExitStatuses; }

void start_gdal(const Command& /*command*/, Context& /*context*/) {
  CPLSetErrorHandler(CPLQuietErrorHandler);
  silence_proj();
  pass_over_terrains();
  GDALAllRegister();
}

int run_command_line(int argc, const char* const* argv, Context& context,
                     const BeforeWork& before) {
  // Before parsing, which may fail.
  context.json =
      std::any_of(argv + 1, argv + argc, [](std::string_view word) { return word == "--json"; });
  const bool json = context.json;
  tell_refused_memory_as_json(json);
  const std::vector<std::string> words = words_of(argc, argv);
  if (const std::string word = unknown_subcommand(words); !word.empty())
    return report_wrong_use(nullptr, unknown_subcommand_sentence(word), json);
  ParsedWords parsed = parse_words(words, context);
  if (!parsed.fault.empty()) return report_wrong_use(parsed.command, parsed.fault, json);
  if (!parsed.status) {
    before(*parsed.command, context);
    check_inputs_are_kept(*context.reading);
    parsed.status = parsed.declared.run();
  }
  finish_stdout();
  return *parsed.status;
}

int report_current_error(bool json) noexcept {
  const Error error = current_error();
  report_error(error, json);
  return status_of(error.code()).exit;
}

int run_program(int argc, const char* const* argv, Context& context, const BeforeWork& before) {
  prepare_for_refused_memory();
  try {
    if (argc > 2) context.arguments.assign(argv + 2, argv + argc);
    return run_command_line(argc, argv, context, before);
  } catch (...) {
    return report_current_error(context.json);
  }
}

void report_error(const Error& error, bool json) {
  if (json) {
    nlohmann::json body = {{"code", to_string(error.code())}, {"message", error.message()}};
    if (!error.context().empty()) body["context"] = error.context();
    const nlohmann::json answer = {{"error", body}};
    std::fprintf(stderr, "%s\n",
                 answer.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace).c_str());
  } else {
    std::fprintf(stderr, "ptin: %s\n", printable(error.what()).c_str());
  }
}

}  // namespace ptin::tools
