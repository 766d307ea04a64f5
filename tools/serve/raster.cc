// SPDX-License-Identifier: GPL-3.0-or-later
//
// A window as a GeoTIFF or a COG: OGC API - Coverages, and what it says of its values.
#include <array>
#include <atomic>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <cpl_vsi.h>

#include "engine/error.h"
#include "tools/export/pixel_grid.h"
#include "tools/export/raster_export.h"
#include "tools/export/source_export.h"
#include "tools/facts/source_count.h"
#include "tools/http/problem.h"
#include "tools/serve/answer_parts.h"
#include "tools/serve/questions.h"

namespace ptin::serve {

namespace {

using http::Problem;

constexpr const char* kPixelSize = "pixel-size";
/// What the header Accept cannot choose, since it is looked at without parameters of types: `f` does.
constexpr std::string_view kCogMedia = "image/tiff; application=geotiff; profile=cloud-optimized";

struct RasterQuestion {
  ask::RegionText region;
  DetailRequest detail;
  std::vector<double> pixel_size;
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
  ask::add_crs(rows);
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
                          question.detail.vertices || !question.pixel_size.empty();
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

tools::WrittenRaster sample(const Asked& asked, const RasterQuestion& question,
                            const tools::RasterTarget& target) {
  check_detail(asked, question.detail);
  const std::optional<Window> window =
      window_on_terrain(asked, places_of(asked), question.region.window);
  RasterRequest request;
  try {
    request = tools::pixels_in(window, size_of(asked, question.pixel_size), asked.facts());
  } catch (const Error& error) {
    if (error.code() != ErrorCode::invalid_argument) throw;
    throw Problem(400, error.message()).at(question.pixel_size.empty() ? "bbox" : kPixelSize);
  }
  request.detail = question.detail;
  const auto pixels = static_cast<std::uint64_t>(request.pixels.width * request.pixels.height);
  request.limits = limits_beside(
      asked, pixels, tools::type_of_pixels(asked.facts(), target.content.value), target.is_cog);
  return tools::export_raster(asked.terrain(), request, target, {});
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
  const std::optional<tools::SourceRaster> source = source_of(asked, question);
  if (source) {
    for (const char* name : {"PTIN_CERTIFIED_ERROR", "PTIN_CERTIFIED_DEVIATION"}) {
      target.metadata.emplace_back(name, "0");
    }
    target.metadata.emplace_back("PTIN_EXACT", "true");
  }
  const tools::WrittenRaster written =
      source ? copy_source(asked, *source, target) : sample(asked, question, target);
  http::Response response = answered(asked, file.take(), is_cog ? kCogMedia : format.media,
                                     written.cost, written.certified_error, written.exact);
  if (const std::string crs = uri_of(asked.collection->crs); !crs.empty()) {
    response.add("Content-Crs", "<" + crs + ">");
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
