// SPDX-License-Identifier: GPL-3.0-or-later
//
// What a file is called, and who is to be named where it is shown.
#pragma once

#include <string>
#include <string_view>

#include <nlohmann/json_fwd.hpp>

#include "storage/store_file.h"

namespace ptin {

/// Texts for people; "" for none.
struct Credits {
  std::string title, attribution;
};

/// Whether a text may be one of Credits: UTF-8 of at most 1,000 bytes without control characters.
[[nodiscard]] bool is_credit(std::string_view text) noexcept;

/// A text among the options of the build in a store's metadata; empty where there is none. Whether a build writes it is not
/// looked at.
[[nodiscard]] std::string text_of_option(const nlohmann::json& metadata, const char* name);

/// Those that the metadata of a store hold (`options.title`, `options.attribution`). What no build
/// writes, since is_credit() is false of it, counts as none. Never throws for what a file says.
[[nodiscard]] Credits credits_of(const nlohmann::json& metadata);
/// @throws Error corruption as metadata_of()
[[nodiscard]] Credits credits_of(const StoreFile& store);

/// Adds the members `title` and `attribution` to an object: those that there are.
template <class Json>
void add_credits(Json& object, const Credits& credits) {
  if (!credits.title.empty()) object["title"] = credits.title;
  if (!credits.attribution.empty()) object["attribution"] = credits.attribution;
}

}  // namespace ptin
