// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/serve/catalogue.h"

#include <algorithm>
#include <cctype>
#include <chrono>
#include <utility>

#include <sys/stat.h>

#include "engine/error.h"
#include "engine/remote/remote_file.h"
#include "tools/http/etag.h"
#include "tools/serve/places.h"

namespace ptin::serve {

namespace {

/// Between two tries to open a file that was refused for a reason that may pass.
constexpr std::chrono::seconds kBetweenTries{1};

bool is_name(const std::string& id) {
  const auto is_plain = [](unsigned char c) {
    return std::isalnum(c) != 0 || c == '-' || c == '_' || c == '.';
  };
  return !id.empty() && id.front() != '.' && id.size() <= 64 &&
         std::all_of(id.begin(), id.end(), is_plain);
}

Terrain opened(const std::string& path) {
  return is_remote(path) ? Terrain(open_remote_store(path))
                         : Terrain::open(path, PageAccess::kMapped, ReplacedFile::kAnswers);
}

/// Whether an object elsewhere was found to be another one than that which was opened.
bool was_replaced(const StoreFile& store) {
  if (!store.remote_cost()) return false;
  try {
    store.pages().check_unchanged();
    return false;
  } catch (const Error&) {
    return true;
  }
}

/// Whether trying again gives nothing else.
bool is_damaged(const std::exception& error) {
  const auto* const known = dynamic_cast<const Error*>(&error);
  return known != nullptr && (known->code() == ErrorCode::corruption ||
                              known->code() == ErrorCode::invalid_argument ||  // no store at all
                              known->code() == ErrorCode::unsupported_version);
}

}  // namespace

std::string version_of(const Collection& collection, const std::string& program) {
  return collection.fingerprint + "-" + program;
}

std::optional<FileIdentity> identity_of(const std::string& path) {
  // An object elsewhere is not asked for its name's sake: its answers tell when it is another one.
  if (is_remote(path)) return FileIdentity{};
  struct stat facts {};
  if (::stat(path.c_str(), &facts) != 0) return std::nullopt;
  return FileIdentity{facts.st_dev, facts.st_ino, static_cast<std::uint64_t>(facts.st_size),
                      facts.st_mtim.tv_sec, facts.st_mtim.tv_nsec};
}

Collection::Collection(std::string name, const std::string& path)
    : id(std::move(name)),
      identity(identity_of(path).value_or(FileIdentity{})),
      terrain(opened(path)),
      crs(crs_facts(terrain.store())),
      credits(credits_of(terrain.store())),
      base_map(ptin::base_map_of(terrain.store())),
      ground(ground_of(crs)),
      fingerprint(http::hex_of(terrain.store().fingerprint())) {
  const StoreFacts& facts = terrain.store().facts();
  const MapPoint a = facts.map.to_map(facts.bounds.min_x, facts.bounds.min_y);
  const MapPoint b = facts.map.to_map(facts.bounds.max_x, facts.bounds.max_y);
  bounds = {std::min(a.x, b.x), std::min(a.y, b.y), std::max(a.x, b.x), std::max(a.y, b.y)};
  lon_lat = lon_lat_of(bounds, crs);
  degree_nodes = lon_lat_nodes(bounds, crs);
}

const BaseMap& base_map_of(const ServeOptions& options, const Collection& collection) noexcept {
  return options.base_map ? *options.base_map : collection.base_map;
}

void check_collection_name(const std::string& name, const std::string& where) {
  if (is_name(name)) return;
  refuse("\"" + name +
             "\" cannot be the name of a collection: give one of letters, digits, -, _ and . as "
             "NAME=FILE",
         where);
}

Catalogue::Catalogue(const std::vector<ServedFile>& files, Warn warn)
    : warn_(std::move(warn)),
      entries_(std::make_shared<const Entries>(opened_entries(files, {}))) {}

Catalogue::Entries Catalogue::opened_entries(const std::vector<ServedFile>& files,
                                             const Entries& known) {
  Entries entries;
  for (const ServedFile& file : files) {
    check_collection_name(file.id, file.path);
    const auto before = known.find(file.id);
    std::shared_ptr<Entry> entry;
    if (before != known.end() && before->second->path == file.path) {
      entry = before->second;
    } else {
      entry = std::make_shared<Entry>();
      entry->path = file.path;
      entry->open = std::make_shared<Collection>(file.id, file.path);
    }
    if (!entries.emplace(file.id, std::move(entry)).second) {
      refuse("two files have the name \"" + file.id + "\"; give another one as NAME=FILE",
             file.path);
    }
  }
  return entries;
}

void Catalogue::replace(const std::vector<ServedFile>& files) {
  auto made = std::make_shared<const Entries>(opened_entries(files, *entries()));
  const std::scoped_lock lock(mutex_);
  entries_ = std::move(made);
}

std::shared_ptr<const Collection> Catalogue::find(const std::string& id) const {
  const auto known = entries();
  const auto found = known->find(id);
  return found == known->end() ? nullptr : current(id, *found->second);
}

std::vector<std::string> Catalogue::damaged() const {
  std::vector<std::string> names;
  const auto known = entries();
  for (const auto& [id, entry] : *known) {
    if (entry->is_damaged || entry->has_bad_pages) names.push_back(id);
  }
  return names;
}

void Catalogue::note_damage(const Collection& collection) const {
  const auto known = entries();
  const auto found = known->find(collection.id);
  if (found == known->end()) return;
  const std::lock_guard lock(found->second->mutex);
  if (found->second->open.get() == &collection) found->second->has_bad_pages = true;
}

void Catalogue::check_whole(const std::string& id) const {
  const auto known = entries();
  const auto found = known->find(id);
  if (found == known->end()) return;
  if (!found->second->is_damaged && !found->second->has_bad_pages) return;
  throw Error(ErrorCode::corruption, "the file was written over while it was served",
              found->second->path);
}

std::vector<std::shared_ptr<const Collection>> Catalogue::all() const {
  std::vector<std::shared_ptr<const Collection>> all;
  const auto known = entries();
  for (const auto& [id, entry] : *known) all.push_back(current(id, *entry));
  return all;
}

std::shared_ptr<const Collection> Catalogue::current(const std::string& id, Entry& entry) const {
  const std::optional<FileIdentity> now = identity_of(entry.path);
  const std::lock_guard lock(entry.mutex);
  const FileIdentity seen = now.value_or(FileIdentity{});
  if (now && seen == entry.open->identity && !was_replaced(entry.open->terrain.store())) {
    entry.is_stale = false;
    entry.is_damaged = false;
    return entry.open;
  }
  const bool is_known = entry.is_stale && seen == entry.refused;
  if (is_known && std::chrono::steady_clock::now() < entry.next_try) return entry.open;
  entry.refused = seen;
  entry.is_stale = true;
  entry.next_try = std::chrono::steady_clock::now() + kBetweenTries;
  if (!now) {
    if (!is_known) warn_(id, "the file is gone; the one that was open goes on answering");
    return entry.open;
  }
  try {
    entry.open = std::make_shared<Collection>(id, entry.path);
    entry.is_stale = false;
    entry.is_damaged = false;
    entry.has_bad_pages = false;
  } catch (const std::exception& error) {
    if (is_damaged(error) && !is_remote(entry.path))
      entry.next_try = std::chrono::steady_clock::time_point::max();
    // A file that took its place leaves the old one whole; bytes that were written into it do not.
    entry.is_damaged =
        seen.device == entry.open->identity.device && seen.inode == entry.open->identity.inode;
    if (is_known) return entry.open;
    warn_(id, std::string("the file that took its place cannot be opened: ") + error.what());
  }
  return entry.open;
}

}  // namespace ptin::serve
