// SPDX-License-Identifier: GPL-3.0-or-later
//
// A field of an answer: one row says what it is called, its type and unit, what it means and how its
// value is found. JSON, CSV, layers, GeoJSON, OpenAPI and the lists of tools/API.md read rows.
#pragma once

#include <algorithm>
#include <initializer_list>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "tools/ask/long_text.h"
#include "tools/ask/parameter.h"
#include "tools/formats/vector_file.h"

namespace ptin::ask {

/// What is made of a row: an object of JSON, a row of a table, a feature of a layer, whose geometry
/// has the position.
enum class As : std::uint8_t {
  kObject = 1,
  kTableRow = 2,
  kFeature = 4,
  kNoFeature = 3,
  kNoObject = 6,
  kAll = 7,
};
[[nodiscard]] constexpr bool is_in(As all, As as) noexcept {
  return (static_cast<unsigned>(all) & static_cast<unsigned>(as)) != 0;
}

struct FieldFacts {
  std::string_view name;  ///< `a.b` is `b` of the object `a`.
  std::string_view type;  ///< As documents say it: "number or null", "array of objects".
  std::string_view unit;  ///< "height's unit"; empty: none.
  std::string_view meaning;
  Door doors = Door::kBoth;
  As as = As::kAll;  ///< It is part of these.
};

/// The field of a Row; a value that is discarded is left out.
template <typename Row>
struct Field {
  FieldFacts facts;
  Json (*value)(const Row& row);
};
/// The fields of a Row, in the order of tables.
template <typename Row>
using Fields = std::vector<Field<Row>>;
inline const Json kLeftOut = Json::value_t::discarded;

/// The place of `a.b` in an object.
[[nodiscard]] Json& member_of(Json& object, std::string_view name);

/// Adds the fields of a row to an object of JSON.
template <typename Row>
void put(Json& object, const Fields<Row>& fields, const Row& row, Door door) {
  for (const Field<Row>& field : fields) {
    if (!is_at(field.facts.doors, door) || !is_in(field.facts.as, As::kObject)) continue;
    Json value = field.value(row);
    if (!value.is_discarded()) member_of(object, field.facts.name) = std::move(value);
  }
}
template <typename Row>
[[nodiscard]] Json object_of(const Fields<Row>& fields, const Row& row, Door door) {
  Json object = Json::object();
  put(object, fields, row, door);
  return object;
}

template <typename Row>
using Columns = std::vector<const Field<Row>*>;
/// The fields that a door tells of a row.
/// @param first  The names of those that come first, where tables have had another order than the rows.
template <typename Row>
[[nodiscard]] Columns<Row> columns_of(const Fields<Row>& fields, Door door, As as,
                                      std::initializer_list<std::string_view> first = {}) {
  Columns<Row> columns;
  for (const Field<Row>& field : fields) {
    if (is_in(field.facts.as, as) && is_at(field.facts.doors, door)) columns.push_back(&field);
  }
  const auto place = [&](const Field<Row>* column) {
    return std::find(first.begin(), first.end(), column->facts.name);
  };
  std::stable_sort(columns.begin(), columns.end(),
                   [&](const auto* a, const auto* b) { return place(a) < place(b); });
  return columns;
}
/// The columns but for one, which no row has.
template <typename Row>
[[nodiscard]] Columns<Row> without(Columns<Row> columns, std::string_view name) {
  std::erase_if(columns, [&](const Field<Row>* column) { return column->facts.name == name; });
  return columns;
}

/// The heading of a table: `a.b` is a_b there.
[[nodiscard]] std::string heading_of(const FieldFacts& facts);
/// Adds a field of CSV; a value that is null, infinite or left out is empty.
void add_csv_value(LongText& text, const Json& value);

template <typename Row>
void add_csv_heading(LongText& text, const Columns<Row>& columns) {
  for (const Field<Row>* column : columns) {
    text.add(column == columns.front() ? "" : ",").add(heading_of(column->facts));
  }
  text.add("\n");
}
template <typename Row>
void add_csv_row(LongText& text, const Columns<Row>& columns, const Row& row) {
  for (const Field<Row>* column : columns) {
    if (column != columns.front()) text.add(",");
    add_csv_value(text, column->value(row));
  }
  text.add("\n");
}

/// Adds an object of JSON, of fields whose names have no point.
template <typename Row>
void add_object(LongText& text, const Columns<Row>& columns, const Row& row) {
  char before = '{';
  for (const Field<Row>* column : columns) {
    const Json value = column->value(row);
    if (value.is_discarded()) continue;
    text.add({&before, 1}).add("\"").add(column->facts.name).add("\":").json(value);
    before = ',';
  }
  text.add(before == '{' ? "{}" : "}");
}
/// Adds the members of an object behind others: `,"a":1`.
void add_members(LongText& text, const Json& object);

/// The fields of a layer, and the values of one of its features.
[[nodiscard]] tools::VectorFile::Field layer_field_of(const FieldFacts& facts);
[[nodiscard]] tools::VectorFile::Value layer_value_of(const Json& value);
template <typename Row>
[[nodiscard]] std::vector<tools::VectorFile::Field> layer_fields_of(const Columns<Row>& columns) {
  std::vector<tools::VectorFile::Field> fields;
  for (const Field<Row>* column : columns) fields.push_back(layer_field_of(column->facts));
  return fields;
}
template <typename Row>
[[nodiscard]] std::vector<tools::VectorFile::Value> layer_values_of(const Columns<Row>& columns,
                                                                    const Row& row) {
  std::vector<tools::VectorFile::Value> values;
  for (const Field<Row>* column : columns) values.push_back(layer_value_of(column->value(row)));
  return values;
}

/// The facts of fields, their names behind `prefix`.
struct NamedField {
  std::string name;
  FieldFacts facts;
};
template <typename Row>
void list(std::vector<NamedField>& all, const Fields<Row>& fields, const std::string& prefix = {}) {
  for (const Field<Row>& field : fields) {
    all.push_back({prefix + std::string(field.facts.name), field.facts});
  }
}

}  // namespace ptin::ask
