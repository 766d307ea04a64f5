// SPDX-License-Identifier: GPL-3.0-or-later
#include <cmath>
#include <utility>

#include <nlohmann/json.hpp>

#include "engine/crs/crs_facts.h"
#include "engine/crs/ground.h"
#include "engine/error.h"

namespace ptin {

namespace {

/// The text under `key` of an object; empty when there is none.
std::string text_at(const nlohmann::json& object, const char* key) {
  const auto it = object.find(key);
  return it != object.end() && it->is_string() ? it->get<std::string>() : std::string();
}

/// Reads the members of facts; what is missing or of another kind makes all of them nothing.
class ToldFacts {
 public:
  explicit ToldFacts(const nlohmann::json& facts) : facts_(facts) {}

  [[nodiscard]] bool flag(const char* key) {
    const auto it = facts_.find(key);
    is_sound_ = is_sound_ && it != facts_.end() && it->is_boolean();
    return is_sound_ && it->get<bool>();
  }
  [[nodiscard]] std::string text(const char* key) {
    const auto it = facts_.find(key);
    is_sound_ = is_sound_ && it != facts_.end() && it->is_string();
    return is_sound_ ? it->get<std::string>() : std::string();
  }
  /// A finite number that is not negative.
  [[nodiscard]] double number(const char* key) {
    const auto it = facts_.find(key);
    is_sound_ = is_sound_ && it != facts_.end() && it->is_number();
    const double value = is_sound_ ? it->get<double>() : 0.0;
    is_sound_ = is_sound_ && std::isfinite(value) && value >= 0;
    return value;
  }
  [[nodiscard]] bool is_sound() const noexcept { return is_sound_; }

 private:
  const nlohmann::json& facts_;
  bool is_sound_ = true;
};

}  // namespace

nlohmann::json metadata_of(const StoreFile& store) {
  nlohmann::json json = nlohmann::json::parse(store.metadata_json(), nullptr, false);
  if (!json.is_object()) {
    throw Error(ErrorCode::corruption,
                "the metadata is not a JSON object; the file was not written by ptin build",
                store.path());
  }
  return json;
}

nlohmann::json json_of(const GroundFacts& ground) {
  nlohmann::json json = {{"geographic", ground.geographic},
                         {"semi_major", ground.semi_major},
                         {"inverse_flattening", ground.inverse_flattening},
                         {"metres_per_height", ground.metres_per_height}};
  if (ground.geographic) {
    json["radians_per_map_unit"] = ground.radians_per_map_unit;
  } else {
    json["metres_per_map_unit"] = ground.metres_per_map_unit;
  }
  return json;
}

nlohmann::json json_of(const CrsFacts& crs) {
  if (!crs.is_understood) return nullptr;
  return {{"name", crs.name},
          {"code", crs.code},
          {"north_first", crs.north_first},
          {"horizontal_unit", crs.horizontal_unit},
          {"third_axis", crs.has_third_axis},
          {"vertical_name", crs.vertical_name},
          {"vertical_code", crs.vertical_code},
          {"vertical_unit", crs.vertical_unit},
          {"ground", json_of(crs.ground)}};
}

std::optional<CrsFacts> crs_facts_told(const nlohmann::json& facts, std::string wkt) {
  if (!facts.is_object() || !facts.contains("ground") || !facts["ground"].is_object()) return {};
  CrsFacts crs;
  ToldFacts told(facts), of_ground(facts["ground"]);
  crs.wkt = std::move(wkt);
  crs.is_understood = true;
  crs.name = told.text("name");
  crs.code = told.text("code");
  crs.north_first = told.flag("north_first");
  crs.horizontal_unit = told.text("horizontal_unit");
  crs.has_third_axis = told.flag("third_axis");
  crs.vertical_name = told.text("vertical_name");
  crs.vertical_code = told.text("vertical_code");
  crs.vertical_unit = told.text("vertical_unit");
  GroundFacts& ground = crs.ground;
  ground.geographic = crs.geographic = of_ground.flag("geographic");
  ground.semi_major = of_ground.number("semi_major");
  ground.inverse_flattening = of_ground.number("inverse_flattening");
  ground.metres_per_height = of_ground.number("metres_per_height");
  (ground.geographic ? ground.radians_per_map_unit : ground.metres_per_map_unit) =
      of_ground.number(ground.geographic ? "radians_per_map_unit" : "metres_per_map_unit");
  const bool has_size =
      ground.semi_major > 0 &&
      (ground.geographic ? ground.radians_per_map_unit > 0 : ground.metres_per_map_unit > 0);
  return told.is_sound() && of_ground.is_sound() && has_size ? std::optional(crs) : std::nullopt;
}

CrsFacts crs_facts_of(const nlohmann::json& metadata) {
  const auto it = metadata.find("crs");
  const nlohmann::json crs = it != metadata.end() ? *it : nlohmann::json::object();
  std::string wkt = crs.is_string() ? crs.get<std::string>() : std::string();
  if (crs.is_object()) wkt = text_at(crs, "wkt");
  if (wkt.empty()) wkt = text_at(metadata, "crs_wkt");
  std::optional<CrsFacts> told;
  if (!wkt.empty() && crs.is_object() && crs.contains("facts")) {
    told = crs_facts_told(crs["facts"], wkt);
  }
  CrsFacts facts = told ? *std::move(told) : crs_facts(wkt);
  const nlohmann::json units = metadata.value("units", nlohmann::json::object());
  if (!units.is_object()) return facts;
  const std::string horizontal = text_at(units, "horizontal");
  const std::string vertical = text_at(units, "height");
  if (facts.horizontal_unit == "unknown" && !horizontal.empty()) facts.horizontal_unit = horizontal;
  if (facts.vertical_unit == "unknown" && !vertical.empty()) facts.vertical_unit = vertical;
  return facts;
}

CrsFacts crs_facts(const StoreFile& store) { return crs_facts_of(metadata_of(store)); }

}  // namespace ptin
