// SPDX-License-Identifier: GPL-3.0-or-later
//
// Transformations between the CRS of a client and that of a terrain, made once and kept: to make one
// takes up to a second, and a client may name any of some thousand codes.
#pragma once

#include <chrono>
#include <memory>
#include <string>
#include <unordered_map>

#include <ogr_spatialref.h>

namespace ptin::serve {

/// Two transformations of the plane against each other. x stands before y on both sides. Heights are
/// left alone. Threads: one.
struct BothWays {
  std::unique_ptr<OGRCoordinateTransformation> there, back;
};

/// Both ways between a CRS that GDAL knows by its name and that of a WKT text, for the calling thread
/// alone.
/// @param who  Whose share of the time for CRSs that are new is taken; empty: nobody's.
/// @throws http::Problem 400  there is no such CRS; it has no positions of a plane, as a vertical CRS
///                            or a geocentric one; there is no transformation
///                       503  more CRSs that are new to the service are asked for than it prepares at
///                            once; CRS84 is never refused
/// Cost: a few microseconds for what this thread has, below a millisecond for what another one has,
/// else up to a second, which MakingTime bounds.
[[nodiscard]] std::shared_ptr<const BothWays> both_ways(const std::string& client,
                                                        const std::string& wkt,
                                                        const std::string& who = {});

/// The time that the service may spend on CRSs that are new to it: what is there at once, and
/// what comes back of it. Nobody takes more while what they spent is more than what is left for all
/// others. Threads: one.
class MakingTime {
 public:
  using Clock = std::chrono::steady_clock;
  using Seconds = std::chrono::duration<double>;

  /// @param most   There at the beginning, and at most.
  /// @param share  Of each second that comes back.
  MakingTime(Seconds most, double share) : left_(most), most_(most), share_(share) {}

  /// Takes a part for making one, ahead of knowing how long that takes; zero where some is there, else
  /// the time after which there is.
  /// @param who  Whose share it is; empty: nobody's.
  [[nodiscard]] Seconds take(Clock::time_point now, const std::string& who = {});
  /// Tells how long it took.
  void settle(Seconds spent, const std::string& who = {});

 private:
  void come_back(Seconds time);
  void spend(Seconds time, const std::string& who);

  Seconds left_, most_;
  double share_;
  Clock::time_point last_{};
  std::unordered_map<std::string, Seconds> spent_;  ///< What has not come back, by who took it.
};

}  // namespace ptin::serve
