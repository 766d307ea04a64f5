// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/plot/png.h"

#include <memory>

#include <cairo.h>

#include "engine/error.h"

namespace ptin::tools {

namespace {

/// Cairo wants colours multiplied by their opacity.
std::uint32_t multiplied(std::uint32_t pixel) {
  const std::uint32_t opacity = pixel >> 24U;
  std::uint32_t made = opacity << 24U;
  for (const unsigned shift : {0U, 8U, 16U}) {
    made |= ((pixel >> shift & 255U) * opacity + 127) / 255 << shift;
  }
  return made;
}

cairo_status_t append(void* text, const unsigned char* bytes, unsigned count) {
  static_cast<std::string*>(text)->append(reinterpret_cast<const char*>(bytes), count);
  return CAIRO_STATUS_SUCCESS;
}

}  // namespace

std::string png_of(int width, int height, std::span<const std::uint32_t> pixels) {
  const std::unique_ptr<cairo_surface_t, void (*)(cairo_surface_t*)> surface(
      cairo_image_surface_create(CAIRO_FORMAT_ARGB32, width, height), cairo_surface_destroy);
  if (cairo_surface_status(surface.get()) != CAIRO_STATUS_SUCCESS) {
    throw Error(ErrorCode::resource_exhausted, "the picture does not fit the memory");
  }
  auto* const bytes = cairo_image_surface_get_data(surface.get());
  const auto stride = static_cast<std::size_t>(cairo_image_surface_get_stride(surface.get()));
  const auto columns = static_cast<std::size_t>(width);
  for (std::size_t row = 0; row < static_cast<std::size_t>(height); ++row) {
    auto* const line = reinterpret_cast<std::uint32_t*>(bytes + row * stride);
    for (std::size_t x = 0; x < columns; ++x) line[x] = multiplied(pixels[row * columns + x]);
  }
  cairo_surface_mark_dirty(surface.get());
  std::string text;
  if (cairo_surface_write_to_png_stream(surface.get(), append, &text) != CAIRO_STATUS_SUCCESS) {
    throw Error(ErrorCode::resource_exhausted, "Cairo cannot write the picture");
  }
  return text;
}

}  // namespace ptin::tools
