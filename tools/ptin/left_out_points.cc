// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/ptin/left_out_points.h"

#include <array>

#include <nlohmann/json.hpp>

#include "tools/facts/human.h"

namespace ptin::tools {

namespace {

struct Words {
  LeftOutReason reason;
  const char* name;  ///< In JSON.
  const char* text;
};

constexpr std::array<Words, LeftOutPoints::kReasons> kWords = {{
    {LeftOutReason::kInvalid, "invalid", "in rows that are no points"},
    {LeftOutReason::kWithheld, "withheld", "withheld"},
    {LeftOutReason::kClass, "class", "of another class"},
    {LeftOutReason::kReturn, "return", "of another return"},
    {LeftOutReason::kNoHeight, "no_height", "without a height"},
    {LeftOutReason::kNodata, "nodata", "with the height of --nodata"},
    {LeftOutReason::kBounds, "bbox", "outside of --bbox"},
    {LeftOutReason::kBoundary, "boundary", "outside of --boundary"},
    {LeftOutReason::kNoTriangle, "no_triangle", "in no triangle"},
}};

}  // namespace

std::string reasons_text(const LeftOutPoints& points) {
  std::string text;
  for (const Words& w : kWords) {
    if (points.of(w.reason) == 0) continue;
    text.append(text.empty() ? "" : ", ").append(grouped(points.of(w.reason)));
    text.append(" ").append(w.text);
  }
  return text;
}

nlohmann::json left_out_json(const LeftOutPoints& points) {
  nlohmann::json json = nlohmann::json::object();
  for (const Words& w : kWords) json[w.name] = points.of(w.reason);
  return json;
}

}  // namespace ptin::tools
