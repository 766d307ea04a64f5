// SPDX-License-Identifier: GPL-3.0-or-later
#include "storage/file_beginning.h"

#include <algorithm>
#include <array>
#include <string_view>

#include "storage/layout.h"

namespace ptin {

namespace {

using namespace std::string_view_literals;

constexpr std::string_view kBuildable = "`ptin build` makes a .ptin file of it";

struct Beginning {
  std::string_view bytes;
  std::string_view name;    ///< Behind "it begins like ".
  std::string_view advice;  ///< May be empty.
};

constexpr auto kBeginnings = std::to_array<Beginning>({
    {"II*\0"sv, "a TIFF, as GeoTIFFs do", kBuildable},
    {"MM\0*"sv, "a TIFF, as GeoTIFFs do", kBuildable},
    {"II+\0"sv, "a BigTIFF, as large GeoTIFFs do", kBuildable},
    {"MM\0+"sv, "a BigTIFF, as large GeoTIFFs do", kBuildable},
    {"LASF"sv, "a LAS or LAZ file of points", kBuildable},
    {"ply\n"sv, "a PLY file", kBuildable},
    {"ply\r"sv, "a PLY file", kBuildable},
    {"MESH2D"sv, "a 2DM file", kBuildable},
    {"SQLite format 3\0"sv, "a GeoPackage or another SQLite file", kBuildable},
    {"fgb\3"sv, "a FlatGeobuf file", kBuildable},
    {"\0\0\x27\x0a"sv, "a shapefile", kBuildable},
    {"\x89HDF\r\n\x1a\n"sv, "an HDF5 or netCDF file", kBuildable},
    {"CDF\1"sv, "a netCDF file", kBuildable},
    {"CDF\2"sv, "a netCDF file", kBuildable},
    {"CDF\5"sv, "a netCDF file", kBuildable},
    {"GRIB"sv, "a GRIB file", kBuildable},
    {"DSAA"sv, "a grid of Surfer", kBuildable},
    {"DSBB"sv, "a grid of Surfer", kBuildable},
    {"DSRB"sv, "a grid of Surfer", kBuildable},
    {"EHFA_HEADER_TAG"sv, "an image of Erdas Imagine", kBuildable},
    {"\0\0\0\x0cjP  "sv, "a JPEG 2000 image", kBuildable},
    {"ncols"sv, "an Arc/Info ASCII grid", kBuildable},
    {"NCOLS"sv, "an Arc/Info ASCII grid", kBuildable},
    {"<VRTDataset"sv, "a VRT of GDAL", kBuildable},
    {"\x89PNG"sv, "a PNG image", ""},
    {"\xff\xd8\xff"sv, "a JPEG image", ""},
    {"glTF"sv, "a GLB mesh", ""},
    {"%PDF"sv, "a PDF", ""},
    {"PK\3\4"sv, "a zip archive", "unpack it first"},
    {"\x1f\x8b"sv, "a file that gzip has packed", "unpack it first"},
    {"\x28\xb5\x2f\xfd"sv, "a file that zstd has packed", "unpack it first"},
    {"BZh"sv, "a file that bzip2 has packed", "unpack it first"},
    {"\xfd"
     "7zXZ\0"sv,
     "a file that xz has packed", "unpack it first"},
    {"version https://git-lfs"sv, "a pointer of Git LFS", "`git lfs pull` fetches the file"},
    {"<!DOCTYPE"sv, "a web page",
     "a server's message may have been saved in the place of the file"},
    {"<!doctype"sv, "a web page",
     "a server's message may have been saved in the place of the file"},
    {"<html"sv, "a web page", "a server's message may have been saved in the place of the file"},
    {"<HTML"sv, "a web page", "a server's message may have been saved in the place of the file"},
    {"<"sv, "an XML file", "`ptin build` takes LandXML"},
    {"{"sv, "a JSON file", "`ptin build` takes GeoJSON"},
});

/// No control characters, and mostly ASCII, as texts in any encoding of Europe's are.
bool is_text(std::string_view text) {
  const auto is_control = [](unsigned char c) {
    return c == 0x7f || (c < ' ' && c != '\t' && c != '\n' && c != '\r');
  };
  const auto beyond_ascii =
      std::count_if(text.begin(), text.end(), [](unsigned char c) { return c >= 0x80; });
  return 2 * static_cast<std::size_t>(beyond_ascii) < text.size() &&
         std::none_of(text.begin(), text.end(), is_control);
}

bool begins_with(std::string_view text, const std::array<std::uint8_t, 8>& magic) {
  return text.starts_with(
      std::string_view(reinterpret_cast<const char*>(magic.data()), magic.size()));
}

}  // namespace

std::string beginning_of(std::span<const std::byte> first) {
  std::string_view text(reinterpret_cast<const char*>(first.data()), first.size());
  if (text.empty()) return "it is empty";
  if (begins_with(text, layout::kMagic)) return "it begins like a .ptin file";
  if (begins_with(text, layout::kStreamMagic)) return "it begins like a stream of `ptin stream`";
  if (text.starts_with("\xef\xbb\xbf")) text.remove_prefix(3);  // a byte order mark
  for (const Beginning& known : kBeginnings) {
    if (!text.starts_with(known.bytes)) continue;
    std::string words = "it begins like " + std::string(known.name);
    return known.advice.empty() ? words : words + "; " + std::string(known.advice);
  }
  if (is_text(text)) return "it begins like a text; `ptin build` takes points as text";
  return "it begins like no file that is known here";
}

}  // namespace ptin
