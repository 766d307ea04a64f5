// SPDX-License-Identifier: GPL-3.0-or-later
#include "storage/spatialindex_rtree.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <exception>
#include <filesystem>
#include <mutex>
#include <thread>
#include <utility>

#include <sched.h>
#include <spatialindex/SpatialIndex.h>
#include <unistd.h>

#include "engine/check.h"
#include "engine/error.h"
#include "engine/geometry/infinity.h"
#include "storage/sealed_storage.h"

namespace ptin {

namespace si = SpatialIndex;
namespace fs = std::filesystem;

namespace {

constexpr std::uint32_t kDimensions = 4;
constexpr std::uint32_t kDiskPageBytes = 4096;
// An entry takes 76 bytes (eight doubles, an id, a length), a node 76 more, its checksum 8: 52
// would just fit.
constexpr std::uint32_t kCapacity = 50;
constexpr double kFill = 0.99;
// Bytes that the bulk loader keeps for each entry: a record on the heap with a region of eight
// doubles.
constexpr std::uint64_t kSortBytes = 256;
// Stands for an infinite error or height: beyond every float, and sums of two are finite.
constexpr double kBeyond = 0x1p200;

// The first thing in the .dat file, so that a tree is known to be of this store.
struct Stamp {
  std::array<char, 8> magic;
  std::uint64_t fingerprint, file_bytes, pages;
  std::int64_t tree_id;  // of the tree's header in the storage manager
};
constexpr std::array<char, 8> kStampMagic = {'P', 'T', 'I', 'N', 'S', 'I', 'D', '2'};

bool belongs_to(const Stamp& stamp, const StoreFile& store) {
  return stamp.magic == kStampMagic && stamp.fingerprint == store.fingerprint() &&
         stamp.file_bytes == store.file_bytes() && stamp.pages == store.pages().page_count();
}

// libspatialindex has exceptions of its own, which are no std::exception.
template <class Work>
auto translated(const std::string& base, Work work) {
  try {
    return work();
  } catch (Tools::Exception& e) {
    throw Error(ErrorCode::io_error,
                "libspatialindex: " + e.what() + "; remove the .dat and .idx files and try again",
                base);
  } catch (const std::ios_base::failure&) {
    throw Error(ErrorCode::io_error,
                "libspatialindex cannot read or write its files; is the disk full?", base);
  }
}

double bounded(double v) { return std::clamp(v, -kBeyond, kBeyond); }

si::Region region_of(const Attributes& a) {
  // An empty interval of heights becomes a point: a box may be larger than what it stands for,
  // never smaller.
  const bool empty = is_empty(a.heights);
  const std::array<double, kDimensions> low = {static_cast<double>(a.roi.min_x),
                                               static_cast<double>(a.roi.min_y),
                                               empty ? 0.0 : bounded(a.heights.lo), 0.0};
  const std::array<double, kDimensions> high = {
      static_cast<double>(a.roi.max_x), static_cast<double>(a.roi.max_y),
      empty ? 0.0 : bounded(a.heights.hi), bounded(a.error)};
  return {low.data(), high.data(), kDimensions};
}

// The largest attributes that something inside of a node's box can have.
Attributes attributes_of(const si::Region& r) {
  const auto whole = [](double v) { return static_cast<std::int32_t>(v); };
  const auto unbounded = [](double v) {
    return v >= kBeyond ? kInfinity : (v <= -kBeyond ? -kInfinity : v);
  };
  return {{whole(r.m_pLow[0]), whole(r.m_pLow[1]), whole(r.m_pHigh[0]), whole(r.m_pHigh[1])},
          {unbounded(r.m_pLow[2]), unbounded(r.m_pHigh[2])},
          unbounded(r.m_pHigh[3]),
          kInfinity};
}

// The descriptors of all pages, in order, as libspatialindex wants them.
class PageStream final : public si::IDataStream {
 public:
  explicit PageStream(const StoreFile& store) : store_(store) {}
  si::IData* getNext() override {
    if (!hasNext()) {
      return nullptr;
    }
    si::Region region = region_of(store_.page_info(PageId{next_}).attributes);
    return new si::RTree::Data(0, nullptr, region, static_cast<si::id_type>(next_++));
  }
  bool hasNext() override { return next_ < store_.pages().page_count(); }
  std::uint32_t size() override { return static_cast<std::uint32_t>(store_.pages().page_count()); }
  void rewind() override { next_ = 0; }

 private:
  const StoreFile& store_;
  std::uint64_t next_ = 0;
};

// Walks the nodes whose boxes satisfy the predicate.
class PredicateStrategy final : public si::IQueryStrategy {
 public:
  PredicateStrategy(const StoreFile& store, const AttributePredicate& predicate,
                    std::vector<PageId>& pages, IoCounters& counters)
      : store_(store), predicate_(predicate), pages_(pages), counters_(counters) {}

  void getNextEntry(const si::IEntry& entry, si::id_type& next, bool& has_next) override {
    const auto* node = dynamic_cast<const si::INode*>(&entry);
    if (node != nullptr) {
      ++counters_.index_nodes;
      counters_.bytes_read += kDiskPageBytes;
      for (std::uint32_t i = 0; i < node->getChildrenCount(); ++i) {
        look_at(*node, i);
      }
    }
    has_next = !waiting_.empty();
    if (has_next) {
      next = waiting_.back();
      waiting_.pop_back();
    }
  }

 private:
  void look_at(const si::INode& node, std::uint32_t i) {
    const si::id_type id = node.getChildIdentifier(i);
    if (node.isLeaf()) {
      const PageId page{static_cast<std::uint64_t>(id)};
      if (predicate_.holds(store_.page_info(page).attributes)) {
        pages_.push_back(page);
      }
      return;
    }
    si::IShape* shape = nullptr;
    node.getChildShape(i, &shape);
    const std::unique_ptr<si::IShape> owner(shape);
    const auto* region = dynamic_cast<const si::Region*>(shape);
    if (region == nullptr || region->m_dimension != kDimensions ||
        predicate_.holds(attributes_of(*region))) {
      waiting_.push_back(id);
    }
  }

  const StoreFile& store_;
  const AttributePredicate& predicate_;
  std::vector<PageId>& pages_;
  IoCounters& counters_;
  std::vector<si::id_type> waiting_;
};

void set(Tools::PropertySet& properties, const char* name, std::uint32_t value) {
  Tools::Variant v;
  v.m_varType = Tools::VT_ULONG;
  v.m_val.ulVal = value;
  properties.setProperty(name, v);
}

Tools::PropertySet tree_properties(std::uint64_t entries_in_memory) {
  Tools::PropertySet p;
  Tools::Variant v;
  v.m_varType = Tools::VT_LONG;
  v.m_val.lVal = si::RTree::RV_RSTAR;
  p.setProperty("TreeVariant", v);
  v = Tools::Variant();
  v.m_varType = Tools::VT_DOUBLE;
  v.m_val.dblVal = kFill;
  p.setProperty("FillFactor", v);
  set(p, "Dimension", kDimensions);
  set(p, "IndexCapacity", kCapacity);
  set(p, "LeafCapacity", kCapacity);
  // The number of entries on a page of the sorter, and the number of pages that it keeps: beyond
  // their product it spills. It merges as many runs at once as it has pages.
  constexpr std::uint32_t kSorterPages = 64;
  const std::uint64_t page_entries =
      std::clamp<std::uint64_t>(entries_in_memory / kSorterPages, 64, 1U << 24);
  set(p, "ExternalSortBufferPageSize", static_cast<std::uint32_t>(page_entries));
  set(p, "ExternalSortBufferTotalPages", kSorterPages);
  return p;
}

void bulk_load(const StoreFile& store, const std::string& base, std::uint64_t memory_bytes) {
  std::unique_ptr<SealedStorage> disk = SealedStorage::create(base, kDiskPageBytes);
  Stamp stamp{kStampMagic, store.fingerprint(), store.file_bytes(), store.pages().page_count(), -1};
  const auto* bytes = reinterpret_cast<const std::uint8_t*>(&stamp);
  si::id_type stamp_id = si::StorageManager::NewPage;
  disk->storeByteArray(stamp_id, sizeof stamp, bytes);
  PTIN_CHECK(stamp_id == 0);
  if (store.pages().page_count() > 0) {
    PageStream stream(store);
    Tools::PropertySet properties = tree_properties(memory_bytes / kSortBytes);
    si::id_type tree_id = 0;
    const std::unique_ptr<si::ISpatialIndex> tree(si::RTree::createAndBulkLoadNewRTree(
        si::RTree::BLM_STR, stream, *disk, properties, tree_id));
    stamp.tree_id = tree_id;
    disk->storeByteArray(stamp_id, sizeof stamp, bytes);
  }
  SealedStorage::seal(std::move(disk));
}

// libspatialindex's external sorter puts its runs into the working folder. So the bulk loader runs
// on a thread that has a working folder of its own, and the working folder of the process stays.
void bulk_load_in(const std::string& folder, const StoreFile& store, const std::string& base,
                  std::uint64_t memory_bytes) {
  std::exception_ptr failure;
  std::thread worker([&] {
    try {
      if (::unshare(CLONE_FS) != 0 || ::chdir(folder.c_str()) != 0) {
        throw system_error(errno, "cannot make this the working folder of the bulk loader", folder);
      }
      translated(base, [&] { bulk_load(store, base, memory_bytes); });
    } catch (...) {
      failure = std::current_exception();
    }
  });
  worker.join();
  if (failure) {
    std::rethrow_exception(failure);
  }
}

void remove_tree(const std::string& base) {
  std::error_code ignored;
  fs::remove(base + ".dat", ignored);
  fs::remove(base + ".idx", ignored);
}

// Builds the tree under another name and renames its files. The .dat file, which holds the stamp,
// gets its name last.
void build(const StoreFile& store, const std::string& base, const SpatialIndexOptions& options) {
  const std::string scratch = base + "." + std::to_string(::getpid()) + ".tmp";
  const std::string folder = options.temporary_folder.empty()
                                 ? fs::path(base).parent_path().string()
                                 : fs::absolute(options.temporary_folder).string();
  if (!fs::is_directory(fs::path(base).parent_path()) || !fs::is_directory(folder)) {
    throw Error(ErrorCode::not_found, "the folder for the tree or for temporary files is not there",
                base);
  }
  try {
    bulk_load_in(folder, store, scratch, options.memory_bytes);
    remove_tree(base);
    fs::rename(scratch + ".idx", base + ".idx");
    fs::rename(scratch + ".dat", base + ".dat");
  } catch (const fs::filesystem_error& e) {
    remove_tree(scratch);
    throw system_error(e.code().value(), "cannot rename the finished tree", base);
  } catch (...) {
    remove_tree(scratch);
    throw;
  }
}

}  // namespace

struct SpatialIndexRTree::Tree {
  std::shared_ptr<const StoreFile> store;
  std::string base;
  bool was_built = false;
  std::unique_ptr<SealedStorage> disk;
  std::unique_ptr<si::ISpatialIndex> tree;  // none when there are no pages
  mutable std::mutex turn;

  // False when the files are not there, cannot be read, are damaged or are of another store.
  bool load() {
    try {
      disk = SealedStorage::open(base);
      if (!disk) {
        return false;
      }
      std::uint32_t bytes = 0;
      std::uint8_t* content = nullptr;
      disk->loadByteArray(0, bytes, &content);
      const std::unique_ptr<std::uint8_t[]> owner(content);
      Stamp stamp{};
      if (bytes == sizeof stamp) {
        std::memcpy(&stamp, content, sizeof stamp);
      }
      if (!belongs_to(stamp, *store)) {
        disk.reset();
        return false;
      }
      if (stamp.pages > 0) {
        tree.reset(si::RTree::loadRTree(*disk, stamp.tree_id));
      }
      return true;
    } catch (Tools::Exception&) {
    } catch (const std::ios_base::failure&) {
    } catch (const Error& e) {
      if (e.code() != ErrorCode::corruption) {
        throw;
      }
    }
    disk.reset();
    return false;
  }
};

SpatialIndexRTree::SpatialIndexRTree(std::unique_ptr<Tree> tree) : tree_(std::move(tree)) {}

SpatialIndexRTree::~SpatialIndexRTree() {
  // The tree writes its header into the storage manager when it is destroyed, so it is destroyed
  // first.
  tree_->tree.reset();
}

bool SpatialIndexRTree::was_built() const noexcept { return tree_->was_built; }

std::unique_ptr<SpatialIndexRTree> SpatialIndexRTree::open(std::shared_ptr<const StoreFile> store,
                                                           const SpatialIndexOptions& options) {
  auto tree = std::make_unique<Tree>();
  tree->store = std::move(store);
  tree->base =
      fs::absolute(options.base.empty() ? tree->store->path() + ".sidx" : options.base).string();
  if (!tree->load()) {
    build(*tree->store, tree->base, options);
    tree->was_built = true;
    if (!tree->load()) {
      throw Error(ErrorCode::io_error, "the tree was built and cannot be read back", tree->base);
    }
  }
  return std::unique_ptr<SpatialIndexRTree>(new SpatialIndexRTree(std::move(tree)));
}

void SpatialIndexRTree::search(const AttributePredicate& predicate, std::vector<PageId>& pages,
                               IoCounters& counters) const {
  if (!tree_->tree) {
    return;
  }
  const std::size_t before = pages.size();
  {
    const std::lock_guard turn(tree_->turn);
    PredicateStrategy strategy(*tree_->store, predicate, pages, counters);
    translated(tree_->base, [&] { tree_->tree->queryStrategy(strategy); });
  }
  std::sort(pages.begin() + static_cast<std::ptrdiff_t>(before), pages.end());
}

}  // namespace ptin
