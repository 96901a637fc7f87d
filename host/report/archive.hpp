// bound to one thread: a result's members to JSON and back. Each structure lists its members once, in a function
// members(archive, value) of this namespace; Writer and Reader walk the list in turn.
#pragma once

#include <cmath>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <vector>

#include "host/report/result.hpp"

namespace raysteer::host::report {

using Json = nlohmann::ordered_json;

template <class Archive>
void members(Archive& archive, Grid& grid) {
  archive("columns", grid.columns);
  archive("rows", grid.rows);
  archive("values", grid.values);
}

template <class Archive>
void members(Archive& archive, Judgement& judgement) {
  archive("verdict", judgement.verdict);
  archive("summary", judgement.summary);
  archive("reasons", judgement.reasons);
  archive("advice", judgement.advice);
}

template <class Archive>
void members(Archive& archive, Fact& fact) {
  archive("name", fact.name);
  archive("value", fact.value);
}

class Writer {
 public:
  template <class T>
  void operator()(const char* key, T& value) {
    object_[key] = to_json(value);
  }
  template <class T>
  static Json write(T& value) {
    Writer writer;
    members(writer, value);
    return std::move(writer.object_);
  }

 private:
  static Json to_json(double value) {
    if (std::isfinite(value)) {
      return value;
    }
    return std::isinf(value) ? Json(value > 0 ? "infinite" : "-infinite") : Json();
  }
  static Json to_json(bool value) { return value; }
  static Json to_json(int value) { return value; }
  static Json to_json(std::int64_t value) { return value; }
  static Json to_json(std::string& value) { return value; }
  // Thousands of these: an array each, to a ten-thousandth of a pixel.
  static Json to_json(ResidualVector& value) {
    const auto round = [](double number) { return std::round(number * 1e4) / 1e4; };
    return Json::array({value.view, round(value.x), round(value.y), round(value.dx), round(value.dy), value.kept});
  }
  template <class T>
  static Json to_json(std::vector<T>& values) {
    Json array = Json::array();
    for (T& value : values) {
      array.push_back(to_json(value));
    }
    return array;
  }
  template <class T>
  requires std::is_class_v<T>
  static Json to_json(T& value) { return write(value); }

  Json object_ = Json::object();
};

// Throws nlohmann's exceptions or std::runtime_error; read_result turns them into an error.
class Reader {
 public:
  explicit Reader(const Json& object) : object_(object) {}
  template <class T>
  void operator()(const char* key, T& value) {
    try {
      from_json(object_.at(key), value);
    } catch (const Json::exception& error) {
      throw std::runtime_error(std::string(key) + ": " + error.what());
    }
  }

 private:
  static void from_json(const Json& json, double& value) {
    if (json.is_string()) {
      value = json.get<std::string>() == "infinite" ? HUGE_VAL : -HUGE_VAL;
    } else {
      value = json.is_null() ? kUnknown : json.get<double>();
    }
  }
  static void from_json(const Json& json, bool& value) { json.get_to(value); }
  static void from_json(const Json& json, int& value) { json.get_to(value); }
  static void from_json(const Json& json, std::int64_t& value) { json.get_to(value); }
  static void from_json(const Json& json, std::string& value) { json.get_to(value); }
  static void from_json(const Json& json, ResidualVector& value) {
    value = {json.at(0), json.at(1), json.at(2), json.at(3), json.at(4), json.at(5)};
  }
  template <class T>
  static void from_json(const Json& json, std::vector<T>& values) {
    values.clear();
    for (const Json& item : json) {
      from_json(item, values.emplace_back());
    }
  }
  static void from_json(const Json& json, Grid& grid) {
    Reader reader(json);
    members(reader, grid);
    if (grid.columns < 0 || grid.rows < 0 || grid.columns > 1000 || grid.rows > 1000 ||
        grid.values.size() != static_cast<std::size_t>(grid.columns * grid.rows)) {
      throw std::runtime_error("a map has " + std::to_string(grid.values.size()) + " values for " +
                               std::to_string(grid.columns) + " x " + std::to_string(grid.rows) + " cells");
    }
  }
  template <class T>
  requires std::is_class_v<T>
  static void from_json(const Json& json, T& value) {
    Reader reader(json);
    members(reader, value);
  }

  const Json& object_;
};

}  // namespace raysteer::host::report
