// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/read/tin_file.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <utility>

#include "engine/construct/grid/crs_beside.h"
#include "engine/construct/grid/source_point.h"
#include "engine/construct/read/tin_reader.h"
#include "engine/error.h"
#include "engine/number.h"
#include "engine/stop.h"

namespace ptin {

namespace {

struct TinFormat {
  std::string_view extension;
  TinReader* read;
};
constexpr std::array<TinFormat, 5> kFormats = {{{".ply", read_ply},
                                                {".obj", read_obj},
                                                {".2dm", read_two_dm},
                                                {".xml", read_land_xml},
                                                {".landxml", read_land_xml}}};

const TinFormat* format_of(std::string_view path) {
  std::string name(path);
  std::transform(name.begin(), name.end(), name.begin(), [](char c) {
    return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  });
  for (const TinFormat& format : kFormats) {
    if (name.ends_with(format.extension)) {
      return &format;
    }
  }
  return nullptr;
}

}  // namespace

bool is_tin_file(std::string_view path) { return format_of(path) != nullptr; }

bool may_have_surfaces(std::string_view path) {
  const TinFormat* format = format_of(path);
  return format != nullptr && format->read == read_land_xml;
}

TinReader& tin_reader_of(const std::string& path) {
  const TinFormat* format = format_of(path);
  if (format == nullptr) {
    refuse("this is no TIN by its name; known are .ply, .obj, .2dm, .xml, .landxml", path);
  }
  return *format->read;
}

TinFileFacts read_tin_file(const std::string& path, const TinReading& reading, TinFileSink& sink) {
  TinReader& read = tin_reader_of(path);
  ByteReader in(path);
  TinFileFacts facts = read(in, reading, sink);
  take_crs_beside(path, facts.crs, facts.warnings);
  return facts;
}

void split_words(std::string_view line, std::vector<std::string_view>& words) {
  words.clear();
  std::size_t at = 0;
  while ((at = line.find_first_not_of(" \t", at)) != std::string_view::npos) {
    const std::size_t end = std::min(line.find_first_of(" \t", at), line.size());
    words.push_back(line.substr(at, end - at));
    at = end;
  }
}

Decimal coordinate_of(std::string_view word, const std::string& place) {
  Decimal value;
  switch (parse_number(word, value)) {
    case NumberKind::kNumber:
      return value;
    case NumberKind::kNotANumber:
    case NumberKind::kInfinite:
      refuse("a coordinate is not a finite number", place);
    case NumberKind::kTooLarge:
      refuse("a coordinate is 10^18 or more", place);
    case NumberKind::kNoNumber:
      break;
  }
  refuse(word.empty() ? "a number is absent, where a coordinate belongs"
                      : "'" + std::string(word.substr(0, 40)) + "' stands where a number belongs",
         place);
}

Decimal coordinate_of(double value, const std::string& place) {
  if (!(std::abs(value) < 1e18)) {
    refuse("a coordinate is not a finite number below 10^18", place);
  }
  return decimal_of(value);
}

Decimal coordinate_of(float value, const std::string& place) {
  char text[64];
  const auto end = std::to_chars(text, text + sizeof text, value).ptr;
  return coordinate_of({text, static_cast<std::size_t>(end - text)}, place);
}

std::int64_t whole_of(std::string_view word, const std::string& place) {
  const auto value = parse_number<std::int64_t>(word);
  if (!value) {
    refuse(word.empty()
               ? "a whole number is absent, where an id or a count belongs"
               : "'" + std::string(word.substr(0, 40)) + "' stands where a whole number belongs",
           place);
  }
  return *value;
}

void TinReceiver::refuse_corners(std::uint64_t count, const std::string& place) {
  refuse("a face has " + std::to_string(count) +
             (count < 3 ? " corners, which are no surface; leave it out"
                        : " corners; triangles and quads are read: triangulate it first, since a "
                          "face that is not flat is another surface by each triangulation"),
         place);
}

void TinReceiver::add_face(std::span<const std::int64_t> ids, const std::string& place) {
  if (ids.size() != 3 && ids.size() != 4) {
    refuse_corners(ids.size(), place);
  }
  look_around();
  ++facts_.faces;
  if (ids.size() == 4) {
    for (std::size_t i = 0; i < 4; ++i) {
      if (ids[i] == ids[(i + 1) % 4]) {
        sink_.add_face(std::array{ids[(i + 1) % 4], ids[(i + 2) % 4], ids[(i + 3) % 4]});
        return;
      }
    }
  }
  sink_.add_face(ids);
}

/// Takes the declarations of comments, which files with others of their own (LandXML) do not read.
void TinReceiver::take_comments() {
  if (!comments_.crs().empty()) {
    facts_.crs = comments_.crs();
  }
  if (!comments_.vertical_crs().empty()) {
    facts_.vertical_crs = comments_.vertical_crs();
  }
  if (const DeclaredUnits units = comments_.units(); units != DeclaredUnits{}) {
    facts_.units = units;
  }
  comments_.tell(in_.path(), facts_.warnings);
  if (const auto nodata = comments_.nodata()) {
    char value[32];
    std::snprintf(value, sizeof value, "%.15g", *nodata);
    warn({.kind = "nodata_in_comment",
          .message = std::string("a comment says that the height ") + value +
                     " means none, which is not followed; build with --nodata " + value,
          .file = in_.path()});
  }
}

void TinReceiver::look_around() {
  constexpr std::uint64_t kInterval = 1 << 16;
  if (++added_ % kInterval != 0) {
    return;
  }
  stop_if_asked(reading_.stop, "reading", in_.path());
  if (reading_.progress) {
    reading_.progress(in_.position(), in_.size());
  }
}

TinFileFacts TinReceiver::finish() {
  if (facts_.vertices == 0 || facts_.faces == 0) {
    refuse(facts_.vertices == 0 ? "there is no vertex in this file"
           : facts_.hidden_triangles > 0
               ? "every triangle in this file is hidden"
               : "there is no triangle in this file; points alone are built from CSV, XYZ or LAS",
           in_.path());
  }
  take_comments();
  return std::move(facts_);
}

}  // namespace ptin
