// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/serve/landing_page.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <ctime>
#include <optional>
#include <vector>

#include "engine/crs/ground.h"
#include "tools/facts/human.h"
#include "tools/formats/markup_text.h"

namespace ptin::serve {

namespace {

std::string member(const Json& told, const char* name) {
  const auto found = told.find(name);
  return found != told.end() && found->is_string() ? found->get<std::string>() : std::string();
}

/// A number with a tenth.
std::string tenth(double value) {
  std::string text = std::to_string(std::round(10 * value) / 10);
  return text.substr(0, text.find('.') + 2);
}

/// The page asks the service at the root of its host unless it is told.
std::string viewer_address(const std::string& root, const std::string& id) {
  const std::string address = root + "/viewer/index.html?collection=" + id;
  return root.empty() ? address : address + "&amp;service=" + root;
}

/// What a terrain is called: by its metadata, or else by its name, which holds nothing that HTML would read.
std::string title_of(const ListedTerrain& terrain) {
  const std::string title = member(terrain.told, "title");
  return title.empty() ? terrain.collection->id : tools::markup_text(title);
}

// The map of extents.

struct Box {
  double west, south, east, north;
};

/// Degrees between two lines of the graticule: some ten lines across the window.
double graticule_of(double span) {
  constexpr std::array kSteps = {0.1, 0.2, 0.5, 1.0, 2.0, 5.0, 10.0, 15.0, 30.0, 45.0, 90.0};
  for (const double step : kSteps) {
    if (span / step <= 12) return step;
  }
  return kSteps.back();
}

/// Boxes of longitude and latitude, with the number of the terrain that each belongs to; an extent across the antimeridian has two.
std::vector<std::pair<std::size_t, Box>> boxes_of(std::span<const ListedTerrain> terrains) {
  std::vector<std::pair<std::size_t, Box>> boxes;
  for (std::size_t i = 0; i < terrains.size(); ++i) {
    const std::optional<Window>& w = terrains[i].collection->lon_lat;
    if (!w) continue;
    if (w->min_x <= w->max_x) {
      boxes.push_back({i, {w->min_x, w->min_y, w->max_x, w->max_y}});
      continue;
    }
    boxes.push_back({i, {w->min_x, w->min_y, 180, w->max_y}});
    boxes.push_back({i, {-180, w->min_y, w->max_x, w->max_y}});
  }
  return boxes;
}

/// What the map shows: all boxes with as much again beside them, within the Earth, twice as wide as high.
Box shown_part(const std::vector<std::pair<std::size_t, Box>>& boxes) {
  Box all = boxes.front().second;
  for (const auto& [number, b] : boxes) {
    all = {std::min(all.west, b.west), std::min(all.south, b.south), std::max(all.east, b.east),
           std::max(all.north, b.north)};
  }
  constexpr double kLeastSpan = 2;  // Degrees: of less a graticule tells nothing.
  const double wide =
      std::max({2 * (all.east - all.west), 4 * (all.north - all.south), kLeastSpan});
  if (wide >= 180) return {-180, -90, 180, 90};
  const double x = std::clamp((all.west + all.east) / 2, -180 + wide / 2, 180 - wide / 2);
  const double y = std::clamp((all.south + all.north) / 2, -90 + wide / 4, 90 - wide / 4);
  return {x - wide / 2, y - wide / 4, x + wide / 2, y + wide / 4};
}

constexpr double kMapWidth = 720, kMapHeight = 360;  // Units of the drawing.

/// "12°", with the letter of its side.
std::string degrees_text(double value, const char* positive, const char* negative) {
  std::string text = tools::short_number(std::abs(std::round(value * 10) / 10)) + "°";
  if (value > 1e-9) text += positive;
  if (value < -1e-9) text += negative;
  return text;
}

void add_graticule(std::string& svg, const Box& part) {
  const double step = graticule_of(part.east - part.west);
  const auto number = [](double v) { return tenth(v); };
  // Not at the edges themselves, nor where the labels of the two would meet.
  for (double lon = (std::floor(part.west / step) + 1) * step; lon < part.east; lon += step) {
    const std::string x = number((lon - part.west) / (part.east - part.west) * kMapWidth);
    svg += "<path d=\"M" + x + " 0V" + number(kMapHeight) + "\"/><text x=\"" + x + "\" y=\"" +
           number(kMapHeight - 6) + "\">" + degrees_text(lon, "E", "W") + "</text>";
  }
  const double low = part.south + 0.06 * (part.north - part.south);
  for (double lat = std::ceil(low / step) * step; lat < part.north; lat += step) {
    const std::string y = number((part.north - lat) / (part.north - part.south) * kMapHeight);
    svg += "<path d=\"M0 " + y + "H" + number(kMapWidth) + "\"/><text x=\"6\" y=\"" + y + "\">" +
           degrees_text(lat, "N", "S") + "</text>";
  }
}

/// A box that can be seen however small it is, and clicked.
std::string drawn_box(const Box& part, const Box& box, const ListedTerrain& terrain,
                      const std::string& root) {
  constexpr double kLeastDrawn = 7;
  const double scale_x = kMapWidth / (part.east - part.west);
  const double scale_y = kMapHeight / (part.north - part.south);
  const double width = std::max(kLeastDrawn, (box.east - box.west) * scale_x);
  const double height = std::max(kLeastDrawn, (box.north - box.south) * scale_y);
  const double x = ((box.west + box.east) / 2 - part.west) * scale_x - width / 2;
  const double y = (part.north - (box.south + box.north) / 2) * scale_y - height / 2;
  const std::string name = title_of(terrain);
  return "<a href=\"" + viewer_address(root, terrain.collection->id) + "\" aria-label=\"" + name +
         "\"><rect x=\"" + tenth(x) + "\" y=\"" + tenth(y) + "\" width=\"" + tenth(width) +
         "\" height=\"" + tenth(height) + "\"><title>" + name + "</title></rect></a>";
}

std::string map_of(std::span<const ListedTerrain> terrains, const std::string& root) {
  const auto boxes = boxes_of(terrains);
  if (boxes.empty()) return {};
  const Box part = shown_part(boxes);
  std::string svg =
      "<h2>Where they are</h2><svg class=\"map\" viewBox=\"0 0 720 360\" role=\"group\" "
      "aria-label=\"Extents in degrees east and north\"><g class=\"graticule\" "
      "aria-hidden=\"true\">";
  add_graticule(svg, part);
  svg += "</g>";
  for (const auto& [number, box] : boxes) {
    svg += drawn_box(part, box, terrains[number], root);
  }
  return svg + "</svg>";
}

// The cards.

std::string row(const char* what, const std::string& value) {
  if (value.empty()) return {};
  return "<div><dt>" + std::string(what) + "</dt><dd>" + tools::markup_text(value) + "</dd></div>";
}

/// Over ground where that is known: "92.3 x 110.8 km".
std::string size_of(const Collection& c) {
  const Window& b = c.bounds;
  const auto metre = metres_per_map_unit(c.crs, {(b.min_x + b.max_x) / 2, (b.min_y + b.max_y) / 2});
  if (!metre) return {};
  const double wide = (b.max_x - b.min_x) * metre->x, deep = (b.max_y - b.min_y) * metre->y;
  const bool in_km = std::max(wide, deep) >= 2000;
  const double unit = in_km ? 1000 : 1;
  return tenth(wide / unit) + " × " + tenth(deep / unit) + (in_km ? " km" : " m");
}

std::string heights_of(const Collection& c) {
  const StoreFacts& facts = c.terrain.store().facts();
  if (facts.min_height > facts.max_height) return "none";
  return tools::short_number(facts.min_height) + " to " + tools::short_number(facts.max_height) +
         " " +
         (c.crs.vertical_unit == "unknown" ? "of an unknown unit"
                                           : tools::plural_of(c.crs.vertical_unit));
}

/// The day on which the file was last written; of one elsewhere nobody knows.
std::string day_of(const Collection& c) {
  if (c.identity.seconds == 0) return {};
  const auto seconds = static_cast<std::time_t>(c.identity.seconds);
  std::tm parts{};
  ::gmtime_r(&seconds, &parts);
  std::array<char, 16> text{};
  return std::string(text.data(), std::strftime(text.data(), text.size(), "%Y-%m-%d", &parts));
}

std::string crs_of(const Collection& c) {
  if (c.crs.name.empty()) return c.crs.wkt.empty() ? "not known" : "a CRS without a name";
  return c.crs.code.empty() ? c.crs.name : c.crs.name + " (" + c.crs.code + ")";
}

std::string datum_of(const Collection& c) {
  if (c.crs.vertical_name.empty()) return "not known";
  return c.crs.vertical_code.empty() || c.crs.has_third_axis
             ? c.crs.vertical_name
             : c.crs.vertical_name + " (" + c.crs.vertical_code + ")";
}

std::string card_of(const ListedTerrain& terrain, const std::string& root) {
  const Collection& c = *terrain.collection;
  const std::string title = title_of(terrain), base = root + "/collections/" + c.id;
  const std::uint64_t vertices =
      c.terrain.store().t0().vertices.size() + c.terrain.store().record_count();
  const std::string picture = base + "/thumbnail.png?width=480&amp;height=300";
  return "<article><a class=\"open\" href=\"" + viewer_address(root, c.id) + "\"><img src=\"" +
         picture + "\" width=\"320\" height=\"200\" loading=\"lazy\" alt=\"\"><h2>" + title +
         "</h2></a><dl>" + row("Size", size_of(c)) + row("Heights", heights_of(c)) +
         row("CRS", crs_of(c)) + row("Heights above", datum_of(c)) +
         row("Vertices",
             tools::grouped(vertices) + ", " + tools::human_bytes(c.terrain.store().file_bytes())) +
         row("Written", day_of(c)) + row("Source", member(terrain.told, "attribution")) +
         "</dl><p><a href=\"" + base + "\">All facts of " + title + "</a></p></article>";
}

}  // namespace

std::string landing_page(std::span<const ListedTerrain> terrains, const std::string& root) {
  std::string page =
      "<!doctype html><html lang=\"en\"><head><meta charset=\"utf-8\"><title>Terrains</title>"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">"
      "<meta name=\"color-scheme\" content=\"light dark\">";
  if (!terrains.empty()) {
    page += "<link rel=\"icon\" href=\"" + root + "/collections/" +
            terrains.front().collection->id + "/thumbnail.png?width=32&amp;height=32\">";
  }
  page +=
      "<link rel=\"stylesheet\" href=\"" + root +
      "/style.css\"></head><body><main><h1>Terrains</h1>"
      "<p class=\"lead\">Heights, contours and lines of sight, each exact or within a certified "
      "error.</p>"
      "<div class=\"cards\">";
  for (const ListedTerrain& terrain : terrains) page += card_of(terrain, root);
  return page + "</div>" + map_of(terrains, root) + "</main><footer><a href=\"" + root +
         "/api\">The service as OpenAPI</a> · "
         "<a href=\"" +
         root + "/collections\">The terrains as JSON</a></footer></body></html>\n";
}

std::string_view landing_style() noexcept {
  return R"(:root { color-scheme: light dark; --ink: #17212b; --soft: #526171; --line: #17212b26; --card: #fff; --page: #eef2f3; --accent: #1d6f5c; }
@media (prefers-color-scheme: dark) { :root { --ink: #e8eef3; --soft: #9fb0bf; --line: #ffffff26; --card: #18212b; --page: #10161d; --accent: #5cc2a3; } }
* { box-sizing: border-box; }
body { margin: 0; background: var(--page); color: var(--ink); font: 16px/1.5 Inter, system-ui, -apple-system, "Segoe UI", Roboto, "Noto Sans", sans-serif; }
main, footer { max-width: 72rem; margin: 0 auto; padding: 2rem 1rem; }
h1 { margin: 0; font-size: 2rem; letter-spacing: -.02em; }
h2 { font-size: 1.15rem; margin: 2rem 0 .5rem; overflow-wrap: anywhere; }
.lead { margin: .25rem 0 1.5rem; color: var(--soft); }
.cards { display: grid; grid-template-columns: repeat(auto-fill, minmax(17rem, 1fr)); gap: 1rem; }
article { background: var(--card); border: 1px solid var(--line); border-radius: 14px; padding: 1rem; }
article img { width: 100%; height: auto; aspect-ratio: 8 / 5; display: block; object-fit: contain; }
article h2 { margin: .75rem 0 .5rem; }
a { color: var(--accent); }
.open { color: inherit; text-decoration: none; }
.open:hover h2, .open:focus h2 { text-decoration: underline; }
dl { margin: 0; font-size: .875rem; }
dl div { display: flex; justify-content: space-between; gap: 1rem; padding: .2rem 0; border-top: 1px solid var(--line); }
dt { color: var(--soft); white-space: nowrap; }
dd { margin: 0; text-align: right; overflow-wrap: anywhere; font-variant-numeric: tabular-nums; }
article p { margin: .75rem 0 0; font-size: .875rem; }
.map { display: block; width: 100%; max-width: 45rem; background: var(--card); border: 1px solid var(--line); border-radius: 14px; }
.graticule path { stroke: var(--line); }
.graticule text { fill: var(--soft); font-size: 12px; }
.map rect { fill: var(--accent); fill-opacity: .35; stroke: var(--accent); stroke-width: 1.5; }
.map a:hover rect, .map a:focus rect { fill-opacity: .8; }
:focus-visible { outline: 3px solid var(--accent); outline-offset: 2px; border-radius: 6px; }
)";
}

}  // namespace ptin::serve
