// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/serve/client_json.h"

#include <string>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

#include "engine/stop.h"
#include "tools/http/problem.h"

namespace ptin::serve {

namespace {

using http::Problem;

/// Builds the value while the text is read. Every event adds to the end of what is open, so no event
/// looks at what came before it but for the name of a member.
class Builder : public nlohmann::json::json_sax_t {
 public:
  Builder(std::string_view name, const JsonBounds& bounds)
      : name_(name), bounds_(bounds), values_left_(bounds.memory_bytes / kBytesOfValue) {}

  bool null() override { return place(nullptr); }
  bool boolean(bool value) override { return place(value); }
  bool number_integer(nlohmann::json::number_integer_t value) override { return place(value); }
  bool number_unsigned(nlohmann::json::number_unsigned_t value) override { return place(value); }
  bool number_float(nlohmann::json::number_float_t value, const std::string&) override {
    return place(value);
  }
  bool string(std::string& value) override { return place(std::move(value)); }
  bool binary(nlohmann::json::binary_t&) override { return false; }  // Which no text holds.
  bool start_object(std::size_t) override { return open(nlohmann::json::object()); }
  bool start_array(std::size_t) override { return open(nlohmann::json::array()); }
  bool end_object() override { return close(); }
  bool end_array() override { return close(); }

  bool key(std::string& name) override {
    if (open_.back()->contains(name)) {
      throw Problem(400, "the member " + http::shown(name) + " of the JSON is given twice")
          .at(name_);
    }
    member_ = std::move(name);
    return true;
  }
  bool parse_error(std::size_t, const std::string&,
                   const nlohmann::json::exception& error) override {
    constexpr int kOutOfRange = 406;
    if (error.id == kOutOfRange) {
      throw Problem(400, "a number of the JSON is larger than any that is answered, 1.8e308")
          .at(name_);
    }
    throw Problem(400, "this is no JSON").at(name_);
  }

  [[nodiscard]] nlohmann::json take() { return std::move(root_); }

 private:
  nlohmann::json& add(nlohmann::json value) {
    constexpr std::uint64_t kBetweenLooks = 4096;
    if (values_left_-- == 0) {
      throw Problem(413,
                    "the JSON holds more values than the memory of a question does, " +
                        std::to_string(bounds_.memory_bytes / kBytesOfValue) +
                        "; ask in parts, or have whoever runs the service give more with --limit "
                        "question_memory=SIZE")
          .at(name_)
          .beyond("question_memory");
    }
    if (values_left_ % kBetweenLooks == 0) stop_if_asked(bounds_.stop, "reading the JSON");
    if (open_.empty()) return root_ = std::move(value);
    nlohmann::json& parent = *open_.back();
    if (parent.is_object()) return parent[member_] = std::move(value);
    parent.push_back(std::move(value));
    return parent.back();
  }
  bool place(nlohmann::json value) {
    add(std::move(value));
    return true;
  }
  bool open(nlohmann::json value) {
    if (open_.size() >= static_cast<std::size_t>(bounds_.most_deep)) {
      throw Problem(400, "the JSON is deeper than " + std::to_string(bounds_.most_deep) + " levels")
          .at(name_);
    }
    open_.push_back(&add(std::move(value)));
    return true;
  }
  bool close() {
    open_.pop_back();
    return true;
  }

  std::string name_;
  const JsonBounds& bounds_;
  std::uint64_t values_left_;
  nlohmann::json root_;
  std::vector<nlohmann::json*>
      open_;  ///< An array has only its last value open, so that none moves.
  std::string member_;
};

}  // namespace

nlohmann::json json_of_client(std::string_view text, std::string_view name,
                              const JsonBounds& bounds) {
  Builder builder(name, bounds);
  if (!nlohmann::json::sax_parse(text.begin(), text.end(), &builder)) {
    throw Problem(400, "this is no JSON").at(std::string(name));
  }
  return builder.take();
}

}  // namespace ptin::serve
