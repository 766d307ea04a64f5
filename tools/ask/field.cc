// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/ask/field.h"

#include <algorithm>
#include <cmath>

namespace ptin::ask {

namespace {

/// The place of `a.b` in an object.
Json& member_of(Json& object, std::string_view name) {
  const std::size_t point = name.find('.');
  Json& member = object[std::string(name.substr(0, point))];
  return point == std::string_view::npos ? member : member_of(member, name.substr(point + 1));
}

}  // namespace

void add_csv_value(LongText& text, const Json& value) {
  if (value.is_string()) {
    const auto& field = value.get_ref<const std::string&>();
    // By RFC 4180, where it needs quotes to be read back as it is.
    const bool is_quoted = field.find_first_of(",;\"\r\n\t") != std::string::npos ||
                           field.starts_with('#') || field.starts_with(' ') || field.ends_with(' ');
    if (!is_quoted) {
      text.add(field);
      return;
    }
    std::string quoted = "\"";
    for (const char c : field) quoted.append(c == '"' ? 2 : 1, c);
    text.add(quoted + "\"");
  } else if (value.is_boolean()) {
    text.add(value.get<bool>() ? "1" : "0");
  } else if (value.is_number_float()) {
    if (const double number = value.get<double>(); std::isfinite(number)) text.number(number);
  } else if (value.is_number()) {
    text.json(value);
  }
}

std::string Field::heading() const {
  std::string heading = name;
  std::replace(heading.begin(), heading.end(), '.', '_');
  return heading;
}

void put(Json& object, std::span<const Field> fields, std::vector<Json> values) {
  for (std::size_t i = 0; i < fields.size(); ++i) {
    if (values[i].is_discarded()) continue;
    Json& member = member_of(object, fields[i].name);
    // An object whose members are fields of their own may have some already.
    const bool is_begun = member.is_object() && values[i].is_object() && values[i].empty();
    if (!is_begun) member = std::move(values[i]);
  }
}

void add_object(LongText& text, std::span<const Field> fields, std::span<const Json> values) {
  char before = '{';
  for (std::size_t i = 0; i < fields.size(); ++i) {
    if (values[i].is_discarded()) continue;
    text.add({&before, 1}).add("\"").add(fields[i].name).add("\":").json(values[i]);
    before = ',';
  }
  text.add(before == '{' ? "{}" : "}");
}

std::vector<tools::VectorFile::Field> layer_fields_of(std::span<const Field> fields) {
  using Type = tools::VectorFile::FieldType;
  std::vector<tools::VectorFile::Field> all;
  for (const Field& field : fields) {
    all.push_back({field.heading(), field.type.starts_with("number")    ? Type::kReal
                                    : field.type.starts_with("integer") ? Type::kInteger
                                    : field.type.starts_with("boolean") ? Type::kBoolean
                                    : field.type.starts_with("flag")    ? Type::kFlag
                                                                        : Type::kText});
  }
  return all;
}

std::vector<tools::VectorFile::Value> layer_values_of(std::span<const Json> values) {
  std::vector<tools::VectorFile::Value> all;
  for (const Json& value : values) {
    if (value.is_string()) {
      all.emplace_back(value.get<std::string>());
    } else if (value.is_boolean()) {
      all.emplace_back(std::int64_t{value.get<bool>() ? 1 : 0});
    } else if (value.is_number_integer()) {
      all.emplace_back(value.get<std::int64_t>());
    } else {
      all.emplace_back(value.is_number() ? value.get<double>() : std::nan(""));
    }
  }
  return all;
}

}  // namespace ptin::ask
