// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/query/voids.h"

#include <algorithm>
#include <cmath>

#include <nlohmann/json.hpp>

namespace ptin {

namespace {

/// What the builder counted, null where it said nothing.
nlohmann::json told_by_builder(const StoreFile& store) {
  const auto json = nlohmann::json::parse(store.metadata_json(), nullptr, false);
  const auto source = json.is_object() ? json.find("source") : json.end();
  if (json.is_object() && source != json.end() && source->is_object()) {
    return source->value("voids", nlohmann::json());
  }
  return nullptr;
}

/// Every point of the grid within the bounds is a vertex.
bool is_full_raster(const StoreFile& store) {
  const GridBox& b = store.facts().bounds;
  const std::uint64_t full = (static_cast<std::uint64_t>(b.max_x - b.min_x) + 1) *
                             (static_cast<std::uint64_t>(b.max_y - b.min_y) + 1);
  return store.facts().source_samples == full &&
         store.t0().vertices.size() + store.record_count() == full;
}

bool shows_voids(const StoreFile& store) {
  const CoarsestTin& t0 = store.t0();
  return std::any_of(t0.vertices.begin(), t0.vertices.end(),
                     [](const auto& v) { return v.has_height == 0; }) ||
         std::any_of(t0.triangles.begin(), t0.triangles.end(),
                     [](const auto& t) { return t.is_void != 0; }) ||
         std::any_of(store.error_bins().begin(), store.error_bins().end(), [](const auto& bin) {
           return bin.void_vertices > 0 || (std::isinf(bin.upper) && bin.records > 0);
         });
}

}  // namespace

bool may_have_voids(const StoreFile& store) {
  if (shows_voids(store)) {
    return true;
  }
  const nlohmann::json told = told_by_builder(store);
  return told.is_boolean() ? told.get<bool>() : !is_full_raster(store);
}

}  // namespace ptin
