// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/crs/credits.h"

#include <nlohmann/json.hpp>

#include "engine/crs/crs_facts.h"
#include "engine/utf8.h"

namespace ptin {

namespace {

constexpr std::size_t kMostBytesOfCredit = 1000;

/// The text of an option of the build; empty where it has none that counts.
std::string credit_at(const nlohmann::json& metadata, const char* name) {
  const auto options = metadata.find("options");
  if (options == metadata.end() || !options->is_object()) return {};
  const auto text = options->find(name);
  if (text == options->end() || !text->is_string()) return {};
  const auto& told = text->get_ref<const std::string&>();
  return is_credit(told) ? told : std::string();
}

}  // namespace

bool is_credit(std::string_view text) noexcept {
  return text.size() <= kMostBytesOfCredit && is_plain_text(text);
}

Credits credits_of(const nlohmann::json& metadata) {
  return {credit_at(metadata, "title"), credit_at(metadata, "attribution")};
}

Credits credits_of(const StoreFile& store) { return credits_of(metadata_of(store)); }

}  // namespace ptin
