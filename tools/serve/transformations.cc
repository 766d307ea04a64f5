// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/serve/transformations.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <list>
#include <mutex>
#include <optional>
#include <utility>

#include "tools/http/problem.h"

namespace ptin::serve {

namespace {

constexpr const char* kLonLat = "OGC:CRS84";
constexpr std::size_t kMostKept = 64;
/// Taken for one transformation until it is known how long it took.
constexpr MakingTime::Seconds kAhead{0.25};
constexpr MakingTime::Seconds kMostAtOnce{10};
constexpr double kShare = 0.25;

/// The transformations between two CRSs, or why there are none.
struct Made {
  std::shared_ptr<const BothWays> ways;
  std::string refusal;
};

/// The transformations that were asked for last, by their two CRSs.
class Kept {
 public:
  using Key = std::pair<std::string, std::string>;

  [[nodiscard]] const Made* find(const Key& key) {
    const auto at = std::find_if(kept_.begin(), kept_.end(),
                                 [&](const auto& entry) { return entry.first == key; });
    if (at == kept_.end()) return nullptr;
    kept_.splice(kept_.begin(), kept_, at);
    return &kept_.front().second;
  }
  void keep(const Key& key, Made made) {
    if (find(key) != nullptr) return;  // Another thread was first.
    kept_.emplace_front(key, std::move(made));
    if (kept_.size() > kMostKept) kept_.pop_back();
  }

 private:
  std::list<std::pair<Key, Made>> kept_;
};

/// State that all threads share: they take copies.
struct Shared {
  std::mutex mutex;
  Kept kept;
  MakingTime time{kMostAtOnce, kShare};
};

Shared& shared() {
  static Shared all;
  return all;
}

http::Problem refused(const std::string& why) { return http::Problem(400, why).at("crs"); }

/// Whether positions of a CRS have an x and a y of a plane or of a globe. PROJ would go on from a
/// vertical or a geocentric CRS all the same, by operations that say nothing of positions.
bool has_plane(const OGRSpatialReference& crs) {
  return crs.IsGeographic() != 0 || crs.IsProjected() != 0;
}

Made make(const std::string& client, const std::string& wkt) {
  OGRSpatialReference from, to;
  if (from.SetFromUserInput(client.c_str()) != OGRERR_NONE) {
    return {nullptr,
            "there is no CRS " + client + "; expected CRS84, native, or another EPSG code"};
  }
  if (!has_plane(from)) {
    return {nullptr,
            client +
                " has no positions in a plane; expected the code of a geographic, projected "
                "or compound CRS, CRS84 or native"};
  }
  const bool is_known = to.importFromWkt(wkt.c_str()) == OGRERR_NONE;
  for (OGRSpatialReference* plane : {&from, &to}) {
    plane->DemoteTo2D(nullptr);
    plane->StripVertical();
    plane->SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
  }
  auto ways = std::make_shared<BothWays>();
  if (is_known) ways->there.reset(OGRCreateCoordinateTransformation(&from, &to));
  if (ways->there) ways->back.reset(OGRCreateCoordinateTransformation(&to, &from));
  if (ways->back) return {std::move(ways), {}};
  return {nullptr, "there is no transformation between " + client +
                       " and the CRS of this collection; ask with crs=native"};
}

Made copy_of(const Made& made) {
  if (!made.ways) return made;
  auto ways = std::make_shared<BothWays>();
  ways->there.reset(made.ways->there->Clone());
  ways->back.reset(made.ways->back->Clone());
  if (ways->there && ways->back) return {std::move(ways), {}};
  return {nullptr, "the CRS could not be prepared; ask again"};
}

void throw_beyond(MakingTime::Seconds wait) {
  throw http::Problem(503,
                      "more CRSs that are new to this service are asked for than it prepares at "
                      "once; come again later, or ask with crs=CRS84 or crs=native")
      .at("crs")
      .retry_after(static_cast<unsigned>(std::ceil(wait.count())));
}

/// A copy of what other threads have made; none: nobody made it, and time for it is taken.
std::optional<Made> made_by_others(const Kept::Key& key, const std::string& who) {
  Shared& all = shared();
  const std::lock_guard lock(all.mutex);
  if (const Made* made = all.kept.find(key)) return copy_of(*made);
  if (key.first == kLonLat) return std::nullopt;
  if (const auto wait = all.time.take(MakingTime::Clock::now(), who); wait.count() > 0)
    throw_beyond(wait);
  return std::nullopt;
}

Made make_for_all(const Kept::Key& key, const std::string& who) {
  const auto begun = MakingTime::Clock::now();
  Made made = make(key.first, key.second);
  Shared& all = shared();
  const std::lock_guard lock(all.mutex);
  if (key.first != kLonLat) all.time.settle(MakingTime::Clock::now() - begun, who);
  all.kept.keep(key, copy_of(made));
  return made;
}

}  // namespace

MakingTime::Seconds MakingTime::take(Clock::time_point now, const std::string& who) {
  if (last_ != Clock::time_point{}) come_back(share_ * Seconds(now - last_));
  last_ = now;
  if (left_.count() <= 0) return std::max(Seconds(1), -left_ / share_);
  const auto spent = spent_.find(who);
  if (spent != spent_.end() && spent->second > left_) {
    return std::max(Seconds(1), (spent->second - left_) / share_);
  }
  spend(kAhead, who);
  return Seconds(0);
}

void MakingTime::settle(Seconds spent, const std::string& who) { spend(spent - kAhead, who); }

void MakingTime::spend(Seconds time, const std::string& who) {
  left_ -= time;
  if (!who.empty()) spent_[who] += time;
}

/// To everybody in proportion to what they spent.
void MakingTime::come_back(Seconds time) {
  constexpr Seconds kNothing{0.001};
  left_ = std::min(most_, left_ + time);
  Seconds all{0};
  for (const auto& [who, spent] : spent_) all += spent;
  const double stays = all > time ? 1.0 - time / all : 0.0;
  for (auto& [who, spent] : spent_) spent *= stays;
  std::erase_if(spent_, [&](const auto& entry) { return entry.second < kNothing; });
}

std::shared_ptr<const BothWays> both_ways(const std::string& client, const std::string& wkt,
                                          const std::string& who) {
  static thread_local Kept own;
  const Kept::Key key{client, wkt};
  const Made* made = own.find(key);
  if (made == nullptr) {
    std::optional<Made> others = made_by_others(key, who);
    own.keep(key, others ? std::move(*others) : make_for_all(key, who));
    made = own.find(key);
  }
  if (!made->ways) throw refused(made->refusal);
  return made->ways;
}

}  // namespace ptin::serve
