// SPDX-License-Identifier: GPL-3.0-or-later
//
// ptin tiles: heights as tiles of a web map, all of them in one file for any host.
#include <algorithm>
#include <atomic>
#include <cstdio>
#include <exception>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "engine/crs/crs_facts.h"
#include "engine/error.h"
#include "engine/query/shape/tiler.h"
#include "engine/stop.h"
#include "tools/error_status.h"
#include "tools/facts/answers.h"
#include "tools/facts/human.h"
#include "tools/output/output_file.h"
#include "tools/progress.h"
#include "tools/ptin/command.h"
#include "tools/ptin/query_options.h"
#include "tools/thread_count.h"
#include "tools/tiles/height_tiles.h"
#include "tools/tiles/pmtiles.h"

namespace ptin::tools {

namespace {

/// Tiles that are made before any of them is written, for each thread.
constexpr std::size_t kTilesOfThread = 16;
constexpr std::uint64_t kMemory = std::uint64_t{1} << 30;

struct TilesOptions {
  TerrainOptions terrain;
  OutputOptions out;
  std::string encoding = "mapbox", format = "png", size = "256", voids = "transparent";
  std::vector<int> zooms;
  int threads = 0;
  std::optional<std::uint64_t> memory;
};

struct Zooms {
  int first, last;
};

HeightTileStyle style_of(const TilesOptions& options) {
  HeightTileStyle style;
  style.code = options.encoding == "terrarium" ? HeightCode::kTerrarium : HeightCode::kMapbox;
  style.format = options.format == "webp" ? TileFormat::kWebp : TileFormat::kPng;
  style.side = options.size == "512" ? 512 : 256;
  style.fills_voids = options.voids == "fill";
  return style;
}

void check_tiles_options(const TilesOptions& options) {
  if (!options.out.output.ends_with(".pmtiles")) {
    refuse("the tiles are written as PMTiles alone: name the output .pmtiles", options.out.output);
  }
  check_output(options.out.output, options.out.overwrite);
}

Zooms zooms_of(const TilesOptions& options, const MercatorPyramid& pyramid,
               const HeightTileStyle& style) {
  const int last = last_zoom(pyramid, style);
  if (options.zooms.empty()) return {0, last};
  if (options.zooms[0] > options.zooms[1] || options.zooms[1] > last) {
    refuse("give a first zoom and a last one, up to " + std::to_string(last) +
               ", where pixels are as large as the terrain's samples",
           "--zooms");
  }
  return {options.zooms[0], options.zooms[1]};
}

/// The tiles of a zoom in the order of the file.
std::vector<WebTile> tiles_of(const MercatorPyramid& pyramid, int z) {
  std::vector<WebTile> tiles;
  for (const TileRectangle& r : pyramid.rectangles(z)) {
    for (std::int64_t y = r.min_y; y <= r.max_y; ++y) {
      for (std::int64_t x = r.min_x; x <= r.max_x; ++x) tiles.push_back({z, x, y});
    }
  }
  std::sort(tiles.begin(), tiles.end(),
            [](const WebTile& a, const WebTile& b) { return pmtiles_id(a) < pmtiles_id(b); });
  return tiles;
}

/// Makes tiles on threads. What one of them throws first ends them all.
class TileMaker {
 public:
  TileMaker(const MercatorPyramid& pyramid, const HeightTileStyle& style, int threads,
            const QueryLimits& limits)
      : pyramid_(pyramid),
        style_(style),
        threads_(threads),
        limits_(limits.share(1, static_cast<std::uint64_t>(threads))) {}

  [[nodiscard]] std::size_t together() const noexcept {
    return kTilesOfThread * static_cast<std::size_t>(threads_);
  }

  [[nodiscard]] std::vector<std::string> made(std::span<const WebTile> tiles) {
    std::vector<std::string> bytes(tiles.size());
    std::atomic<std::size_t> next = 0;
    std::mutex mutex;
    std::exception_ptr thrown;
    run_on_threads(threads_, [&](int /*thread*/) {
      try {
        for (std::size_t i = next++; i < tiles.size(); i = next++) {
          bytes[i] = height_tile(pyramid_, style_, tiles[i], limits_)->bytes;
        }
      } catch (...) {
        next = tiles.size();
        const std::scoped_lock lock(mutex);
        if (!thrown) thrown = std::current_exception();
      }
    });
    if (thrown) std::rethrow_exception(thrown);
    return bytes;
  }

 private:
  const MercatorPyramid& pyramid_;
  HeightTileStyle style_;
  int threads_;
  QueryLimits limits_;
};

nlohmann::json metadata_of_tiles(const MercatorPyramid& pyramid, const HeightTileStyle& style,
                                 const std::string& datum) {
  nlohmann::json metadata = height_facts(pyramid, style);
  metadata["type"] = "baselayer";
  metadata["ptin:heights"] = datum;
  metadata["description"] = "Heights in metres as colours";
  return metadata;
}

PmtilesCounts write_tiles(const TilesOptions& options, const MercatorPyramid& pyramid,
                          const Zooms& zooms, const Context& context) {
  const HeightTileStyle style = style_of(options);
  const QueryLimits limits{options.memory.value_or(kMemory), context.stop};
  TileMaker maker(pyramid, style, thread_count(options.threads), limits);
  PmtilesWriter writer(options.out.output, options.out.overwrite);
  Progress progress(Progress::style_for(context.quiet, stderr));
  for (int z = zooms.first; z <= zooms.last; ++z) {
    const std::vector<WebTile> tiles = tiles_of(pyramid, z);
    const std::string stage = "zoom " + std::to_string(z);
    for (std::size_t i = 0; i < tiles.size(); i += maker.together()) {
      progress.report(stage.c_str(), i, tiles.size());
      const auto some = std::span(tiles).subspan(i, std::min(maker.together(), tiles.size() - i));
      const std::vector<std::string> bytes = maker.made(some);
      for (std::size_t k = 0; k < some.size(); ++k) writer.add(some[k], bytes[k]);
    }
    progress.finish();
  }
  PmtilesFacts facts;
  facts.type = style.format == TileFormat::kWebp ? PmtilesType::kWebp : PmtilesType::kPng;
  facts.min_zoom = zooms.first;
  facts.max_zoom = zooms.last;
  facts.bounds = pyramid.bounds();
  const std::string datum = crs_facts(pyramid.terrain().store()).vertical_text();
  nlohmann::json metadata = metadata_of_tiles(pyramid, style, datum);
  metadata["minzoom"] = zooms.first;
  metadata["maxzoom"] = zooms.last;
  metadata["center"][2] = (zooms.first + zooms.last) / 2;
  return writer.publish(facts, metadata);
}

int run_tiles(const TilesOptions& options, const Context& context) {
  check_tiles_options(options);
  const Terrain terrain = open_terrain(options.terrain, std::nullopt, context);
  const MercatorPyramid pyramid(terrain, crs_facts(terrain.store()));
  const HeightTileStyle style = style_of(options);
  check_heights(pyramid, style.code);
  const Zooms zooms = zooms_of(options, pyramid, style);
  const PmtilesCounts counts = write_tiles(options, pyramid, zooms, context);
  if (context.json) {
    print_json({{"output", options.out.output},
                {"bytes", counts.bytes},
                {"tiles", counts.tiles},
                {"entries", counts.entries},
                {"contents", counts.contents},
                {"leaves", counts.leaves},
                {"zooms", {zooms.first, zooms.last}}});
  } else if (!context.quiet) {
    std::fprintf(stderr, "%s: %s, %s of zooms %d to %d, of which %s differ\n",
                 options.out.output.c_str(), human_bytes(counts.bytes).c_str(),
                 counted(counts.tiles, "tile").c_str(), zooms.first, zooms.last,
                 std::to_string(counts.contents).c_str());
  }
  return kExitDone;
}

void add_question(ask::Parameters& rows, TilesOptions& options) {
  add_terrain(rows, options.terrain, false);
  add_output(rows, options.out, "The file to write, .pmtiles: PMTiles 3");
  rows.add("encoding", &options.encoding, "NAME", "How three bytes hold a height")
      .of({"mapbox", "terrarium"})
      .with_default();
  rows.add("format", &options.format, "NAME", "Of the tiles; both are without loss")
      .of({"png", "webp"})
      .with_default();
  rows.add("size", &options.size, "PIXELS", "Pixels along a side of a tile")
      .of({"256", "512"})
      .with_default();
  rows.add("voids", &options.voids, "HOW",
           "Pixels without surface have the colour of 0 m: transparent, or opaque")
      .of({"transparent", "fill"})
      .with_default();
  rows.add("zooms", &options.zooms, "FIRST LAST",
           "Zooms to write (default: from 0 to that whose pixels are as large as samples)")
      .values(2, 2)
      .within({.least = 0, .most = 28});
  ask::add_memory(rows, options.memory, "Memory for tiles, as 512M or 2G (default 1G)");
  ask::add_threads(rows, options.threads,
                   "Threads (default: one a processor that affinity and cgroups leave this "
                   "process); the bytes are the same for any number");
}

}  // namespace

Declared declare_tiles(Context& context) { return declared<TilesOptions>(context, run_tiles); }

}  // namespace ptin::tools
