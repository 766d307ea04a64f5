// SPDX-License-Identifier: GPL-3.0-or-later
//
// Why points of a source were left out, in words and in JSON.
#pragma once

#include <string>

#include <nlohmann/json_fwd.hpp>

#include "engine/construct/grid/left_out.h"

namespace ptin::tools {

/// "1,000 of another class, 54 outside of --bbox"; reasons that have no point are not told.
[[nodiscard]] std::string reasons_text(const LeftOutPoints& points);

/// tools/API.md, "JSON": `left_out` of `build`.
[[nodiscard]] nlohmann::json left_out_json(const LeftOutPoints& points);

}  // namespace ptin::tools
