// SPDX-License-Identifier: GPL-3.0-or-later
//
// Writes made points as text, for benchmarks of builds of more points than memory holds: uniform
// over a square, about 90 square metres each, heights a product of sines with noise of 5 m, two
// decimals; the same bytes whenever it runs.
//   make_points COUNT OUT.csv
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <random>

namespace {

bool write(std::uint64_t count, std::FILE* out) {
  std::mt19937_64 random(7);
  const auto share = [&] { return static_cast<double>(random() >> 11) * 0x1p-53; };
  const double side = 9.5 * std::sqrt(static_cast<double>(count));
  std::fputs("x,y,z\n", out);
  for (std::uint64_t i = 0; i < count; ++i) {
    const double x = side * share();
    const double y = side * share();
    const double z = 500 + 300 * std::sin(x / 2000) * std::sin(y / 1500) + 10 * share() - 5;
    if (std::fprintf(out, "%.2f,%.2f,%.2f\n", x, y, z) < 0) return false;
  }
  return std::fflush(out) == 0;
}

}  // namespace

int main(int argc, char** argv) {
  const long long count = argc == 3 ? std::atoll(argv[1]) : 0;
  if (count < 3) {
    std::fprintf(stderr, "usage: make_points COUNT OUT.csv\n");
    return 2;
  }
  std::FILE* out = std::fopen(argv[2], "wb");
  const bool done = out != nullptr && write(static_cast<std::uint64_t>(count), out);
  if (out == nullptr || std::fclose(out) != 0 || !done) {
    std::fprintf(stderr, "make_points: cannot write %s\n", argv[2]);
    return 6;
  }
  return 0;
}
