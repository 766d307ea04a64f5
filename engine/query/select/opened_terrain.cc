// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/query/select/opened_terrain.h"

#include <utility>

#include "engine/query/select/coarsest.h"

namespace ptin {

OpenedTerrain::OpenedTerrain(const std::string& path, PageAccess access, ReplacedFile replaced)
    : OpenedTerrain(StoreFile::open(path, access, nullptr, replaced)) {}

OpenedTerrain::OpenedTerrain(std::shared_ptr<const StoreFile> store)
    : store_(std::move(store)),
      t0_(std::make_shared<const Tin>(mesh_of(store_->t0(), store_->path()))) {}

void OpenedTerrain::use_index(std::shared_ptr<const RecordIndex> index) {
  index_ = std::move(index);
}

}  // namespace ptin
