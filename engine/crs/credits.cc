// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/crs/credits.h"

#include <nlohmann/json.hpp>

#include "engine/crs/crs_facts.h"
#include "engine/utf8.h"

namespace ptin {

namespace {

constexpr std::size_t kMostBytesOfCredit = 1000;

}  // namespace

bool is_credit(std::string_view text) noexcept {
  return text.size() <= kMostBytesOfCredit && is_plain_text(text);
}

std::string text_of_option(const nlohmann::json& metadata, const char* name) {
  const auto options = metadata.find("options");
  if (options == metadata.end() || !options->is_object()) return {};
  const auto text = options->find(name);
  return text == options->end() || !text->is_string() ? std::string() : text->get<std::string>();
}

Credits credits_of(const nlohmann::json& metadata) {
  const auto credit_at = [&](const char* name) {
    std::string text = text_of_option(metadata, name);
    return is_credit(text) ? text : std::string();
  };
  return {credit_at("title"), credit_at("attribution")};
}

Credits credits_of(const StoreFile& store) { return credits_of(metadata_of(store)); }

}  // namespace ptin
