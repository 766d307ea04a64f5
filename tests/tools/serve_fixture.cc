// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/tools/serve_fixture.h"

#include <algorithm>
#include <cctype>
#include <cmath>

#include "tools/http/etag.h"

namespace ptin::tools::testing {

serve::ServeOptions serve_options(const TestFolder& folder) {
  serve::ServeOptions options;
  options.http = unhurried_limits();
  options.files = {{"mountains", built(folder, "mountains_257.tif", "mountains.ptin")},
                   {"coast", built(folder, "coast_257.tif", "coast.ptin")}};
  options.http.threads = 2;
  options.version = "test";
  return options;
}

std::string encoded(const std::string& text) {
  std::string code;
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    if (std::isalnum(byte) != 0 || c == '.' || c == '-') {
      code += c;
    } else {
      code += "%" + http::hex_of(byte).substr(14);
    }
  }
  return code;
}

void expect_number(const nlohmann::json& told, double number) {
  if (std::isnan(number)) {
    EXPECT_TRUE(told.is_null()) << told;
  } else {
    EXPECT_EQ(told.get<double>(), number);
  }
}

std::unique_ptr<TestFolder> Serve::folder_;
std::vector<serve::ServedFile> Serve::files_;
std::unique_ptr<ServedTerrains> Serve::served_;
std::unique_ptr<Terrain> Serve::mountains_, Serve::coast_;

void Serve::SetUpTestSuite() {
  folder_ = std::make_unique<TestFolder>();
  serve::ServeOptions options = serve_options(*folder_);
  options.offers_files = true;
  options.cors_origin = "*";
  files_ = options.files;
  served_ = std::make_unique<ServedTerrains>(options);
  mountains_ = std::make_unique<Terrain>(files_[0].path);
  coast_ = std::make_unique<Terrain>(files_[1].path);
}

void Serve::TearDownTestSuite() {
  coast_.reset();
  mountains_.reset();
  served_.reset();
  folder_.reset();
}

Window Serve::bounds_of(const Terrain& terrain) {
  const StoreFacts& facts = terrain.store().facts();
  const MapPoint a = facts.map.to_map(facts.bounds.min_x, facts.bounds.min_y);
  const MapPoint b = facts.map.to_map(facts.bounds.max_x, facts.bounds.max_y);
  return {std::min(a.x, b.x), std::min(a.y, b.y), std::max(a.x, b.x), std::max(a.y, b.y)};
}

MapPoint Serve::some_place(const Terrain& terrain, std::mt19937_64& random) {
  const Window w = bounds_of(terrain);
  std::uniform_real_distribution<double> share(-0.02, 1.02);
  return {w.min_x + share(random) * (w.max_x - w.min_x),
          w.min_y + share(random) * (w.max_y - w.min_y)};
}

Window Serve::middle_of_bounds(const Terrain& terrain, double share) {
  const Window w = bounds_of(terrain);
  const double x = (w.min_x + w.max_x) / 2, y = (w.min_y + w.max_y) / 2;
  return {x, y, x + share * (w.max_x - w.min_x), y + share * (w.max_y - w.min_y)};
}

std::string Serve::text_of(const MapPoint& p) {
  return nlohmann::json(p.x).dump() + " " + nlohmann::json(p.y).dump();
}

std::string Serve::window_text(const Window& w) {
  std::string text;
  for (const double v : {w.min_x, w.min_y, w.max_x, w.max_y})
    text += (text.empty() ? "" : ",") + nlohmann::json(v).dump();
  return text;
}

std::unique_ptr<TestFolder> ServeElsewhere::folder_;
std::vector<serve::ServedFile> ServeElsewhere::files_;
std::unique_ptr<ServedTerrains> ServeElsewhere::served_;

void ServeElsewhere::SetUpTestSuite() {
  folder_ = std::make_unique<TestFolder>();
  serve::ServeOptions options;
  options.http = unhurried_limits();
  options.version = "test";
  options.question.question_memory = 4 << 20;
  const auto add = [&](const std::string& id, int epsg, double west, double north, double pixel) {
    RasterRecipe recipe;
    recipe.value = hills;
    recipe.epsg = epsg;
    recipe.west = west;
    recipe.north = north;
    recipe.pixel = pixel;
    recipe.unit = id == "metres" ? "m" : "ft";
    const std::string name = folder_->file(id);
    make_raster(name + ".tif", recipe);
    build_terrain(name + ".tif", name + ".ptin");
    options.files.push_back({id, name + ".ptin"});
  };
  add("feet", 32611, 600000, 4000000, 30);
  add("degrees", 4326, 179.95, 10.05, 0.1 / 33);
  add("metres", 32601, 166100, 1110000, 300);
  add("austria", 31287, 400000, 400000, 300);
  add("arctic", 3413, -30000, 60000, 3000);
  add("antarctic", 3031, -30000, 60000, 3000);
  add("ross", 3031, -45000, -1500, 3000);
  files_ = options.files;
  served_ = std::make_unique<ServedTerrains>(options);
}

void ServeElsewhere::TearDownTestSuite() {
  served_.reset();
  folder_.reset();
}

}  // namespace ptin::tools::testing
