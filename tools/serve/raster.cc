// SPDX-License-Identifier: GPL-3.0-or-later
//
// A window as a GeoTIFF or a COG: OGC API - Coverages, and what it says of its values.
#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <cpl_vsi.h>
#include <ogr_spatialref.h>

#include "engine/error.h"
#include "engine/number.h"
#include "tools/export/pixel_grid.h"
#include "tools/export/raster_export.h"
#include "tools/export/source_export.h"
#include "tools/facts/human.h"
#include "tools/facts/source_count.h"
#include "tools/http/problem.h"
#include "tools/serve/answer_parts.h"
#include "tools/serve/pixel_frame.h"
#include "tools/serve/questions.h"

namespace ptin::serve {

namespace {

using http::Problem;

constexpr const char *kScaleSizeOfGdal = "scaleSize", *kPixelSize = "pixel-size",
                     *kBoxCrs = "bbox-crs", *kSubsetCrs = "subset-crs";
/// Pixels along a side that a client may ask for; the limit `pixels` is for all of them.
constexpr std::uint64_t kMostAlongSide = 100'000'000;
/// What the header Accept cannot choose, since it is looked at without parameters of types: `f` does.
constexpr std::string_view kCogMedia = "image/tiff; application=geotiff; profile=cloud-optimized";

struct RasterQuestion {
  ask::RegionText region;
  DetailRequest detail;
  std::vector<double> pixel_size;
  PixelCounts counts;
};

void add_question(ask::Parameters& rows, RasterQuestion& question) {
  ask::add_window(rows, question.region, ask::Door::kService);
  ask::add_detail(rows, question.detail, "",
                  "The TIN of so many vertices, the most important ones, instead of an error",
                  ask::Door::kService);
  rows.add(kPixelSize, &question.pixel_size, "",
           "Width and height of a pixel, or one number for both; without it those of the raster "
           "that "
           "the terrain was built from")
      .in(ask::Unit::kMap)
      .values(1, 2)
      .within(NumberRange::kPositive)
      .at(ask::Door::kService)
      .like("30");
  const auto add_count = [&rows](const char* name, std::optional<std::uint64_t>& count,
                                 const char* help) {
    rows.add(name, &count, "", help)
        .within({.least = 1, .most = kMostAlongSide})
        .at(ask::Door::kService)
        .excluding(kPixelSize)
        .like("512");
  };
  add_count("width", question.counts.width,
            "Columns that divide the window evenly, instead of pixel-size; alone: square pixels");
  add_count("height", question.counts.height,
            "Rows that divide the window evenly, instead of pixel-size; alone: square pixels");
  ask::add_text(rows, "scale-size",
                "Columns and rows as OGC writes them, by axes, instead of width and height",
                "Lon(512),Lat(512)")
      .excluding("width height pixel-size");
  ask::add_text(rows, kScaleSizeOfGdal,
                "The same as GDAL's driver OGCAPI writes it, instead of scale-size; it takes the "
                "raster for CRS84, and so it is without crs",
                "Lat(512),Long(512)")
      .excluding("width height pixel-size scale-size");
  ask::add_text(rows, "subset",
                "The window as OGC writes it, by axes, in the CRS of subset-crs, instead of bbox",
                "Lon(-118.31:-118.3),Lat(34.34:34.35)")
      .excluding("bbox");
  ask::add_text(rows, "crs",
                "CRS of the raster: native (without it), CRS84, or an EPSG code or OGC URI",
                "EPSG:3857");
  for (const char* name : {kBoxCrs, kSubsetCrs}) {
    ask::add_text(rows, name,
                  "CRS of the window: CRS84 (without it), native, or an EPSG code or OGC URI",
                  "CRS84");
  }
}

/// A file of GDAL's in memory, gone with this.
class MemoryFile {
 public:
  MemoryFile() {
    static std::atomic<std::uint64_t> next{0};
    path_ = "/vsimem/ptin-serve/" + std::to_string(next++) + ".tif";
  }
  ~MemoryFile() { VSIUnlink(path_.c_str()); }
  MemoryFile(const MemoryFile&) = delete;
  MemoryFile& operator=(const MemoryFile&) = delete;

  [[nodiscard]] const std::string& path() const noexcept { return path_; }
  /// Its bytes; the file is gone.
  [[nodiscard]] std::string take() const {
    vsi_l_offset bytes = 0;
    const std::unique_ptr<GByte, decltype(&VSIFree)> all(
        VSIGetMemFileBuffer(path_.c_str(), &bytes, TRUE), &VSIFree);
    if (!all) throw Error(ErrorCode::internal, "the raster is not there", path_);
    return {reinterpret_cast<const char*>(all.get()), static_cast<std::size_t>(bytes)};
  }

 private:
  std::string path_;
};

/// Who asks first has GDAL's drivers registered: `ptin` has done it, another program may not.
void register_drivers() {
  static const bool is_done = [] {
    GDALAllRegister();
    return true;
  }();
  static_cast<void>(is_done);
}

/// Width and height of pixels, map units.
std::array<double, 2> size_of(const Asked& asked, const std::vector<double>& given) {
  if (!given.empty()) return {given.front(), given.back()};
  const std::optional<MapPoint> own = tools::own_pixel_of(asked.terrain().store());
  if (own) return {own->x, own->y};
  throw Problem(
      400,
      "this terrain was not built from a raster, so it has no pixel size of its own; give "
      "one, in map units")
      .at(kPixelSize);
}

/// Checks how many pixels there are, and leaves the engine what the file in memory does not take: of a COG
/// the raster that it is copied from and its overviews too, and the body of the answer beside each.
QueryLimits limits_beside(const Asked& asked, std::uint64_t pixels, GDALDataType type,
                          bool is_cog) {
  check_count(pixels, asked.options.question.pixels, "pixels", "pixels", kPixelSize);
  const std::uint64_t copies = is_cog ? 3 : 2;
  const std::uint64_t bytes =
      copies * pixels * static_cast<std::uint64_t>(GDALGetDataTypeSizeBytes(type));
  QueryLimits limits = asked.limits;
  if (bytes > limits.memory_bytes / 4 * 3) {
    throw Problem(413, "a raster of " + std::to_string(pixels) + " pixels takes " +
                           std::to_string(bytes) +
                           " bytes, more than three quarters of what one "
                           "question has; ask in parts")
        .at(kPixelSize)
        .beyond("question_memory");
  }
  limits.memory_bytes -= bytes;
  return limits;
}

tools::RasterTarget target_of(const Asked& asked, const MemoryFile& file, bool is_cog) {
  tools::RasterTarget target;
  target.path = file.path();
  target.is_cog = is_cog;
  target.crs = asked.collection->crs;
  target.nodata = tools::default_nodata(asked.facts(), target.content.value, target.type);
  target.is_described = true;
  const Credits& credits = asked.collection->credits;
  if (!credits.title.empty())
    target.metadata.emplace_back("TIFFTAG_IMAGEDESCRIPTION", credits.title);
  if (!credits.attribution.empty()) {
    target.metadata.emplace_back("TIFFTAG_COPYRIGHT", credits.attribution);
  }
  target.metadata.emplace_back("PTIN_FINGERPRINT", asked.collection->fingerprint);
  return target;
}

/// The raster that the terrain was built from, where the file holds all of it.
std::optional<tools::SourceRaster> source_of(const Asked& asked, const RasterQuestion& question) {
  const bool has_choice = question.region.window || question.detail.tolerance ||
                          question.detail.vertices || !question.pixel_size.empty() ||
                          question.counts.given() || asked.question.has("subset") ||
                          asked.question.has("scale-size") || asked.question.has(kScaleSizeOfGdal);
  if (has_choice) return std::nullopt;
  try {
    return tools::source_raster_of(asked.terrain(), asked.collection->crs);
  } catch (const Error& error) {
    if (error.code() != ErrorCode::invalid_argument) throw;
    return std::nullopt;
  }
}

/// Each number bit for bit.
tools::WrittenRaster copy_source(const Asked& asked, const tools::SourceRaster& source,
                                 const tools::RasterTarget& target) {
  const auto pixels = static_cast<std::uint64_t>(source.form.width * source.form.height);
  const QueryLimits limits = limits_beside(asked, pixels, source.form.type, target.is_cog);
  tools::export_source(asked.terrain(), source, target, {}, limits.stop);
  tools::WrittenRaster written;
  written.exact = true;
  return written;
}

/// The numbers of "34.34:34.35", where `*` is the end of the terrain.
void put_range(std::string_view text, double& low, double& high) {
  const std::vector<std::string_view> ends = ask::parts_of(text, ':');
  const auto put = [](std::string_view end, double& value) {
    const std::string_view word = ask::trimmed(end);
    if (word == "*") return true;
    const std::optional<double> number = parse_number<double>(word);
    if (number && std::isfinite(*number)) value = *number;
    return number && std::isfinite(*number);
  };
  if (ends.size() == 2 && put(ends[0], low) && put(ends[1], high)) return;
  throw Problem(400, "\"" + tools::shown(text) +
                         "\" is no range of an axis; write it as Lat(34.34:34.35), with * for the "
                         "end of the terrain")
      .at("subset");
}

/// The window of `subset` in its CRS; an axis that it does not name has all of the terrain.
Window window_of_subset(const Asked& asked, const Places& places) {
  const std::string& text = asked.question.text("subset");
  Window window = places.from_terrain(asked.collection->bounds).value_or(asked.collection->bounds);
  if (const auto x = part_for_axis(text, 0, "subset")) put_range(*x, window.min_x, window.max_x);
  if (const auto y = part_for_axis(text, 1, "subset")) put_range(*y, window.min_y, window.max_y);
  return window;
}

/// The CRS that the raster is asked for in.
Places places_of_raster(const Asked& asked) {
  std::string name = asked.question.text("crs");
  if (name.empty()) name = asked.question.has(kScaleSizeOfGdal) ? "CRS84" : "native";
  return {asked.collection->crs, name, asked.collection->bounds, asked.request.share};
}

/// Pixels of a raster; where the number has more than 64 bits one that no limit allows.
std::uint64_t pixel_count(std::int64_t columns, std::int64_t rows) {
  const double count = static_cast<double>(columns) * static_cast<double>(rows);
  return count < 1e18 ? static_cast<std::uint64_t>(columns * rows) : ~std::uint64_t{0} / 64;
}

PixelCounts counts_of(const Asked& asked, const RasterQuestion& question) {
  PixelCounts counts = question.counts;
  const char* const name = asked.question.has(kScaleSizeOfGdal) ? kScaleSizeOfGdal : "scale-size";
  const std::string& text = asked.question.text(name);
  const auto put = [&](int axis, std::optional<std::uint64_t>& count) {
    const auto part = part_for_axis(text, axis, name);
    if (!part) return;
    count = parse_number<std::uint64_t>(*part);
    if (count && *count > 0 && *count <= kMostAlongSide) return;
    throw Problem(400, "\"" + tools::shown(*part) + "\" is no number of pixels").at(name);
  };
  if (asked.question.has(name)) {
    put(0, counts.width);
    put(1, counts.height);
  }
  return counts;
}

/// The CRS of `bbox` or `subset`.
Places places_of_window(const Asked& asked) {
  const char* const name = asked.question.has("subset") ? kSubsetCrs : kBoxCrs;
  return {asked.collection->crs, asked.question.text(name), asked.collection->bounds,
          asked.request.share};
}

/// The part of a client's window that lies within the terrain's box, in the terrain's CRS.
std::optional<Window> window_within_terrain(const Asked& asked, const RasterQuestion& question,
                                            const Places& places) {
  std::optional<Window> window = question.region.window;
  if (asked.question.has("subset")) window = window_of_subset(asked, places);
  const std::optional<Window> there = window_on_terrain(asked, places, window);
  if (!there) return std::nullopt;
  const Window& b = asked.collection->bounds;
  return Window{std::max(there->min_x, b.min_x), std::max(there->min_y, b.min_y),
                std::min(there->max_x, b.max_x), std::min(there->max_y, b.max_y)};
}

tools::WrittenRaster sample(const Asked& asked, const RasterQuestion& question,
                            const tools::RasterTarget& target) {
  check_detail(asked, question.detail);
  const std::optional<Window> window =
      window_within_terrain(asked, question, places_of_window(asked));
  RasterRequest request;
  const PixelCounts counts = counts_of(asked, question);
  if (counts.given()) {
    const PixelFrame frame = frame_dividing(window.value_or(asked.collection->bounds), counts);
    request.lattice = {{frame.west + frame.size[0] / 2, frame.north - frame.size[1] / 2},
                       frame.size[0],
                       -frame.size[1]};
    request.pixels = {0, 0, frame.columns, frame.rows};
  } else {
    try {
      request = tools::pixels_in(window, size_of(asked, question.pixel_size), asked.facts());
    } catch (const Error& error) {
      if (error.code() != ErrorCode::invalid_argument) throw;
      throw Problem(400, error.message()).at(question.pixel_size.empty() ? "bbox" : kPixelSize);
    }
  }
  request.detail = question.detail;
  request.limits =
      limits_beside(asked, pixel_count(request.pixels.width, request.pixels.height),
                    tools::type_of_pixels(asked.facts(), target.content.value), target.is_cog);
  return tools::export_raster(asked.terrain(), request, target, {});
}

/// A window that was asked for in the raster's own CRS, within what holds the terrain there: to the digit, so
/// that who places pixels by it is right, whatever outline the terrain has in it. None where it was
/// asked for in another CRS, lies beside, or one of them across the antimeridian.
std::optional<Window> window_as_asked(const Asked& asked, const RasterQuestion& question,
                                      const Places& of_window, const Places& places) {
  std::optional<Window> own = question.region.window;
  if (asked.question.has("subset")) own = window_of_subset(asked, of_window);
  if (!own || of_window.is_native() || of_window.uri() != places.uri()) return std::nullopt;
  const std::optional<Window> all = places.from_terrain(asked.collection->bounds);
  if (!all || own->min_x > own->max_x || all->min_x > all->max_x) return std::nullopt;
  const Window both{std::max(all->min_x, own->min_x), std::max(all->min_y, own->min_y),
                    std::min(all->max_x, own->max_x), std::min(all->max_y, own->max_y)};
  if (both.min_x < both.max_x && both.min_y < both.max_y) return both;
  return std::nullopt;
}

/// The window of a raster in another CRS.
Window window_there(const Asked& asked, const RasterQuestion& question, const Places& places) {
  const Places of_window = places_of_window(asked);
  if (const auto both = window_as_asked(asked, question, of_window, places)) return *both;
  const auto window = window_within_terrain(asked, question, of_window);
  std::optional<Window> there = places.from_terrain(window.value_or(asked.collection->bounds));
  if (!there) {
    throw Problem(400, "a part of the window has no positions in this CRS; ask for a smaller one")
        .at("crs");
  }
  const std::optional<Window>& own = question.region.window;
  if (there->min_x > there->max_x && places.is_geographic()) there->max_x += 360;
  if (!own || of_window.is_native() || of_window.uri() != places.uri() || own->min_x > own->max_x) {
    return *there;
  }
  return {std::max(there->min_x, own->min_x), std::max(there->min_y, own->min_y),
          std::min(there->max_x, own->max_x), std::min(there->max_y, own->max_y)};
}

tools::WrittenRaster sample_in(const Asked& asked, const RasterQuestion& question,
                               const Places& places, const tools::RasterTarget& target) {
  check_detail(asked, question.detail);
  const Window window = window_there(asked, question, places);
  const PixelCounts counts = counts_of(asked, question);
  PixelFrame frame;
  if (counts.given()) {
    frame = frame_dividing(window, counts);
  } else if (!question.pixel_size.empty()) {
    frame = frame_covering(window, size_of(asked, question.pixel_size));
  } else {
    const std::array<double, 2> own = size_of(asked, {});
    const double side = side_of_own_pixel(places, {own[0], own[1]}, window);
    if (!(side > 0)) {
      throw Problem(400, "pixels have no size in the middle of this window; give one")
          .at(kPixelSize);
    }
    frame = frame_covering(window, {side, side});
  }
  LocateRequest request;
  request.detail = question.detail;
  request.limits =
      limits_beside(asked, pixel_count(frame.columns, frame.rows),
                    tools::type_of_pixels(asked.facts(), target.content.value), target.is_cog);
  return write_frame(asked, places, frame, request, target);
}

/// The facts of the CRS of a raster that is not in the terrain's own, with the terrain's heights where
/// they have a code.
CrsFacts crs_of(const Asked& asked, const Places& places) {
  constexpr std::string_view kEpsgCode = "EPSG:";
  const std::string& uri = places.uri();
  std::string name = uri == kCrs84 ? "EPSG:4326" : "EPSG:" + uri.substr(uri.rfind('/') + 1);
  const CrsFacts& own = asked.collection->crs;
  if (!own.has_third_axis && own.vertical_code.starts_with(kEpsgCode)) {
    name += "+" + own.vertical_code.substr(kEpsgCode.size());
  }
  OGRSpatialReference crs;
  char* text = nullptr;
  constexpr std::array<const char*, 2> kAsWkt2 = {"FORMAT=WKT2", nullptr};
  const bool is_read = crs.SetFromUserInput(name.c_str()) == OGRERR_NONE &&
                       crs.exportToWkt(&text, kAsWkt2.data()) == OGRERR_NONE;
  const std::unique_ptr<char, decltype(&VSIFree)> wkt(text, &VSIFree);
  if (!is_read) throw Problem(400, "GDAL cannot write this CRS into a raster").at("crs");
  return crs_facts(wkt.get());
}

}  // namespace

ask::Parameters raster_parameters() { return described<RasterQuestion>(); }

http::Response answer_raster(const Asked& asked) {
  const ask::Format& format = format_of(asked);
  const auto question = read<RasterQuestion>(asked);
  register_drivers();
  const MemoryFile file;
  const bool is_cog = format.name == "cog";
  tools::RasterTarget target = target_of(asked, file, is_cog);
  const Places places = places_of_raster(asked);
  const CrsFacts& crs = asked.collection->crs;
  const bool is_own = places.is_native() || places.uri() == uri_of(crs) ||
                      (places.uri() == kCrs84 && crs.code == "EPSG:4326");
  const std::optional<tools::SourceRaster> source =
      is_own ? source_of(asked, question) : std::nullopt;
  if (source) {
    for (const char* name : {"PTIN_CERTIFIED_ERROR", "PTIN_CERTIFIED_DEVIATION"}) {
      target.metadata.emplace_back(name, "0");
    }
    target.metadata.emplace_back("PTIN_EXACT", "true");
  }
  tools::WrittenRaster written;
  if (is_own) {
    written = source ? copy_source(asked, *source, target) : sample(asked, question, target);
  } else {
    target.crs = crs_of(asked, places);
    written = sample_in(asked, question, places, target);
  }
  http::Response response = answered(asked, file.take(), is_cog ? kCogMedia : format.media,
                                     written.cost, written.certified_error, written.exact);
  if (const std::string uri = is_own ? uri_of(crs) : places.uri(); !uri.empty()) {
    response.add("Content-Crs", "<" + uri + ">");
  }
  response.add("Content-Disposition", "attachment; filename=\"" + asked.collection->id + ".tif\"");
  return response;
}

/// As JSON Schema: what the draft of OGC API - Coverages calls the fields of a coverage.
http::Response answer_schema(const Asked& asked) {
  const GDALDataType type = tools::type_of_pixels(asked.facts(), tools::PixelValue::kHeight);
  Json height = {{"title", "height"},
                 {"type", "number"},
                 {"format", type == GDT_Float64 ? "double" : "float"},
                 {"x-ogc-propertySeq", 1},
                 {"x-ogc-nilValues",
                  Json::array({tools::default_nodata(asked.facts(), tools::PixelValue::kHeight)})}};
  if (asked.collection->crs.vertical_unit != "unknown") {
    height["x-ogc-unit"] = asked.collection->crs.vertical_unit;
  }
  return json_response(
      {{"$schema", "https://json-schema.org/draft/2020-12/schema"},
       {"$id", asked.request.base + "/collections/" + asked.collection->id + "/schema"},
       {"type", "object"},
       {"title", asked.collection->title()},
       {"properties", {{"height", std::move(height)}}}},
      "application/schema+json");
}

}  // namespace ptin::serve
