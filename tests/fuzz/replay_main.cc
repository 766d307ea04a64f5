// SPDX-License-Identifier: GPL-3.0-or-later
//
// Drives fuzz targets without libFuzzer: every file that is given, or lies in a folder that is
// given, then a bounded number of seeded random mutations of them. Same arguments and files, same
// inputs.
//
//   fuzz_replay TARGET [-mutations N] [-seed S] [-max_len BYTES] FILE_OR_FOLDER...
//
// A failure is the target's own: a sanitizer's report or an uncaught exception. The input that was
// running then is in the working folder as crash-input-NAME.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <iterator>
#include <random>
#include <string>
#include <string_view>
#include <vector>

#include "tests/fuzz/fuzz_target.h"

namespace {

namespace fs = std::filesystem;
using Bytes = std::vector<std::uint8_t>;

struct Options {
  std::string name;
  ptin::fuzz::Target target = nullptr;
  std::uint64_t mutations = 0;
  std::uint64_t seed = 1;
  std::size_t max_len = std::size_t{1} << 20;
  std::vector<fs::path> inputs;
};

Options parse(int argc, char** argv) {
  Options options;
  options.name = argc > 1 ? argv[1] : "";
  const auto found = ptin::fuzz::targets().find(options.name);
  if (found == ptin::fuzz::targets().end()) {
    std::cerr << "\"" << options.name << "\" is no target; there are";
    for (const auto& [name, target] : ptin::fuzz::targets()) std::cerr << " " << name;
    std::cerr << "\n";
    std::exit(2);
  }
  options.target = found->second;
  for (int i = 2; i < argc; ++i) {
    const std::string_view argument = argv[i];
    const auto number = [&] {
      if (i + 1 >= argc) {
        std::cerr << argument << " needs a number\n";
        std::exit(2);
      }
      return std::strtoull(argv[++i], nullptr, 10);
    };
    if (argument == "-mutations") {
      options.mutations = number();
    } else if (argument == "-seed") {
      options.seed = number();
    } else if (argument == "-max_len") {
      options.max_len = number();
    } else if (fs::exists(argument)) {
      options.inputs.emplace_back(argument);
    } else {
      std::cerr << "no such option, file or folder: " << argument << "\n";
      std::exit(2);
    }
  }
  return options;
}

std::vector<Bytes> read_corpus(const std::vector<fs::path>& inputs) {
  std::vector<fs::path> files;
  for (const fs::path& input : inputs) {
    if (!fs::is_directory(input)) {
      files.push_back(input);
      continue;
    }
    for (const fs::directory_entry& entry : fs::recursive_directory_iterator(input)) {
      if (entry.is_regular_file()) {
        files.push_back(entry.path());
      }
    }
  }
  std::sort(files.begin(), files.end());
  std::vector<Bytes> corpus;
  for (const fs::path& file : files) {
    std::ifstream stream(file, std::ios::binary);
    corpus.emplace_back(std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>());
  }
  return corpus;
}

/// Changes an input in the ways that break readers: bits, bytes, extreme integers, cuts, repeats,
/// splices.
class Mutator {
 public:
  Mutator(std::uint64_t seed, std::size_t max_len, const std::vector<Bytes>& corpus)
      : random_(seed), max_len_(max_len), corpus_(corpus) {}

  Bytes next() {
    Bytes bytes = corpus_[below(corpus_.size())];
    const std::size_t steps = 1 + below(8);
    for (std::size_t i = 0; i < steps; ++i) {
      step(bytes);
    }
    bytes.resize(std::min(bytes.size(), max_len_));
    return bytes;
  }

 private:
  std::size_t below(std::size_t bound) { return static_cast<std::size_t>(random_() % bound); }

  void step(Bytes& bytes) {
    if (bytes.empty()) {
      bytes.push_back(static_cast<std::uint8_t>(random_()));
      return;
    }
    const std::size_t at = below(bytes.size());
    switch (below(6)) {
      case 0:
        bytes[at] = static_cast<std::uint8_t>(bytes[at] ^ (1U << below(8)));
        break;
      case 1:
        bytes[at] = static_cast<std::uint8_t>(random_());
        break;
      case 2:
        overwrite_integer(bytes, at);
        break;
      case 3:
        bytes.resize(at);
        break;
      case 4:
        repeat(bytes, at);
        break;
      default:
        splice(bytes, at);
        break;
    }
  }

  /// 0, all ones, a sign bit, one, or a small step from what stands there, in 1 to 8 little-endian
  /// bytes.
  void overwrite_integer(Bytes& bytes, std::size_t at) {
    const std::size_t width = std::min(std::size_t{1} << below(4), bytes.size() - at);
    std::uint64_t value = 0;
    for (std::size_t i = 0; i < width; ++i) {
      value |= std::uint64_t{bytes[at + i]} << (8 * i);
    }
    const std::uint64_t choices[] = {0, ~std::uint64_t{0}, std::uint64_t{1} << (8 * width - 1),
                                     1, value + 1,         value - 1};
    value = choices[below(std::size(choices))];
    for (std::size_t i = 0; i < width; ++i) {
      bytes[at + i] = static_cast<std::uint8_t>(value >> (8 * i));
    }
  }

  void repeat(Bytes& bytes, std::size_t at) {
    const std::size_t length = std::min({bytes.size() - at, std::size_t{4096}, max_len_});
    const Bytes piece(bytes.begin() + static_cast<std::ptrdiff_t>(at),
                      bytes.begin() + static_cast<std::ptrdiff_t>(at + 1 + below(length)));
    bytes.insert(bytes.begin() + static_cast<std::ptrdiff_t>(at), piece.begin(), piece.end());
  }

  void splice(Bytes& bytes, std::size_t at) {
    const Bytes& other = corpus_[below(corpus_.size())];
    const std::size_t length = std::min(bytes.size(), other.size());
    if (at < length) {
      const std::size_t count = 1 + below(length - at);
      std::copy_n(other.begin() + static_cast<std::ptrdiff_t>(at), count,
                  bytes.begin() + static_cast<std::ptrdiff_t>(at));
    }
  }

  std::mt19937_64 random_;
  std::size_t max_len_;
  const std::vector<Bytes>& corpus_;
};

void run(const Options& options, const Bytes& bytes, const fs::path& running) {
  {
    std::ofstream stream(running, std::ios::binary | std::ios::trunc);
    stream.write(reinterpret_cast<const char*>(bytes.data()),
                 static_cast<std::streamsize>(bytes.size()));
  }
  options.target(bytes.data(), bytes.size());
}

}  // namespace

int main(int argc, char** argv) {
  const Options options = parse(argc, argv);
  const fs::path running = "crash-input-" + options.name;
  std::vector<Bytes> corpus = read_corpus(options.inputs);
  if (corpus.empty()) {
    corpus.emplace_back();
  }
  for (const Bytes& bytes : corpus) {
    run(options, bytes, running);
  }
  Mutator mutator(options.seed, options.max_len, corpus);
  for (std::uint64_t i = 0; i < options.mutations; ++i) {
    run(options, mutator.next(), running);
  }
  fs::remove(running);
  std::cout << corpus.size() << " inputs replayed, " << options.mutations << " mutations of seed "
            << options.seed << "\n";
  return 0;
}
