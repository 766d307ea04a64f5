// SPDX-License-Identifier: GPL-3.0-or-later
//
// A sheet to draw on, which becomes a PNG, SVG or PDF file. Cairo draws; nothing else here knows it.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>

#include "tools/plot/image.h"

namespace ptin::tools {

/// ".png, .svg, .pdf", for help texts and errors.
[[nodiscard]] std::string known_picture_extensions();
/// True when a file's extension is one of them, in large or small letters.
[[nodiscard]] bool is_picture_name(const std::string& path);

/// Pixels to the right and downwards from the upper left corner; the middle of the first pixel is at
/// (0.5, 0.5). In a PDF a pixel is three quarters of a point.
struct CanvasPoint {
  double x, y;
};
struct CanvasBox {
  double left, top, right, bottom;
  [[nodiscard]] double width() const { return right - left; }
  [[nodiscard]] double height() const { return bottom - top; }
};

constexpr Colour kInk{24, 26, 34};

struct Stroke {
  Colour colour = kInk;
  double width = 1.0;  ///< Pixels.
  double opacity = 1.0;
  bool is_dashed = false;
};

/// Which part of a text stands at its point; its middle line does.
enum class TextAnchor : std::uint8_t { kBegin, kMiddle, kEnd };
struct TextStyle {
  TextAnchor anchor = TextAnchor::kBegin;
  double size = 12.0;  ///< Pixels of the font.
  bool is_bold = false;
  double turn = 0.0;  ///< Radians clockwise about its point; kReadFromBelow goes upwards.
  double halo = 0.0;  ///< Pixels of white around the letters, which keep it legible on a picture.
  Colour colour = kInk;
};
constexpr double kReadFromBelow = -1.5707963267948966;  // a quarter turn

/// White at first. Coordinates are within a million pixels of the sheet; a caller cuts what is not.
/// The same calls make the same bytes wherever the fonts are the same, but for a number in an SVG
/// that counts the sheets of its process. Where the system has no fonts, Cairo has letters of its own.
/// Threads: one owner.
class Canvas {
 public:
  /// @param path  Its extension says the format.
  /// @param dots  Pixels of a PNG for a pixel of the sheet, along each side; the other formats have
  ///              none.
  /// @throws Error invalid_argument    another extension
  ///               resource_exhausted  the sheet does not fit the system's memory
  Canvas(std::string path, bool overwrite, int width, int height, double dots = 1.0);
  ~Canvas();
  Canvas(const Canvas&) = delete;
  Canvas& operator=(const Canvas&) = delete;

  [[nodiscard]] int width() const noexcept;
  [[nodiscard]] int height() const noexcept;

  /// Draws an image, `dots` of whose pixels fill a pixel of the sheet, from the upper left corner.
  void paint(const Image& image, double dots = 1.0);
  void line(std::span<const CanvasPoint> points, const Stroke& stroke);
  void line(CanvasPoint from, CanvasPoint to, const Stroke& stroke);
  /// Fills what lies within the points.
  void polygon(std::span<const CanvasPoint> points, const Colour& colour, double opacity = 1.0);
  void box(const CanvasBox& box, const Colour& colour, double opacity = 1.0);
  /// Fills a box with slanting lines.
  void hatch(const CanvasBox& box, const Stroke& stroke);
  void dot(CanvasPoint middle, double radius, const Colour& colour);
  /// Writes a line of text. What is no UTF-8 or steers a terminal becomes question marks.
  void text(CanvasPoint at, const std::string& text, const TextStyle& style = {});
  [[nodiscard]] double text_width(const std::string& text, const TextStyle& style = {});

  /// Draws within a box alone, until unclip().
  void clip(const CanvasBox& box);
  void unclip();
  /// Draws within a box alone, whose upper left corner is (0, 0), until unclip().
  void enter(const CanvasBox& box);

  /// Completes the picture and makes its file appear.
  /// @throws Error as OutputFile; resource_exhausted  the system has no memory left
  void publish();

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace ptin::tools
