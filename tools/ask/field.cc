// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/ask/field.h"

#include <cmath>

#include "tools/formats/csv_text.h"

namespace ptin::ask {

Json& member_of(Json& object, std::string_view name) {
  const std::size_t point = name.find('.');
  Json& member = object[std::string(name.substr(0, point))];
  return point == std::string_view::npos ? member : member_of(member, name.substr(point + 1));
}

void add_csv_value(LongText& text, const Json& value) {
  if (value.is_string()) {
    std::string field;
    tools::append_csv_field(field, value.get_ref<const std::string&>());
    text.add(field);
  } else if (value.is_boolean()) {
    text.add(value.get<bool>() ? "1" : "0");
  } else if (value.is_number_float()) {
    if (std::isfinite(value.get<double>())) text.number(value.get<double>());
  } else if (value.is_number()) {
    text.json(value);
  }
}

tools::VectorFile::Field layer_field_of(const FieldFacts& facts) {
  using Type = tools::VectorFile::FieldType;
  const Type type = facts.type.starts_with("number")    ? Type::kReal
                    : facts.type.starts_with("integer") ? Type::kInteger
                    : facts.type.starts_with("boolean") ? Type::kBoolean
                    : facts.type.starts_with("flag")    ? Type::kFlag
                                                        : Type::kText;
  return {facts.heading, type};
}

tools::VectorFile::Value layer_value_of(const Json& value) {
  if (value.is_string()) return value.get<std::string>();
  if (value.is_boolean()) return std::int64_t{value.get<bool>() ? 1 : 0};
  if (value.is_number_integer()) return value.get<std::int64_t>();
  return value.is_number() ? value.get<double>() : std::nan("");
}

}  // namespace ptin::ask
