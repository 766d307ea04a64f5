// SPDX-License-Identifier: GPL-3.0-or-later
//
// A field of an answer: one row says what it is called, its type and unit, what it means and how its
// value is found. JSON, CSV, layers, GeoJSON, OpenAPI and the lists of tools/API.md read rows.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include "tools/ask/long_text.h"
#include "tools/formats/vector_file.h"

namespace ptin::ask {

/// Where a field is told: on the command line or over HTTP; in an object of JSON, in a row of a table,
/// in a feature of a layer, whose geometry has the position.
enum class Told : std::uint8_t {
  kProgram = 0x0f,
  kService = 0xf0,
  kObject = 0x11,
  kTableRow = 0x22,
  kFeature = 0x44,
  kNoObject = 0x66,
  kNoTableRow = 0x55,
  kNoFeature = 0x33,
  kAll = 0x77,
  kList = 0x88,      ///< Documents alone tell it: a field of the objects of an array.
  kDocument = 0x99,  ///< What documents tell of objects.
};
[[nodiscard]] constexpr Told operator&(Told a, Told b) noexcept {
  return static_cast<Told>(static_cast<unsigned>(a) & static_cast<unsigned>(b));
}
[[nodiscard]] constexpr Told operator|(Told a, Told b) noexcept {
  return static_cast<Told>(static_cast<unsigned>(a) | static_cast<unsigned>(b));
}

inline constexpr std::string_view kMapUnit = "map unit", kHeightUnit = "height's unit";

struct Field {
  std::string name;  ///< `a.b` is `b` of the object `a`, `a[].b` that of each object of an array.
  std::string_view type;  ///< As documents say it: "number or null", "array of objects".
  std::string_view unit;  ///< Empty: none.
  std::string_view meaning;
  Told told = Told::kAll;
  /// Finds the value in a row of the answer; a value that is discarded is left out.
  std::function<Json(const void* row)> value{};

  /// The name in a table or a layer: of `a.b` a_b.
  [[nodiscard]] std::string heading() const;
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

/// Adds values of fields to an object of JSON.
void put(Json& object, std::span<const Field> fields, std::vector<Json> values);

/// The fields of a Row, in the order of tables.
template <typename Row>
class Fields : public std::vector<Field> {
 public:
  /// Where the fields are told that are added from now on, beside what each says of itself.
  Told next = Told::kAll | Told::kList;

  /// Adds a field.
  /// @param value  A member of the row, or what finds the value in it.
  template <typename Value>
  void add(std::string name, std::string_view type, std::string_view unit, std::string_view meaning,
           Told told, Value value) {
    push_back({std::move(name), type, unit, meaning, told & next, [value](const void* row) {
                 return json_of(std::invoke(value, *static_cast<const Row*>(row)));
               }});
  }
  template <typename Value>
  void add(std::string name, std::string_view type, std::string_view unit, std::string_view meaning,
           Value value) {
    add(std::move(name), type, unit, meaning, Told::kAll, std::move(value));
  }
  /// Adds the fields of a part of the row.
  /// @param prefix  Of their names: "obstruction."
  /// @param part    A member of the row, or what finds a pointer to the part: null where the row has
  ///                none, and its fields are left out.
  template <typename Part, typename Find>
  void add_parts(const std::string& prefix, const Fields<Part>& parts, Find part) {
    for (Field field : parts) {
      field.name.insert(0, prefix);
      field.told = field.told & next;
      field.value = [part, value = field.value](const void* row) {
        const Part* const found = found_in(row, part);
        return found == nullptr ? kLeftOut : value(found);
      };
      push_back(std::move(field));
    }
  }
  /// Adds an object of JSON with these fields.
  /// @param type  "object or null": null where there is no such part; "object": left out there.
  template <typename Part, typename Find>
  void add_object(const std::string& name, std::string_view type, std::string_view meaning,
                  const Fields<Part>& parts, Find part) {
    add(name, type, "", meaning, Told::kObject, [part, type](const Row& row) {
      if (found_in(&row, part) != nullptr) return Json(Json::object());
      return type == "object" ? kLeftOut : Json();
    });
    add_parts(name + ".", parts, part);
  }
  /// Adds an array of such objects.
  /// @param all  A member of the row, or what finds a pointer to a range of parts; null: it is left
  ///             out.
  template <typename Part, typename Find>
  void add_array(const std::string& name, std::string_view meaning, const Fields<Part>& parts,
                 Find all) {
    add(name, "array of objects", "", meaning, Told::kObject, [parts, all](const Row& row) {
      const auto* const found = found_in(&row, all);
      if (found == nullptr) return kLeftOut;
      Json array = Json::array();
      for (const Part& part : *found) array.push_back(parts.object_of(part));
      return array;
    });
    for (const Field& field : parts) {
      Told doors{};  // Where the parts have the field, in whatever form.
      for (const Told door : {Told::kProgram, Told::kService}) {
        if ((field.told & door) != Told{}) doors = doors | door;
      }
      push_back({name + "[]." + field.name, field.type, field.unit, field.meaning,
                 Told::kList & doors & next});
    }
  }

  /// Those that are told somewhere.
  [[nodiscard]] Fields told(Told where) const {
    Fields some(*this);
    std::erase_if(some, [&](const Field& f) { return (f.told & where) == Told{}; });
    return some;
  }
  /// All but one, which no row has.
  [[nodiscard]] Fields without(std::string_view name) const {
    Fields others(*this);
    std::erase_if(others, [&](const Field& field) { return field.name == name; });
    return others;
  }
  /// The values of a row.
  [[nodiscard]] std::vector<Json> values_of(const Row& row) const {
    std::vector<Json> values;
    for (const Field& field : *this) values.push_back(field.value(&row));
    return values;
  }
  [[nodiscard]] Json object_of(const Row& row) const {
    Json object = Json::object();
    put(object, *this, values_of(row));
    return object;
  }

 private:
  template <typename Find>
  static auto* found_in(const void* row, const Find& find) {
    const auto& part = std::invoke(find, *static_cast<const Row*>(row));
    if constexpr (std::is_pointer_v<std::decay_t<decltype(part)>>) {
      return part;
    } else if constexpr (requires { part.has_value(); }) {
      return part ? &*part : nullptr;
    } else {
      return &part;
    }
  }
};

/// Adds a value as CSV has it: nothing for one that is null, infinite or left out.
void add_csv_value(LongText& text, const Json& value);
/// Adds a table with a heading.
/// @param rows   How many there are.
/// @param row_at Makes a row by its number.
template <typename Row, typename RowAt>
void add_csv(LongText& text, const Fields<Row>& fields, std::size_t rows, const RowAt& row_at) {
  // One value at a time: a list of values for each of a million rows is a third of their time.
  const auto add_line = [&](const auto& value_of) {
    for (const Field& field : fields) {
      if (&field != &fields.front()) text.add(",");
      add_csv_value(text, value_of(field));
    }
    text.add("\n");
  };
  add_line([](const Field& field) { return Json(field.heading()); });
  for (std::size_t i = 0; i < rows; ++i) {
    const Row& row = row_at(i);
    add_line([&row](const Field& field) { return field.value(&row); });
  }
}

/// Adds an object of JSON, of fields whose names have no point.
void add_object(LongText& text, std::span<const Field> fields, std::span<const Json> values);

/// Fields of a layer, and the values of one of its features.
[[nodiscard]] std::vector<tools::VectorFile::Field> layer_fields_of(std::span<const Field> fields);
[[nodiscard]] std::vector<tools::VectorFile::Value> layer_values_of(std::span<const Json> values);

}  // namespace ptin::ask
