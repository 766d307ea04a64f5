// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/ptin/point_input.h"

#include <array>
#include <cmath>
#include <cstdio>
#include <functional>
#include <iostream>
#include <memory>
#include <optional>
#include <span>
#include <string_view>

#include <ogrsf_frmts.h>

#include "engine/construct/read/column_names.h"
#include "engine/construct/read/input_kind.h"
#include "engine/construct/read/text_rows.h"
#include "engine/construct/read/text_table.h"
#include "engine/error.h"
#include "engine/number.h"
#include "tools/output/file_name.h"
#include "tools/region/vector_input.h"

namespace ptin::tools {

namespace {

constexpr std::array<ColumnRole, 2> kPoint = {{{Coordinate::kX}, {Coordinate::kY}}};
constexpr std::array<ColumnRole, 6> kPair = {{{Coordinate::kX, 1},
                                              {Coordinate::kY, 1},
                                              {Coordinate::kZ, 1},
                                              {Coordinate::kX, 2},
                                              {Coordinate::kY, 2},
                                              {Coordinate::kZ, 2}}};

bool is_text(const std::string& path, const InputChoice& choice) {
  return choice.layer.empty() && (path == "-" || lower_extension(path).empty() ||
                                  point_format_of(path, {}) == PointFormat::kText);
}

double number_in(const TextRows& rows, std::size_t role) {
  const std::optional<double> value = parse_number<double>(rows.field(role));
  if (!value) rows.refuse_no_number(role);
  if (!std::isfinite(*value)) rows.refuse_field(role, "is not finite");
  return *value;
}

/// Reads rows of text; `take` gets the numbers of a row, in the order of the roles.
template <typename T>
void read_rows(TextTable& table, std::span<const ColumnRole> roles, const InputChoice& choice,
               const std::function<T(std::span<const double>)>& take, Asked<T>& asked) {
  TextRows rows(table, roles, choice.columns);
  const bool has_ids = rows.choose_id(choice.id);
  std::vector<double> numbers(roles.size());
  while (rows.next()) {
    for (std::size_t role = 0; role < roles.size(); ++role) numbers[role] = number_in(rows, role);
    asked.all.push_back(take(numbers));
    if (has_ids) asked.ids.emplace_back(rows.id());
  }
}

template <typename T>
Asked<T> read_text(const std::string& path, std::span<const ColumnRole> roles,
                   const InputChoice& choice,
                   const std::function<T(std::span<const double>)>& take) {
  Asked<T> asked;
  if (path == "-") {
    TextTable table("standard input", std::cin);
    read_rows(table, roles, choice, take, asked);
  } else {
    TextTable table(path);
    read_rows(table, roles, choice, take, asked);
  }
  return asked;
}

/// Tells features apart by an attribute.
class FeatureIds {
 public:
  FeatureIds(std::string name, std::string path) : name_(std::move(name)), path_(std::move(path)) {}

  /// Notes the feature's id for each of `asked` that has none yet.
  template <typename T>
  void note(const OGRFeature& feature, Asked<T>& asked) {
    if (!field_) field_ = field_in(*feature.GetDefnRef());
    if (*field_ == kNone) return;
    asked.ids.resize(asked.all.size(), id_of(feature));
  }

 private:
  static constexpr int kNone = -1;
  static constexpr int kFeatureId = -2;

  [[nodiscard]] int field_in(const OGRFeatureDefn& attributes) const;
  [[nodiscard]] std::string id_of(const OGRFeature& feature) const {
    if (*field_ == kFeatureId) return std::to_string(feature.GetFID());
    return feature.IsFieldSetAndNotNull(*field_) != 0 ? feature.GetFieldAsString(*field_) : "";
  }

  std::string name_, path_;
  std::optional<int> field_;
};

/// By itself an id is text or a whole number; a time or a measure is none.
bool may_be_id(const OGRFieldDefn& field) {
  const OGRFieldType type = field.GetType();
  return (type == OFTString || type == OFTInteger || type == OFTInteger64) &&
         !is_coordinate_name(field.GetNameRef());
}

int FeatureIds::field_in(const OGRFeatureDefn& attributes) const {
  std::string known;
  for (int i = 0; i < attributes.GetFieldCount(); ++i) {
    const OGRFieldDefn& field = *attributes.GetFieldDefn(i);
    const std::string name = field.GetNameRef();
    if (name_.empty() ? may_be_id(field) : equal_in_any_case(name, name_)) return i;
    known.append(known.empty() ? "'" : ", '").append(name).append("'");
  }
  if (name_.empty()) return kNone;
  if (equal_in_any_case(name_, "fid")) return kFeatureId;
  throw Error(
      ErrorCode::invalid_argument,
      "there is no attribute '" + name_ + "'; there is " + (known.empty() ? "none but fid" : known),
      path_);
}

void refuse_columns(const std::string& path, const InputChoice& choice) {
  if (choice.columns.empty()) return;
  throw Error(ErrorCode::invalid_argument, "--columns is for text, and this is none; leave it out",
              path);
}

/// Calls `take` with each geometry that is neither empty nor a collection of others.
void for_each_part(const OGRGeometry& geometry,
                   const std::function<void(const OGRGeometry&)>& take) {
  if (OGR_GT_IsSubClassOf(wkbFlatten(geometry.getGeometryType()), wkbGeometryCollection) == 0) {
    if (geometry.IsEmpty() == 0) take(geometry);
    return;
  }
  for (const OGRGeometry* part : *geometry.toGeometryCollection()) for_each_part(*part, take);
}

[[noreturn]] void refuse_feature(const OGRFeature& feature, const std::string& what,
                                 const std::string& path) {
  throw Error(ErrorCode::invalid_argument,
              "feature " + std::to_string(feature.GetFID()) + " " + what, path);
}

/// The heights above ground of the ends of lines: in attributes, or the z of their points.
class EndHeights {
 public:
  [[nodiscard]] std::optional<std::array<double, 2>> of(const OGRFeature& feature,
                                                        const OGRLineString& line) {
    if (fields_.empty()) find(*feature.GetDefnRef());
    std::array<double, 2> heights = {line.getZ(0), line.getZ(1)};
    if (fields_[0] < 0 || fields_[1] < 0) {
      return line.Is3D() != 0 ? std::optional(heights) : std::nullopt;
    }
    for (std::size_t end : {0, 1}) {
      if (feature.IsFieldSetAndNotNull(fields_[end]) == 0) return std::nullopt;
      heights[end] = feature.GetFieldAsDouble(fields_[end]);
    }
    return heights;
  }

 private:
  void find(const OGRFeatureDefn& attributes) {
    std::vector<std::string> names;
    for (int i = 0; i < attributes.GetFieldCount(); ++i)
      names.emplace_back(attributes.GetFieldDefn(i)->GetNameRef());
    for (const int end : {1, 2}) {
      const std::size_t field = find_column(names, {Coordinate::kZ, end});
      fields_.push_back(field == names.size() ? -1 : static_cast<int>(field));
    }
  }
  std::vector<int> fields_;  ///< -1: there is none.
};

std::vector<MapPoint> points_of(const OGRLineString& line) {
  std::vector<MapPoint> points;
  for (int i = 0; i < line.getNumPoints(); ++i) points.push_back({line.getX(i), line.getY(i)});
  return points;
}

void add_lines(const OGRGeometry& geometry, std::vector<std::vector<MapPoint>>& lines) {
  for_each_part(geometry, [&](const OGRGeometry& part) {
    const OGRwkbGeometryType type = wkbFlatten(part.getGeometryType());
    if (type == wkbLineString) {
      lines.push_back(points_of(*part.toLineString()));
    } else if (OGR_GT_IsSubClassOf(type, wkbCurve) != 0) {
      const std::unique_ptr<OGRGeometry> straight(part.getLinearGeometry());
      if (straight) add_lines(*straight, lines);
    }
  });
}

}  // namespace

void add_input_choice(ask::Parameters& rows, InputChoice& choice, std::string_view source,
                      const std::string& columns) {
  if (!columns.empty()) {
    rows.add("columns", &choice.columns, "NAME",
             "Text: the names of its columns from the left, " + columns +
                 " and any other name for one that is passed over")
        .values(1, ask::kAnyNumberOfValues)
        .needing(source)
        .split_at_commas();
  }
  rows.add("layer", &choice.layer, "NAME", "The layer, where several of a file would do")
      .needing(source);
  rows.add("id", &choice.id, "NAME",
           "The column or attribute that goes along into the answer as `id` (default: the first "
           "that is no coordinate)")
      .needing(source);
}

Asked<MapPoint> read_points(const std::string& path, const InputChoice& choice,
                            const TerrainPlane& plane) {
  if (is_text(path, choice)) {
    return read_text<MapPoint>(path, kPoint, choice, [](std::span<const double> n) {
      return MapPoint{n[0], n[1]};
    });
  }
  refuse_columns(path, choice);
  Asked<MapPoint> asked;
  FeatureIds ids(choice.id, path);
  const auto add_feature = [&](const OGRFeature& f) {
    const std::size_t before = asked.all.size();
    const auto add = [&](const OGRGeometry& part) {
      if (wkbFlatten(part.getGeometryType()) != wkbPoint) refuse_feature(f, "is no point", path);
      const MapPoint at{part.toPoint()->getX(), part.toPoint()->getY()};
      if (!std::isfinite(at.x) || !std::isfinite(at.y)) {
        refuse_feature(f, "has a coordinate that is not a finite number", path);
      }
      asked.all.push_back(at);
    };
    if (f.GetGeometryRef() != nullptr) for_each_part(*f.GetGeometryRef(), add);
    if (asked.all.size() == before) refuse_feature(f, "is no point", path);
    ids.note(f, asked);
  };
  for_each_feature(path, {LayerKind::kPoints, choice.layer}, plane, add_feature);
  return asked;
}

Asked<SightPair> read_pairs(const std::string& path, const InputChoice& choice,
                            const TerrainPlane& plane) {
  if (is_text(path, choice)) {
    return read_text<SightPair>(path, kPair, choice, [](std::span<const double> n) {
      return SightPair{{n[0], n[1]}, n[2], {n[3], n[4]}, n[5]};
    });
  }
  refuse_columns(path, choice);
  Asked<SightPair> asked;
  FeatureIds ids(choice.id, path);
  EndHeights end_heights;
  const auto add_feature = [&](const OGRFeature& f) {
    const auto add = [&](const OGRGeometry& part) {
      if (wkbFlatten(part.getGeometryType()) != wkbLineString ||
          part.toLineString()->getNumPoints() != 2) {
        refuse_feature(f, "is no line of two points, one at each end", path);
      }
      const std::vector<MapPoint> ends = points_of(*part.toLineString());
      const auto heights = end_heights.of(f, *part.toLineString());
      if (!heights) {
        refuse_feature(f, "has no heights; give its ends a z, or attributes h1 and h2", path);
      }
      asked.all.push_back({ends[0], (*heights)[0], ends[1], (*heights)[1]});
    };
    if (f.GetGeometryRef() != nullptr) for_each_part(*f.GetGeometryRef(), add);
    ids.note(f, asked);
  };
  // A line of sight is straight in the terrain's CRS, wherever its ends come from.
  for_each_feature(path, {LayerKind::kLines, choice.layer}, plane.with_corners_alone(),
                   add_feature);
  return asked;
}

void warn_of_empty_input(bool is_empty, const std::string& path, const std::string& what,
                         const Context& context) {
  if (!is_empty || context.quiet || context.json) return;
  std::fprintf(stderr,
               "ptin: warning: %s held no %s, so the answer is empty; expected a row or a feature "
               "for each\n",
               path == "-" ? "standard input" : path.c_str(), what.c_str());
}

Asked<std::vector<MapPoint>> read_lines(const std::string& text, const InputChoice& choice,
                                        const TerrainPlane& plane) {
  Asked<std::vector<MapPoint>> asked;
  FeatureIds ids(choice.id, text);
  const GeometrySource source{text,
                              {"LINESTRING", "MULTILINESTRING"},
                              "LINESTRING(x y, x y)",
                              {LayerKind::kLines, choice.layer}};
  const auto add = [&](const OGRGeometry& geometry, const OGRFeature* feature) {
    add_lines(geometry, asked.all);
    if (feature != nullptr) {
      ids.note(*feature, asked);
    } else if (!choice.layer.empty() || !choice.id.empty()) {
      throw Error(ErrorCode::invalid_argument,
                  "WKT has neither layers nor attributes; leave --layer and --id out");
    }
  };
  asked.transformed = read_geometries(source, plane, add);
  if (asked.all.empty()) {
    const std::string where = text.size() > 64 ? text.substr(0, 64) + "..." : text;
    throw Error(ErrorCode::invalid_argument, "holds no line", where);
  }
  return asked;
}

}  // namespace ptin::tools
