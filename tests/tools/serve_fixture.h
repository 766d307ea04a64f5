// SPDX-License-Identifier: GPL-3.0-or-later
//
// A service of small terrains, asked over HTTP: what the tests of its questions share.
#pragma once

#include <memory>
#include <mutex>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "engine/query/questions.h"
#include "storage/file/sigbus_guard.h"
#include "tests/tools/http_client.h"
#include "tests/tools/small_terrains.h"
#include "tools/serve/terrain_service.h"

namespace ptin::tools::testing {

/// Options for files that were built: collections `mountains` and `coast`, on two threads.
[[nodiscard]] serve::ServeOptions serve_options(const TestFolder& folder);

/// The service, and a client of it.
class ServedTerrains {
 public:
  explicit ServedTerrains(serve::ServeOptions options)
      : service_(options, [this](const std::string& line) { note(line); }),
        running_(options.http, service_),
        client_(running_.address()) {
    install_sigbus_guard();  // as `ptin serve` does
    service_.watch(&running_.server());
  }
  ~ServedTerrains() {
    running_.stop();
    service_.watch(nullptr);
  }

  HttpAnswer get(const std::string& target, const std::string& headers = {}) {
    return client_.get(target, headers);
  }
  HttpAnswer post(const std::string& target, const nlohmann::json& body) {
    return client_.ask("POST", target, "Content-Type: application/json\r\n", body.dump());
  }
  HttpAnswer ask(const std::string& method, const std::string& target, const std::string& headers,
                 const std::string& body) {
    return client_.ask(method, target, headers, body);
  }
  [[nodiscard]] const std::string& address() const { return running_.address(); }
  [[nodiscard]] serve::TerrainService& service() { return service_; }
  /// The lines of the log so far, as one text.
  [[nodiscard]] std::string log() const {
    const std::lock_guard lock(mutex_);
    return log_;
  }

 private:
  void note(const std::string& line) {
    const std::lock_guard lock(mutex_);
    log_.append(line).append("\n");
  }
  mutable std::mutex mutex_;
  std::string log_;
  serve::TerrainService service_;
  RunningServer running_;
  HttpClient client_;
};

/// A text as a value of a query.
[[nodiscard]] std::string encoded(const std::string& text);

/// A number as JSON has it: null where it is none.
void expect_number(const nlohmann::json& told, double number);

/// One service of two real terrains for all tests of a suite, since building takes longer than asking.
/// It offers its files, and every page may ask.
class Serve : public ::testing::Test {
 protected:
  static void SetUpTestSuite();
  static void TearDownTestSuite();

  static Window bounds_of(const Terrain& terrain);
  /// Somewhere in a terrain, or just beside it.
  static MapPoint some_place(const Terrain& terrain, std::mt19937_64& random);
  static Window middle_of_bounds(const Terrain& terrain, double share);
  static std::string text_of(const MapPoint& p);
  static std::string window_text(const Window& w);
  static std::string in(const std::string& id, const std::string& what) {
    return "/collections/" + id + "/" + what;
  }
  static HttpAnswer get(const std::string& target, const std::string& headers = {}) {
    return served_->get(target, headers);
  }

  static std::unique_ptr<TestFolder> folder_;
  static std::vector<serve::ServedFile> files_;
  static std::unique_ptr<ServedTerrains> served_;
  static std::unique_ptr<Terrain> mountains_, coast_;
};

/// Small hills elsewhere: `degrees` and `metres` across the antimeridian, `austria` whose CRS has
/// northings first, `feet` whose heights are in feet, `arctic` and `antarctic` around the poles, and
/// `ross` 3 km beside one, across the antimeridian.
class ServeElsewhere : public ::testing::Test {
 protected:
  static void SetUpTestSuite();
  static void TearDownTestSuite();
  static HttpAnswer get(const std::string& target) {
    return served_->get("/collections/" + target);
  }

  static std::unique_ptr<TestFolder> folder_;
  static std::vector<serve::ServedFile> files_;
  static std::unique_ptr<ServedTerrains> served_;
};

}  // namespace ptin::tools::testing
