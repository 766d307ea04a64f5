// SPDX-License-Identifier: GPL-3.0-or-later
//
// Points as text for `verify --against`: three numbers a line, x y z, apart by blanks, tabs, commas
// or semicolons; a first line that names columns x, y and z (or lon, lat; easting, northing;
// height, elevation) chooses them.
#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <fstream>
#include <map>

#include "engine/error.h"
#include "engine/geometry/point.h"
#include "tools/ptin/source_samples.h"

namespace ptin::tools {

namespace {

std::vector<std::string> words_of(const std::string& line) {
  std::vector<std::string> words;
  std::string word;
  for (const char c : line + " ") {
    if (c == ' ' || c == '\t' || c == ',' || c == ';' || c == '\r' || c == '"') {
      if (!word.empty()) words.push_back(word);
      word.clear();
    } else {
      word += c;
    }
  }
  return words;
}

std::optional<double> number_of(const std::string& word) {
  double value = 0.0;
  const char* first = word.data() + (word.front() == '+' ? 1 : 0);
  const auto [end, status] = std::from_chars(first, word.data() + word.size(), value);
  if (status != std::errc() || end != word.data() + word.size()) return std::nullopt;
  return value;
}

/// Which columns a header names; the first three when it does not.
std::array<std::size_t, 3> columns_of(const std::vector<std::string>& header) {
  constexpr std::array<std::array<const char*, 5>, 3> kNames = {
      {{"x", "lon", "longitude", "easting", "east"},
       {"y", "lat", "latitude", "northing", "north"},
       {"z", "height", "elevation", "elev", "h"}}};
  std::array<std::size_t, 3> columns{0, 1, 2};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    for (std::size_t i = 0; i < header.size(); ++i) {
      std::string name = header[i];
      std::transform(name.begin(), name.end(), name.begin(),
                     [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
      if (std::find(kNames[axis].begin(), kNames[axis].end(), name) != kNames[axis].end())
        columns[axis] = i;
    }
  }
  return columns;
}

/// What the reader of this file takes: anything that is not known as LAS, packed text or a layer.
bool is_plain_text(const std::string& path) {
  std::string name = path;
  std::transform(name.begin(), name.end(), name.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return !name.ends_with(".las") && !name.ends_with(".laz") && !name.ends_with(".gz") &&
         (is_point_file(path) || !is_point_input(path, {}));
}

class PointSamples final : public SourceSamples {
 public:
  PointSamples(const std::vector<std::string>& paths, const StoreFile& store)
      : heights_(store.facts().heights), choices_(choices_of(store)) {
    for (const std::string& path : paths) {
      if (is_plain_text(path) && choices_.points.z_field.empty() && choices_.points.layer.empty()) {
        read_file(path, store.facts());
      } else {
        read_stream(path, store.facts());
      }
    }
    std::sort(samples_.begin(), samples_.end(),
              [](const Sample& a, const Sample& b) { return a.y != b.y ? a.y < b.y : a.x < b.x; });
    merge();
  }

  [[nodiscard]] const std::vector<std::string>& misfits() const noexcept override {
    return misfits_;
  }

  [[nodiscard]] SampleWindow read(const GridBox& box) override {
    SampleWindow window;
    window.box = box;
    const auto row = [](const Sample& s, std::int32_t y) { return s.y < y; };
    auto it = std::lower_bound(samples_.begin(), samples_.end(), box.min_y, row);
    for (; it != samples_.end() && it->y <= box.max_y; ++it) {
      if (it->x >= box.min_x && it->x <= box.max_x) window.samples.push_back(*it);
    }
    return window;
  }

 private:
  void read_file(const std::string& path, const StoreFacts& facts);
  void read_stream(const std::string& path, const StoreFacts& facts);
  void add(const std::array<double, 3>& p, const StoreFacts& facts, const std::string& where);
  void merge();
  /// Whole codes, so that sums are exact; heights where the store keeps floats.
  [[nodiscard]] double code_of(double height) const {
    return heights_.type == HeightType::int32
               ? std::nearbyint((height - heights_.offset) / heights_.step)
               : height;
  }
  [[nodiscard]] double rounded_mean(double sum, std::size_t count) const {
    const double mean = sum / static_cast<double>(count);
    return heights_.type == HeightType::int32 ? heights_.height_of_code(std::nearbyint(mean))
                                              : mean;
  }

  HeightEncoding heights_;
  SampleChoices choices_;
  std::vector<Sample> samples_;  ///< By y, then x.
  std::vector<std::string> misfits_;
};

void PointSamples::read_file(const std::string& path, const StoreFacts& facts) {
  std::ifstream in(path);
  if (!in) throw Error(ErrorCode::io_error, "cannot be read", path);
  std::string line;
  std::array<std::size_t, 3> columns{0, 1, 2};
  bool first = true;
  std::size_t found = 0;
  for (std::size_t number = 1; std::getline(in, line); ++number) {
    const std::vector<std::string> words = words_of(line);
    if (words.empty() || words[0][0] == '#') continue;
    std::array<double, 3> point{};
    bool fits = true;
    for (std::size_t axis = 0; axis < 3 && fits; ++axis) {
      const auto value =
          columns[axis] < words.size() ? number_of(words[columns[axis]]) : std::nullopt;
      fits = value.has_value();
      point[axis] = value.value_or(0.0);
    }
    if (fits) {
      add(point, facts, path + ":" + std::to_string(number));
      ++found;
    } else if (first) {
      columns = columns_of(words);
    }
    first = false;
  }
  if (found == 0) {
    throw Error(ErrorCode::invalid_argument,
                "neither a raster that GDAL reads nor points as lines of x y z", path);
  }
}

void PointSamples::read_stream(const std::string& path, const StoreFacts& facts) {
  const auto stream = open_point_stream(path, choices_.points, choices_.nodata);
  std::vector<SourcePoint> batch;
  std::uint64_t number = 0;
  while (stream->next(batch)) {
    for (const SourcePoint& p : batch) {
      add({to_double(p.x), to_double(p.y), to_double(p.z)}, facts,
          path + ": point " + std::to_string(++number));
    }
  }
}

void PointSamples::add(const std::array<double, 3>& p, const StoreFacts& facts,
                       const std::string& where) {
  if (choices_.nodata && p[2] == *choices_.nodata) return;
  const MapPoint grid = facts.map.to_grid({p[0], p[1]});
  const auto x = std::llround(grid.x);
  const auto y = std::llround(grid.y);
  const GridBox& b = facts.bounds;
  if (x < b.min_x || x > b.max_x || y < b.min_y || y > b.max_y) {
    if (!choices_.bbox && misfits_.size() < 10)
      misfits_.push_back(where + ": this point lies outside of the terrain");
    return;
  }
  samples_.push_back({static_cast<std::int32_t>(x), static_cast<std::int32_t>(y), p[2], false});
}

/// Points on one grid point count as one, at their mean height, rounded as heights are stored, as
/// the builder documents.
void PointSamples::merge() {
  std::size_t kept = 0;
  for (std::size_t i = 0; i < samples_.size();) {
    std::size_t end = i;
    double sum = 0.0;
    while (end < samples_.size() && samples_[end].x == samples_[i].x &&
           samples_[end].y == samples_[i].y) {
      sum += code_of(samples_[end++].height);
    }
    samples_[kept] = samples_[i];
    if (end - i > 1) samples_[kept].height = rounded_mean(sum, end - i);
    ++kept;
    i = end;
  }
  samples_.resize(kept);
}

}  // namespace

std::unique_ptr<SourceSamples> open_point_samples(const std::vector<std::string>& paths,
                                                  const StoreFile& store) {
  return std::make_unique<PointSamples>(paths, store);
}

}  // namespace ptin::tools
