// SPDX-License-Identifier: GPL-3.0-or-later
//
// Reasons why an unfinished build cannot be gone on with: it was begun with something else.
#pragma once

#include <string>

#include <nlohmann/json_fwd.hpp>

namespace ptin {

/// "--max-error was 5 and is 2; /data/dem.tif had 100 bytes and has 120": up to six differences, the
/// version first. Both are what fingerprint() in build_job.cc makes, read back; anything else is
/// named as another version.
/// REQUIRES: they differ.
[[nodiscard]] std::string what_differs(const nlohmann::json& begun_with, const nlohmann::json& now);

}  // namespace ptin
