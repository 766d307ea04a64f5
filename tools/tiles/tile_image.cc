// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/tiles/tile_image.h"

#include <csetjmp>
#include <cstddef>
#include <vector>

#include <png.h>
#include <webp/encode.h>
#include <zlib.h>

#include "engine/error.h"

namespace ptin::tools {

namespace {

[[noreturn]] void throw_no_image() {
  throw Error(ErrorCode::resource_exhausted, "the picture of the tile does not fit the memory");
}

bool is_opaque(std::span<const std::uint8_t> pixels) noexcept {
  for (std::size_t i = 3; i < pixels.size(); i += 4) {
    if (pixels[i] != 255) return false;
  }
  return true;
}

/// The pixels without their opacity.
std::vector<std::uint8_t> colours_of(std::span<const std::uint8_t> pixels) {
  std::vector<std::uint8_t> colours;
  colours.reserve(pixels.size() / 4 * 3);
  for (std::size_t i = 0; i < pixels.size(); i += 4) {
    colours.insert(colours.end(), {pixels[i], pixels[i + 1], pixels[i + 2]});
  }
  return colours;
}

/// What libpng calls: an exception must not pass through it.
void append_png(png_structp png, png_bytep bytes, std::size_t count) {
  try {
    static_cast<std::string*>(png_get_io_ptr(png))
        ->append(reinterpret_cast<const char*>(bytes), count);
  } catch (...) {
    png_error(png, "no memory");
  }
}
void flush_png(png_structp) {}
void fail_png(png_structp png, png_const_charp) { png_longjmp(png, 1); }
void warn_png(png_structp, png_const_charp) {}

/// False where libpng failed, after which nothing of it is used but to destroy it. There is no object
/// here whose end a jump would leave out.
bool write_png(png_structp png, png_infop info, int side, const std::uint8_t* pixels,
               bool is_plain) {
  if (setjmp(png_jmpbuf(png)) != 0) return false;
  const auto width = static_cast<png_uint_32>(side);
  // Heights of neighbours are alike: rows less the row above pack well, and one filter takes a third
  // of the time of all that libpng tries.
  png_set_filter(png, PNG_FILTER_TYPE_BASE, PNG_FILTER_PAETH);
  // Bytes that the filter leaves hardly repeat themselves but in runs: to look for these alone packs as well or
  // better, in a third of the time.
  png_set_compression_level(png, 3);
  png_set_compression_strategy(png, Z_RLE);
  png_set_IHDR(png, info, width, width, 8, is_plain ? PNG_COLOR_TYPE_RGB : PNG_COLOR_TYPE_RGB_ALPHA,
               PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
  png_write_info(png, info);
  const std::size_t stride = static_cast<std::size_t>(side) * (is_plain ? 3 : 4);
  for (int row = 0; row < side; ++row) {
    png_write_row(png, pixels + static_cast<std::size_t>(row) * stride);
  }
  png_write_end(png, info);
  return true;
}

std::string png_bytes(int side, std::span<const std::uint8_t> pixels, bool is_plain) {
  std::string bytes;
  bytes.reserve(pixels.size() / 2);
  png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, nullptr, fail_png, warn_png);
  png_infop info = png == nullptr ? nullptr : png_create_info_struct(png);
  bool is_written = false;
  if (info != nullptr) {
    png_set_write_fn(png, &bytes, append_png, flush_png);
    is_written = write_png(png, info, side, pixels.data(), is_plain);
  }
  png_destroy_write_struct(&png, &info);
  if (!is_written) throw_no_image();
  return bytes;
}

int append_webp(const std::uint8_t* bytes, std::size_t count, const WebPPicture* picture) {
  try {
    static_cast<std::string*>(picture->custom_ptr)
        ->append(reinterpret_cast<const char*>(bytes), count);
    return 1;
  } catch (...) {
    return 0;
  }
}

std::string webp_bytes(int side, std::span<const std::uint8_t> pixels) {
  WebPConfig config;
  WebPPicture picture;
  constexpr int kQuick = 1;  // of 0 to 9: a third of the time of the next one, 3 % more bytes
  if (WebPConfigInit(&config) == 0 || WebPConfigLosslessPreset(&config, kQuick) == 0 ||
      WebPPictureInit(&picture) == 0) {
    throw_no_image();
  }
  config.exact = 1;  // Colours without opacity are kept.
  std::string bytes;
  picture.use_argb = 1;
  picture.width = picture.height = side;
  picture.writer = append_webp;
  picture.custom_ptr = &bytes;
  const bool is_written = WebPPictureImportRGBA(&picture, pixels.data(), side * 4) != 0 &&
                          WebPEncode(&config, &picture) != 0;
  WebPPictureFree(&picture);
  if (!is_written) throw_no_image();
  return bytes;
}

}  // namespace

std::string tile_image(TileFormat format, int side, std::span<const std::uint8_t> pixels) {
  if (format == TileFormat::kWebp) return webp_bytes(side, pixels);
  if (!is_opaque(pixels)) return png_bytes(side, pixels, false);
  return png_bytes(side, colours_of(pixels), true);
}

}  // namespace ptin::tools
