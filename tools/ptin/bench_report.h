// SPDX-License-Identifier: GPL-3.0-or-later
//
// What `ptin bench` tells: tables for people, and JSON.
#pragma once

#include <string>

#include <nlohmann/json_fwd.hpp>

#include "tools/measure/io_report.h"

namespace ptin::tools {

/// The report as lines of at most 130 characters.
[[nodiscard]] std::string text_of(const IoRequest& request, const IoReport& report);

/// The report under the names of tools/API.md.
[[nodiscard]] nlohmann::json json_of(const IoRequest& request, const IoReport& report);

}  // namespace ptin::tools
