// SPDX-License-Identifier: GPL-3.0-or-later
//
// The ellipsoid of WGS 84, on which tiles for a globe stand: positions and directions in its
// earth-centred frame (ECEF), in metres.
#pragma once

#include <cmath>

namespace ptin::tools {

inline constexpr double kSemiMajor = 6378137.0;
inline constexpr double kSemiMinor = 6356752.3142451793;

/// A position or a direction of the earth-centred frame: x to the meridian of Greenwich, z to the
/// north pole.
struct Vec3 {
  double x = 0.0;
  double y = 0.0;
  double z = 0.0;
  friend bool operator==(const Vec3&, const Vec3&) = default;
};

[[nodiscard]] inline Vec3 operator+(const Vec3& a, const Vec3& b) noexcept {
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}
[[nodiscard]] inline Vec3 operator-(const Vec3& a, const Vec3& b) noexcept {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}
[[nodiscard]] inline Vec3 operator*(double f, const Vec3& a) noexcept {
  return {f * a.x, f * a.y, f * a.z};
}
[[nodiscard]] inline double dot(const Vec3& a, const Vec3& b) noexcept {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
[[nodiscard]] inline Vec3 cross(const Vec3& a, const Vec3& b) noexcept {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
[[nodiscard]] inline double length(const Vec3& a) noexcept { return std::sqrt(dot(a, a)); }

/// A position by longitude and latitude, degrees, and the height above the ellipsoid, metres.
struct GlobePoint {
  double lon = 0.0;
  double lat = 0.0;
  double height = 0.0;
};

/// The direction away from the ellipsoid: a unit vector. -180 and 180 degrees give the same bits.
[[nodiscard]] inline Vec3 up_at(double lon, double lat) noexcept {
  const double l = (lon == -180.0 ? 180.0 : lon) * (M_PI / 180.0);
  const double p = lat * (M_PI / 180.0);
  const double c = std::cos(p);
  return {c * std::cos(l), c * std::sin(l), std::sin(p)};
}

[[nodiscard]] inline Vec3 ecef_of(const GlobePoint& p) noexcept {
  constexpr double kE2 = 1.0 - (kSemiMinor * kSemiMinor) / (kSemiMajor * kSemiMajor);
  const Vec3 up = up_at(p.lon, p.lat);
  const double normal = kSemiMajor / std::sqrt(1.0 - kE2 * up.z * up.z);
  return {(normal + p.height) * up.x, (normal + p.height) * up.y,
          ((1.0 - kE2) * normal + p.height) * up.z};
}

}  // namespace ptin::tools
