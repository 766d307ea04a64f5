// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/plot/canvas.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <exception>
#include <functional>
#include <new>
#include <utility>

#include <cairo-pdf.h>
#include <cairo-svg.h>
#include <cairo.h>
#include <nlohmann/json.hpp>

#include "engine/error.h"
#include "tools/facts/human.h"
#include "tools/output/file_name.h"
#include "tools/output/output_file.h"

namespace ptin::tools {

namespace {

enum class PictureFormat : std::uint8_t { kPng, kSvg, kPdf };
constexpr std::array<std::pair<const char*, PictureFormat>, 3> kFormats = {
    {{".png", PictureFormat::kPng}, {".svg", PictureFormat::kSvg}, {".pdf", PictureFormat::kPdf}}};
constexpr double kPointsInPixel = 0.75;

const std::pair<const char*, PictureFormat>* find_format(const std::string& path) {
  const std::string extension = lower_extension(path);
  const auto* const found = std::find_if(kFormats.begin(), kFormats.end(),
                                         [&](const auto& f) { return extension == f.first; });
  return found == kFormats.end() ? nullptr : found;
}

PictureFormat format_of(const std::string& path) {
  if (const auto* const format = find_format(path)) return format->second;
  throw Error(ErrorCode::invalid_argument,
              "unknown extension; known are " + known_picture_extensions(), path);
}

/// Throws unless Cairo did what it was asked for.
void require_done(cairo_status_t status, const std::string& path) {
  if (status == CAIRO_STATUS_SUCCESS) return;
  const bool no_memory = status == CAIRO_STATUS_NO_MEMORY;
  throw Error(no_memory ? ErrorCode::resource_exhausted : ErrorCode::internal,
              std::string("Cairo cannot draw the picture: ") + cairo_status_to_string(status),
              path);
}

/// Appends what Cairo writes. No exception may pass through Cairo.
cairo_status_t append_to(void* closure, const unsigned char* data, unsigned int length) {
  try {
    static_cast<std::string*>(closure)->append(reinterpret_cast<const char*>(data), length);
  } catch (const std::exception&) {
    return CAIRO_STATUS_NO_MEMORY;
  }
  return CAIRO_STATUS_SUCCESS;
}

bool is_utf8(const std::string& text) {
  try {
    static_cast<void>(nlohmann::json(text).dump());
    return true;
  } catch (const nlohmann::json::type_error&) {
    return false;
  }
}

/// Text that Cairo takes: it refuses everything after a single wrong byte.
std::string readable(std::string text) {
  const auto is_ascii = [](char c) { return static_cast<unsigned char>(c) < 0x80; };
  if (!is_utf8(text)) std::replace_if(text.begin(), text.end(), std::not_fn(is_ascii), '?');
  return printable(text);
}

/// Throws unless the system still gives what drawing takes: the pixels, and room for Cairo's paths
/// and the font. Cairo does not always survive a refusal in the middle of a stroke.
/// @throws std::bad_alloc
void require_room(int width, int height) {
  constexpr std::size_t kRoom = std::size_t{32} << 20;
  const std::size_t pixels = static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
  ::operator delete(::operator new(pixels * sizeof(std::uint32_t) + kRoom));
}

using Surface = std::unique_ptr<cairo_surface_t, decltype(&cairo_surface_destroy)>;

}  // namespace

std::string known_picture_extensions() {
  std::string known;
  for (const auto& [extension, format] : kFormats)
    known.append(known.empty() ? "" : ", ") += extension;
  return known;
}

bool is_picture_name(const std::string& path) { return find_format(path) != nullptr; }

class Canvas::Impl {
 public:
  Impl(std::string path, bool overwrite, int width, int height, double dots)
      : path_(std::move(path)),
        overwrite_(overwrite),
        width_(width),
        height_(height),
        dots_(dots),
        format_(format_of(path_)),
        surface_(start_surface(), cairo_surface_destroy),
        cairo_(cairo_create(surface_.get()), cairo_destroy) {
    check();
    if (format_ == PictureFormat::kPdf) cairo_scale(cairo_.get(), kPointsInPixel, kPointsInPixel);
    if (format_ == PictureFormat::kPng) cairo_scale(cairo_.get(), dots_, dots_);
    // Letters are as wide as they are drawn in the file, whatever the system's settings for its
    // screen are.
    cairo_font_options_t* const options = cairo_font_options_create();
    cairo_font_options_set_antialias(options, CAIRO_ANTIALIAS_GRAY);
    cairo_font_options_set_hint_style(options, CAIRO_HINT_STYLE_NONE);
    cairo_font_options_set_hint_metrics(options, CAIRO_HINT_METRICS_OFF);
    cairo_set_font_options(cairo_.get(), options);
    cairo_font_options_destroy(options);
    cairo_set_line_join(cairo_.get(), CAIRO_LINE_JOIN_ROUND);
    box({0, 0, double(width), double(height)}, {255, 255, 255}, 1.0);
  }

  [[nodiscard]] int width() const noexcept { return width_; }
  [[nodiscard]] int height() const noexcept { return height_; }
  [[nodiscard]] cairo_t* cairo() const noexcept { return cairo_.get(); }

  void colour(const Colour& c, double opacity) {
    cairo_set_source_rgba(cairo_.get(), static_cast<double>(c[0]) / 255,
                          static_cast<double>(c[1]) / 255, static_cast<double>(c[2]) / 255,
                          opacity);
  }

  void trace(std::span<const CanvasPoint> points) {
    for (const CanvasPoint& p : points) cairo_line_to(cairo_.get(), p.x, p.y);
  }

  void stroke(const Stroke& stroke) {
    constexpr std::array kDashes = {6.0, 4.0};
    colour(stroke.colour, stroke.opacity);
    cairo_set_line_width(cairo_.get(), stroke.width);
    cairo_set_dash(cairo_.get(), kDashes.data(), stroke.is_dashed ? 2 : 0, 0.0);
    cairo_stroke(cairo_.get());
  }

  void box(const CanvasBox& b, const Colour& c, double opacity) {
    colour(c, opacity);
    cairo_rectangle(cairo_.get(), b.left, b.top, b.width(), b.height());
    cairo_fill(cairo_.get());
  }

  void font(const TextStyle& style) {
    cairo_select_font_face(cairo_.get(), "DejaVu Sans", CAIRO_FONT_SLANT_NORMAL,
                           style.is_bold ? CAIRO_FONT_WEIGHT_BOLD : CAIRO_FONT_WEIGHT_NORMAL);
    cairo_set_font_size(cairo_.get(), style.size);
  }

  [[nodiscard]] double text_width(const std::string& readable_text, const TextStyle& style) {
    font(style);
    cairo_text_extents_t extents;
    cairo_text_extents(cairo_.get(), readable_text.c_str(), &extents);
    return extents.x_advance;
  }

  void paint(const Image& image, double dots) {
    // Cairo only reads the pixels, and they outlive the surface: finishing it lets go of them.
    auto* const pixels =
        reinterpret_cast<unsigned char*>(const_cast<std::uint32_t*>(image.pixels.data()));
    const Surface source(
        cairo_image_surface_create_for_data(pixels, CAIRO_FORMAT_RGB24, image.width, image.height,
                                            4 * image.width),
        cairo_surface_destroy);
    cairo_save(cairo_.get());
    cairo_scale(cairo_.get(), 1 / dots, 1 / dots);
    cairo_set_source_surface(cairo_.get(), source.get(), 0, 0);
    cairo_paint(cairo_.get());
    cairo_restore(cairo_.get());
    colour(kInk, 1.0);
    if (format_ != PictureFormat::kPng) cairo_surface_flush(surface_.get());
    check();
  }

  void publish() {
    check();
    cairo_.reset();  // what it holds belongs to the file
    if (format_ == PictureFormat::kPng) {
      require_done(cairo_surface_write_to_png_stream(surface_.get(), append_to, &bytes_), path_);
    } else {
      cairo_surface_finish(surface_.get());
      require_done(cairo_surface_status(surface_.get()), path_);
    }
    OutputFile out(path_, overwrite_);
    out.write(bytes_);
    out.publish();
  }

 private:
  cairo_surface_t* start_surface() {
    const double dots = format_ == PictureFormat::kPng ? dots_ : 1.0;
    const int across = static_cast<int>(std::lround(width_ * dots));
    const int down = static_cast<int>(std::lround(height_ * dots));
    require_room(across, down);
    if (format_ == PictureFormat::kPng) {
      return cairo_image_surface_create(CAIRO_FORMAT_RGB24, across, down);
    }
    if (format_ == PictureFormat::kSvg) {
      cairo_surface_t* const made =
          cairo_svg_surface_create_for_stream(append_to, &bytes_, width_, height_);
      cairo_svg_surface_set_document_unit(made, CAIRO_SVG_UNIT_PX);
      return made;
    }
    cairo_surface_t* const made = cairo_pdf_surface_create_for_stream(
        append_to, &bytes_, width_ * kPointsInPixel, height_ * kPointsInPixel);
    // The time of the drawing would be another one in every file.
    cairo_pdf_surface_set_metadata(made, CAIRO_PDF_METADATA_CREATE_DATE, "2000-01-01T00:00:00Z");
    cairo_pdf_surface_set_metadata(made, CAIRO_PDF_METADATA_CREATOR, "ptin");
    return made;
  }

  void check() const { require_done(cairo_status(cairo_.get()), path_); }

  std::string path_;
  bool overwrite_;
  int width_, height_;
  double dots_;
  PictureFormat format_;
  std::string bytes_;  ///< Bytes of the file; declared before the surface, which writes them.
  Surface surface_;
  std::unique_ptr<cairo_t, decltype(&cairo_destroy)> cairo_;
};

Canvas::Canvas(std::string path, bool overwrite, int width, int height, double dots)
    : impl_(std::make_unique<Impl>(std::move(path), overwrite, width, height, dots)) {}

Canvas::~Canvas() = default;

int Canvas::width() const noexcept { return impl_->width(); }
int Canvas::height() const noexcept { return impl_->height(); }

void Canvas::paint(const Image& image, double dots) { impl_->paint(image, dots); }

void Canvas::line(std::span<const CanvasPoint> points, const Stroke& stroke) {
  impl_->trace(points);
  impl_->stroke(stroke);
}

void Canvas::line(CanvasPoint from, CanvasPoint to, const Stroke& stroke) {
  line(std::array{from, to}, stroke);
}

void Canvas::polygon(std::span<const CanvasPoint> points, const Colour& colour, double opacity) {
  impl_->trace(points);
  impl_->colour(colour, opacity);
  cairo_fill(impl_->cairo());
}

void Canvas::box(const CanvasBox& box, const Colour& colour, double opacity) {
  impl_->box(box, colour, opacity);
}

void Canvas::hatch(const CanvasBox& box, const Stroke& stroke) {
  constexpr double kSpacing = 8.0;
  clip(box);
  const double height = box.height();
  // Lines begin at multiples of the spacing, so that those of boxes side by side go on.
  for (double x = std::floor((box.left - height) / kSpacing) * kSpacing; x < box.right;
       x += kSpacing) {
    cairo_move_to(impl_->cairo(), x, box.bottom);
    cairo_line_to(impl_->cairo(), x + height, box.top);
  }
  impl_->stroke(stroke);
  unclip();
}

void Canvas::dot(CanvasPoint middle, double radius, const Colour& colour) {
  impl_->colour(colour, 1.0);
  cairo_arc(impl_->cairo(), middle.x, middle.y, radius, 0.0, 2 * M_PI);
  cairo_fill(impl_->cairo());
}

void Canvas::text(CanvasPoint at, const std::string& text, const TextStyle& style) {
  const std::string shown = readable(text);
  const double width = impl_->text_width(shown, style);
  const double share =
      style.anchor == TextAnchor::kBegin ? 0.0 : (style.anchor == TextAnchor::kMiddle ? 0.5 : 1.0);
  constexpr double kHalfOfDigit = 0.36;  // of the font's size
  cairo_t* const cairo = impl_->cairo();
  cairo_save(cairo);
  cairo_translate(cairo, at.x, at.y);
  cairo_rotate(cairo, style.turn);
  if (style.halo > 0) {
    cairo_move_to(cairo, -share * width, kHalfOfDigit * style.size);
    cairo_text_path(cairo, shown.c_str());
    impl_->stroke({{255, 255, 255}, 2 * style.halo, 0.8});
  }
  cairo_move_to(cairo, -share * width, kHalfOfDigit * style.size);
  impl_->colour(style.colour, 1.0);
  cairo_show_text(cairo, shown.c_str());
  cairo_new_path(cairo);
  cairo_restore(cairo);
}

double Canvas::text_width(const std::string& text, const TextStyle& style) {
  return impl_->text_width(readable(text), style);
}

void Canvas::clip(const CanvasBox& box) {
  cairo_save(impl_->cairo());
  cairo_rectangle(impl_->cairo(), box.left, box.top, box.width(), box.height());
  cairo_clip(impl_->cairo());
}

void Canvas::unclip() { cairo_restore(impl_->cairo()); }

void Canvas::enter(const CanvasBox& box) {
  clip(box);
  cairo_translate(impl_->cairo(), box.left, box.top);
}

void Canvas::publish() { impl_->publish(); }

}  // namespace ptin::tools
