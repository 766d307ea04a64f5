// SPDX-License-Identifier: GPL-3.0-or-later
//
// The files that a service answers from, each under a name. No path ever comes from a client.
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "engine/crs/base_map.h"
#include "engine/crs/credits.h"
#include "engine/crs/crs_facts.h"
#include "engine/crs/ground.h"
#include "engine/query/questions.h"
#include "tools/serve/lon_lat_nodes.h"
#include "tools/serve/serve_options.h"
#include "tools/serve/tile_sets.h"

namespace ptin::serve {

/// Which file stands under a path: it changes when the file is replaced, or written to.
struct FileIdentity {
  std::uint64_t device = 0, inode = 0, bytes = 0;
  std::int64_t seconds = 0, nanoseconds = 0;  ///< When it last changed.
  friend bool operator==(const FileIdentity&, const FileIdentity&) = default;
};

/// One file, opened. Immutable, shared by the questions in flight; it lives as long as one of them,
/// also when another file has taken its place.
struct Collection {
  Collection(std::string name, const std::string& path);

  std::string id;
  /// What stood under the path before the file was opened: where another file took its place
  /// meanwhile, that is seen the next time.
  FileIdentity identity;
  Terrain terrain;
  CrsFacts crs;
  Credits credits;
  BaseMap base_map;  ///< That the file names; base_map_of() says which one counts.
  Ground ground;
  std::string fingerprint;                  ///< A hash of the content, as hexadecimal digits.
  Window bounds{};                          ///< Map units.
  std::optional<Window> lon_lat;            ///< Degrees east and north of CRS84; none: not known.
  std::optional<LonLatNodes> degree_nodes;  ///< Over `bounds`, of a projected CRS.
  mutable TileSets tile_sets;

  /// What people know it by: its title, or else its name.
  [[nodiscard]] const std::string& title() const noexcept {
    return credits.title.empty() ? id : credits.title;
  }
};

/// The base map that pages may lay over a terrain: that of the service if it has one, or else the file's.
[[nodiscard]] const BaseMap& base_map_of(const ServeOptions& options,
                                         const Collection& collection) noexcept;

/// @param where  Gave it, for the error.
/// @throws Error invalid_argument  a collection cannot have this name
void check_collection_name(const std::string& name, const std::string& where);

/// Changes whenever the bytes of any answer may: with the file, and with the program.
[[nodiscard]] std::string version_of(const Collection& collection, const std::string& program);

/// Threads: any.
class Catalogue {
 public:
  /// Takes a sentence about a file that cannot be read any more.
  using Warn = std::function<void(const std::string& id, const std::string& what)>;

  /// Opens all files.
  /// @throws Error invalid_argument  two files of one name, or a name that no URL should hold
  ///               as Terrain::open
  Catalogue(const std::vector<ServedFile>& files, Warn warn);

  /// Puts these files in the place of all: of a name that has the same path as before nothing is opened.
  /// Questions in flight end on what they began with.
  /// @throws Error as the constructor; all is then as before
  void replace(const std::vector<ServedFile>& files);

  /// The collection of this name, null when there is none. Looks whether the file was replaced, and
  /// then opens the new one; while that one cannot be opened, the old one goes on answering.
  [[nodiscard]] std::shared_ptr<const Collection> find(const std::string& id) const;
  /// Whether there is one of this name; nothing is opened, and no file is looked at.
  [[nodiscard]] bool has(const std::string& id) const { return entries()->count(id) != 0; }
  /// A question met a page that is damaged: known until another file takes the place of this one.
  void note_damage(const Collection& collection) const;
  /// Those whose open file was written over in place and is no terrain any more, or has pages that are
  /// damaged, as far as questions met them, by name.
  [[nodiscard]] std::vector<std::string> damaged() const;
  /// @throws Error corruption  the collection is one of those
  void check_whole(const std::string& id) const;
  /// All, by name.
  [[nodiscard]] std::vector<std::shared_ptr<const Collection>> all() const;

 private:
  struct Entry {
    std::string path;
    mutable std::mutex mutex;
    std::shared_ptr<const Collection> open;
    FileIdentity refused;  ///< That could not be opened.
    bool is_stale = false;
    std::atomic<bool> is_damaged = false;     ///< Read without the mutex, as the next one.
    std::atomic<bool> has_bad_pages = false;  ///< A question met one in what is open.
    /// What is damaged is not tried again; what may be a matter of the moment is, from then on.
    std::chrono::steady_clock::time_point next_try;
  };
  [[nodiscard]] std::shared_ptr<const Collection> current(const std::string& id,
                                                          Entry& entry) const;

  using Entries = std::map<std::string, std::shared_ptr<Entry>>;
  [[nodiscard]] static Entries opened_entries(const std::vector<ServedFile>& files,
                                              const Entries& known);
  /// Those of this moment.
  [[nodiscard]] std::shared_ptr<const Entries> entries() const {
    const std::scoped_lock lock(mutex_);
    return entries_;
  }

  Warn warn_;
  mutable std::mutex mutex_;  ///< Of the pointer.
  std::shared_ptr<const Entries> entries_;
};

/// The identity of the file at a path; none: there is no file.
[[nodiscard]] std::optional<FileIdentity> identity_of(const std::string& path);

}  // namespace ptin::serve
