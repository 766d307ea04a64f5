// SPDX-License-Identifier: GPL-3.0-or-later
//
// A field of an answer: one row says what it is called, its type and unit, what it means and how its
// value is found. JSON, CSV, layers, GeoJSON, OpenAPI and the lists of tools/API.md read rows.
#pragma once

#include <algorithm>
#include <functional>
#include <initializer_list>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include "tools/ask/long_text.h"
#include "tools/ask/parameter.h"
#include "tools/formats/vector_file.h"

namespace ptin::ask {

/// What is made of a row: an object of JSON, a row of a table, a feature of a layer, whose geometry
/// has the position.
enum class As : std::uint8_t {
  kList = 0,  ///< None of these: documents alone tell it.
  kObject = 1,
  kTableRow = 2,
  kFeature = 4,
  kNoFeature = 3,
  kNoObject = 6,
  kAll = 7,
};

inline constexpr std::string_view kMapUnit = "map unit", kHeightUnit = "height's unit";

/// Where a field is told.
struct Told {
  Told() = default;
  Told(Door at) : doors(at) {}  // NOLINT(google-explicit-constructor): `add(..., Door::kProgram)`
  Told(As in) : as(in) {}       // NOLINT(google-explicit-constructor)
  Told(Door at, As in) : doors(at), as(in) {}

  Door doors = Door::kBoth;
  As as = As::kAll;  ///< It is part of these.
};

struct FieldFacts {
  std::string name;  ///< `a.b` is `b` of the object `a`, `a[].b` that of each object of an array.
  std::string_view type;  ///< As documents say it: "number or null", "array of objects".
  std::string_view unit;  ///< Empty: none.
  std::string_view meaning;
  std::string heading;  ///< The name in a table or a layer: of `a.b` a_b.
  Told told{};

  [[nodiscard]] bool is_told(Door door, As as) const noexcept {
    return is_at(told.doors, door) &&
           (static_cast<unsigned>(told.as) & static_cast<unsigned>(as)) != 0;
  }
};

inline const Json kLeftOut = Json::value_t::discarded;

/// A value as JSON; an optional without one, and a null pointer, are left out.
template <typename Value>
[[nodiscard]] Json json_of(const Value& value) {
  if constexpr (requires { value.has_value(); }) {
    return value ? Json(*value) : kLeftOut;
  } else if constexpr (std::is_pointer_v<Value> && !std::is_same_v<Value, const char*>) {
    return value == nullptr ? kLeftOut : Json(*value);
  } else {
    return Json(value);
  }
}

/// The field of a Row; a value that is discarded is left out.
template <typename Row>
struct Field {
  FieldFacts facts;
  std::function<Json(const Row& row)> value;
};

/// The fields of a Row, in the order of tables.
template <typename Row>
class Fields : public std::vector<Field<Row>> {
 public:
  /// Adds a field.
  /// @param value  A member of the row, or what finds the value in it.
  template <typename Value>
  Field<Row>& add(std::string name, std::string_view type, std::string_view unit,
                  std::string_view meaning, Value value, Told told = {}) {
    std::string heading = name;
    std::replace(heading.begin(), heading.end(), '.', '_');
    return this->emplace_back(
        Field<Row>{{std::move(name), type, unit, meaning, std::move(heading), told},
                   [value](const Row& row) { return json_of(std::invoke(value, row)); }});
  }

  /// Adds the fields of a part of the row.
  /// @param prefix  Of their names: "obstruction."
  /// @param part    A member of the row, or what finds a pointer to the part: null where the row has
  ///                none, and its fields are left out.
  template <typename Part, typename Find>
  void add_parts(const std::string& prefix, const Fields<Part>& parts, Find part) {
    std::string heading = prefix;
    std::replace(heading.begin(), heading.end(), '.', '_');
    for (const Field<Part>& field : parts) {
      const FieldFacts& facts = field.facts;
      const auto value = [part, value = field.value](const Row& row) {
        const Part* const found = pointer_to(std::invoke(part, row));
        return found == nullptr ? kLeftOut : value(*found);
      };
      add(prefix + facts.name, facts.type, facts.unit, facts.meaning, value, facts.told)
          .facts.heading = heading + facts.heading;
    }
  }
  /// Adds an object of JSON with these fields.
  /// @param type  "object or null": null where there is no such part; "object": left out there.
  template <typename Part, typename Find>
  void add_object(const std::string& name, std::string_view type, std::string_view meaning,
                  const Fields<Part>& parts, Find part) {
    add(
        name, type, "", meaning,
        [part, type](const Row& row) {
          if (pointer_to(std::invoke(part, row)) != nullptr) return Json(Json::object());
          return type == "object" ? kLeftOut : Json();
        },
        As::kObject);
    add_parts(name + ".", parts, part);
  }
  /// Adds an array of such objects.
  /// @param all  A member of the row, or what finds a pointer to a range of parts; null: it is left
  ///             out.
  template <typename Part, typename Find>
  void add_array(const std::string& name, std::string_view meaning, const Fields<Part>& parts,
                 Find all) {
    add(
        name, "array of objects", "", meaning,
        [parts, all](const Row& row) {
          Json array = Json::array();
          const auto* const found = pointer_to(std::invoke(all, row));
          if (found == nullptr) return kLeftOut;
          for (const Part& part : *found) array.push_back(object_of(parts, part));
          return array;
        },
        As::kObject);
    for (const Field<Part>& field : parts) {
      this->push_back({field.facts, {}});
      this->back().facts.name.insert(0, name + "[].");
      this->back().facts.told.as = As::kList;
    }
  }

  /// Has the fields from number `first` on told at one door alone.
  void tell_at(Door door, std::size_t first) {
    for (std::size_t i = first; i < this->size(); ++i) (*this)[i].facts.told.doors = door;
  }

  /// Those that are told.
  /// @param first  The headings of those that come first, where tables have had another order than
  ///               the rows.
  [[nodiscard]] Fields told(Door door, As as,
                            std::initializer_list<std::string_view> first = {}) const {
    Fields some;
    for (const Field<Row>& field : *this) {
      if (field.facts.is_told(door, as)) some.push_back(field);
    }
    const auto place = [&](const Field<Row>& field) {
      return std::find(first.begin(), first.end(), field.facts.heading);
    };
    std::stable_sort(some.begin(), some.end(),
                     [&](const auto& a, const auto& b) { return place(a) < place(b); });
    return some;
  }
  /// All but one, which no row has.
  [[nodiscard]] Fields without(std::string_view name) const {
    Fields others(*this);
    std::erase_if(others, [&](const Field<Row>& field) { return field.facts.name == name; });
    return others;
  }

 private:
  template <typename Part>
  static auto* pointer_to(const Part& part) {
    if constexpr (std::is_pointer_v<Part>) {
      return part;
    } else if constexpr (requires { part.has_value(); }) {
      return part ? &*part : nullptr;
    } else {
      return &part;
    }
  }
};

/// The place of `a.b` in an object.
[[nodiscard]] Json& member_of(Json& object, std::string_view name);

/// Adds fields of a row to an object of JSON.
template <typename Row>
void put(Json& object, const Fields<Row>& fields, const Row& row) {
  for (const Field<Row>& field : fields) {
    Json value = field.value(row);
    if (value.is_discarded()) continue;
    Json& member = member_of(object, field.facts.name);
    // An object whose members are fields of their own may have some already.
    if (!value.is_object() || !value.empty() || !member.is_object()) member = std::move(value);
  }
}
template <typename Row>
[[nodiscard]] Json object_of(const Fields<Row>& fields, const Row& row) {
  Json object = Json::object();
  put(object, fields, row);
  return object;
}

/// Adds a value of CSV; one that is null, infinite or left out is empty.
void add_csv_value(LongText& text, const Json& value);
/// Adds a table with a heading.
/// @param rows   How many there are.
/// @param row_at Makes a row by its number.
template <typename Row, typename RowAt>
void add_csv(LongText& text, const Fields<Row>& fields, std::size_t rows, const RowAt& row_at) {
  const auto add_line = [&](const auto& add) {
    for (const Field<Row>& field : fields) {
      if (&field != &fields.front()) text.add(",");
      add(field);
    }
    text.add("\n");
  };
  add_line([&](const Field<Row>& field) { text.add(field.facts.heading); });
  for (std::size_t i = 0; i < rows; ++i) {
    const Row& row = row_at(i);
    add_line([&](const Field<Row>& field) { add_csv_value(text, field.value(row)); });
  }
}

/// Adds an object of JSON, of fields whose names have no point.
template <typename Row>
void add_object(LongText& text, const Fields<Row>& fields, const Row& row) {
  char before = '{';
  for (const Field<Row>& field : fields) {
    const Json value = field.value(row);
    if (value.is_discarded()) continue;
    text.add({&before, 1}).add("\"").add(field.facts.name).add("\":").json(value);
    before = ',';
  }
  text.add(before == '{' ? "{}" : "}");
}

/// Fields of a layer, and the values of one of its features.
[[nodiscard]] tools::VectorFile::Field layer_field_of(const FieldFacts& facts);
[[nodiscard]] tools::VectorFile::Value layer_value_of(const Json& value);
template <typename Row>
[[nodiscard]] std::vector<tools::VectorFile::Field> layer_fields_of(const Fields<Row>& fields) {
  std::vector<tools::VectorFile::Field> all;
  for (const Field<Row>& field : fields) all.push_back(layer_field_of(field.facts));
  return all;
}
template <typename Row>
[[nodiscard]] std::vector<tools::VectorFile::Value> layer_values_of(const Fields<Row>& fields,
                                                                    const Row& row) {
  std::vector<tools::VectorFile::Value> values;
  for (const Field<Row>& field : fields) values.push_back(layer_value_of(field.value(row)));
  return values;
}

/// The facts of what a door tells, for documents.
template <typename Row>
[[nodiscard]] std::vector<FieldFacts> documented(const Fields<Row>& fields, Door door, As as,
                                                 const std::string& prefix = {}) {
  std::vector<FieldFacts> all;
  for (const Field<Row>& field : fields) {
    const bool is_listed = as == As::kObject && field.facts.told.as == As::kList;
    if (!field.facts.is_told(door, as) && !(is_listed && is_at(field.facts.told.doors, door)))
      continue;
    all.push_back(field.facts);
    all.back().name.insert(0, prefix);
  }
  return all;
}

}  // namespace ptin::ask
