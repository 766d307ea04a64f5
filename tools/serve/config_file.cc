// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/serve/config_file.h"

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <filesystem>
#include <fstream>
#include <vector>

#include <CLI/CLI.hpp>
#include <sys/stat.h>

#include "engine/error.h"
#include "engine/number.h"
#include "tools/serve/catalogue.h"
#include "tools/serve/limit_table.h"

namespace ptin::serve {

namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMostThreads = 1024;  // As --threads.

std::vector<CLI::ConfigItem> parsed(const std::string& path) {
  std::ifstream in(path);
  if (!in) throw system_error(errno, "cannot open", path);
  try {
    return CLI::ConfigTOML().from_config(in);
  } catch (const CLI::Error& error) {
    refuse(std::string("this is no configuration: ") + error.what(), path);
  }
}

/// Its items, each with one value.
std::vector<CLI::ConfigItem> items_of(const std::string& path) {
  std::vector<CLI::ConfigItem> items = parsed(path);
  std::erase_if(items, [](const CLI::ConfigItem& item) {
    return item.name == "++" || item.name == "--";  // A table begins or ends.
  });
  for (const CLI::ConfigItem& item : items) {
    if (item.inputs.size() != 1) refuse("\"" + item.fullname() + "\" has not one value", path);
  }
  return items;
}

bool is_collection(const CLI::ConfigItem& item) {
  return item.parents == std::vector<std::string>{"collections"};
}

std::string next_to(const std::string& config, const std::string& file) {
  return fs::path(file).is_absolute() ? file : (fs::path(config).parent_path() / file).string();
}

void take_setting(const std::string& name, const std::string& value, const std::string& path,
                  ServeOptions& options) {
  if (name == "listen") {
    options.listen = value;
  } else if (name == "public_url") {
    options.public_address = public_address_of(value, path);
  } else if (name == "cors") {
    options.cors_origin = checked_origin(value, path);
  } else if (name == "base_map") {
    set_base_map_tiles(value, options);
  } else if (name == "base_map_attribution") {
    if (!options.base_map) options.base_map.emplace();
    options.base_map->attribution = value;
  } else if (name == "token_file") {
    options.token = read_token(next_to(path, value));
  } else if (name == "files") {
    if (value != "true" && value != "false") refuse("files is neither true nor false", path);
    options.offers_files = value == "true";
  } else if (name == "metrics") {
    options.metrics = metrics_for(value, path);
  } else if (name == "trusted_proxies") {
    add_trusted_proxies(value, options);
  } else if (name == "threads") {
    options.http.threads = parse_number<decltype(options.http.threads)>(value).value_or(0);
    if (options.http.threads == 0 || options.http.threads > kMostThreads) {
      refuse("threads is no whole number from 1 to " + std::to_string(kMostThreads), path);
    }
  } else {
    refuse("\"" + name +
               "\" means nothing here; there are listen, threads, public_url, cors, base_map, "
               "base_map_attribution, token_file, files, metrics, trusted_proxies, and the tables "
               "[collections] and [limits]",
           path);
  }
}

}  // namespace

void read_config(const std::string& path, ServeOptions& options) {
  for (const CLI::ConfigItem& item : items_of(path)) {
    const std::string& value = item.inputs.front();
    if (item.parents.empty()) {
      take_setting(item.name, value, path, options);
    } else if (is_collection(item)) {
      check_collection_name(item.name, path);
      options.files.push_back({item.name, next_to(path, value)});
    } else if (item.parents == std::vector<std::string>{"limits"}) {
      set_limit(options, item.name, value);
    } else {
      refuse(
          "no table is called [" + item.parents.front() + "]; there are [collections] and [limits]",
          path);
    }
  }
}

std::map<std::string, std::string> settings_in(const std::string& path) {
  std::map<std::string, std::string> settings;
  for (const CLI::ConfigItem& item : items_of(path)) {
    if (!is_collection(item)) settings.emplace(item.fullname(), item.inputs.front());
  }
  return settings;
}

void set_base_map_tiles(const std::string& tiles, ServeOptions& options) {
  if (!options.base_map) options.base_map.emplace();
  options.base_map->tiles = tiles == "none" ? std::string() : tiles;
}

std::string checked_origin(const std::string& origin, const std::string& where) {
  const bool is_plain = std::all_of(origin.begin(), origin.end(), [](char c) {
    constexpr unsigned char kBlank = 0x20, kDelete = 0x7F;
    return static_cast<unsigned char>(c) > kBlank && static_cast<unsigned char>(c) != kDelete;
  });
  if (is_plain) return origin;
  refuse(
      "an origin of web pages holds no blank and no control character; expected * or one as "
      "https://example.org",
      where);
}

MetricsFor metrics_for(const std::string& word, const std::string& where) {
  if (word == "open") return MetricsFor::kAll;
  if (word == "token") return MetricsFor::kToken;
  if (word == "closed") return MetricsFor::kNobody;
  refuse("\"" + word + "\" is not who may read the metrics; expected open, token or closed", where);
}

void add_trusted_proxies(const std::string& list, ServeOptions& options) {
  for (std::size_t begin = 0; begin <= list.size();) {
    const std::size_t end = std::min(list.find(',', begin), list.size());
    const std::string one = list.substr(begin, end - begin);
    const std::size_t first = one.find_first_not_of(' ');
    const std::size_t last = one.find_last_not_of(' ');
    options.http.trusted_proxies.push_back(http::parse_network(
        first == std::string::npos ? one : one.substr(first, last + 1 - first)));
    begin = end + 1;
  }
}

std::string read_token(const std::string& path) {
  struct stat facts {};
  if (::stat(path.c_str(), &facts) != 0) throw system_error(errno, "cannot open", path);
  if ((facts.st_mode & (S_IROTH | S_IWOTH)) != 0) {
    refuse("everybody may read the token in this file; take that away with chmod o-rwx", path);
  }
  std::ifstream in(path);
  std::string token;
  std::getline(in, token);
  while (!token.empty() && std::isspace(static_cast<unsigned char>(token.back())) != 0) {
    token.pop_back();  // An editor's blank, or the other half of a line end.
  }
  if (token.empty()) {
    refuse("the first line of the file is empty; it holds the token", path);
  }
  return token;
}

}  // namespace ptin::serve
