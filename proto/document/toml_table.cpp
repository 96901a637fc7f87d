#include "proto/document/toml_table.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <utility>

#include "hal/base/nearest.hpp"

namespace raysteer::proto::document {
namespace {

std::string_view type_name(const toml::node& node) {
  switch (node.type()) {
    case toml::node_type::string:
      return "text";
    case toml::node_type::integer:
      return "a whole number";
    case toml::node_type::floating_point:
      return "a number";
    case toml::node_type::boolean:
      return "true or false";
    case toml::node_type::array:
      return "an array";
    case toml::node_type::table:
      return "a table";
    default:
      return "a date or time";
  }
}

// "max_angle" of "max_angle_mrad".
std::string_view stem(std::string_view key) { return key.substr(0, key.rfind('_')); }

std::string shortest(double value) {
  std::array<char, 32> text{};
  const auto end = std::to_chars(text.data(), text.data() + text.size(), value).ptr;
  return {text.data(), end};
}

}  // namespace

std::string place(const toml::node& node) {
  const toml::source_region& source = node.source();
  return (source.path ? *source.path : std::string("text")) + ":" + std::to_string(std::max(source.begin.line, 1U));
}

void Faults::add(Error error) {
  std::optional<Error>& slot = error.rcode == RCode::kUnknownKey ? unknown_ : other_;
  if (!slot) {
    slot = std::move(error);
  }
}

Status Faults::status() const {
  if (unknown_) {
    return *unknown_;
  }
  if (other_) {
    return *other_;
  }
  return ok();
}

TomlTable::TomlTable(std::vector<const toml::table*> layers, std::string what, Faults& faults)
    : layers_(std::move(layers)), what_(std::move(what)), faults_(&faults) {}

const toml::node* TomlTable::find(std::string_view key) {
  known_.emplace(key);
  for (const toml::table* layer : layers_) {
    if (const toml::node* node = layer->get(key)) {
      return node;
    }
  }
  return nullptr;
}

bool TomlTable::has(std::string_view key) const {
  return std::ranges::any_of(layers_, [&](const toml::table* layer) { return layer->contains(key); });
}

std::string TomlTable::key_name(std::string_view key) const {
  return "'" + std::string(key) + "'" + (what_.empty() ? "" : " of " + what_);
}

void TomlTable::fault(RCode rcode, std::string_view key, const std::string& note) {
  const toml::node* node = find(key);
  faults_->add(fail(rcode, place(node != nullptr ? *node : *layers_.front()) + ": " + key_name(key) + " " + note));
}

void TomlTable::wrong_type(const toml::node& node, std::string_view key, std::string_view expected) {
  faults_->add(fail(RCode::kBadValue, place(node) + ": " + key_name(key) + " must be " + std::string(expected) +
                                          ", got " + std::string(type_name(node))));
}

void TomlTable::missing(std::string_view key) {
  faults_->add(fail(RCode::kMissingKey, place(*layers_.front()) + ": " + key_name(key)));
}

std::string TomlTable::text(std::string_view key, const std::optional<std::string>& fallback) {
  const toml::node* node = find(key);
  if (node == nullptr) {
    if (!fallback) {
      missing(key);
    }
    return fallback.value_or("");
  }
  if (!node->is_string()) {
    wrong_type(*node, key, "text in quotes");
    return fallback.value_or("");
  }
  return node->as_string()->get();
}

std::int64_t TomlTable::integer(std::string_view key, Range<std::int64_t> range, std::optional<std::int64_t> fallback) {
  if (find(key) == nullptr && !fallback) {
    missing(key);
    return range.least;
  }
  return maybe_integer(key, range).value_or(fallback.value_or(range.least));
}

std::optional<std::int64_t> TomlTable::maybe_integer(std::string_view key, Range<std::int64_t> range) {
  const toml::node* node = find(key);
  if (node == nullptr) {
    return std::nullopt;
  }
  if (!node->is_integer()) {
    wrong_type(*node, key, "a whole number");
    return std::nullopt;
  }
  const std::int64_t value = node->as_integer()->get();
  if (value < range.least || value > range.most) {
    fault(RCode::kBadValue, key,
          "must be " + std::to_string(range.least) + " to " + std::to_string(range.most) + ", got " +
              std::to_string(value));
    return std::nullopt;
  }
  return value;
}

double TomlTable::number(std::string_view key, Range<double> range, std::optional<double> fallback,
                         std::string_view hint) {
  const toml::node* node = find(key);
  if (node == nullptr) {
    if (!fallback) {
      missing(key);
    }
    return fallback.value_or(range.least);
  }
  if (!node->is_number()) {
    wrong_type(*node, key, "a number");
    return fallback.value_or(range.least);
  }
  const double value =
      node->is_integer() ? static_cast<double>(node->as_integer()->get()) : node->as_floating_point()->get();
  if (!(value >= range.least && value <= range.most)) {  // NaN, too
    fault(RCode::kBadValue, key,
          "must be " + shortest(range.least) + " to " + shortest(range.most) + ", got " + shortest(value) +
              (hint.empty() ? "" : "; " + std::string(hint)));
    return fallback.value_or(range.least);
  }
  return value;
}

bool TomlTable::flag(std::string_view key, bool fallback) {
  const toml::node* node = find(key);
  if (node == nullptr) {
    return fallback;
  }
  if (!node->is_boolean()) {
    wrong_type(*node, key, "true or false");
    return fallback;
  }
  return node->as_boolean()->get();
}

std::vector<double> TomlTable::numbers(std::string_view key) {
  std::vector<double> values;
  const toml::node* node = find(key);
  if (node == nullptr) {
    return values;
  }
  const toml::array* array = node->as_array();
  if (array == nullptr || array->empty()) {
    wrong_type(*node, key, "an array of numbers");
    return values;
  }
  for (const toml::node& element : *array) {
    const std::optional<double> value = element.value<double>();
    if (!element.is_number() || !value || !std::isfinite(*value)) {
      wrong_type(element, key, "an array of finite numbers");
      return {};
    }
    values.push_back(*value);
  }
  return values;
}

std::vector<std::vector<double>> TomlTable::matrix(std::string_view key) {
  std::vector<std::vector<double>> rows;
  const toml::node* node = find(key);
  if (node == nullptr) {
    return rows;
  }
  const toml::array* array = node->as_array();
  if (array == nullptr) {
    wrong_type(*node, key, "an array of rows");
    return rows;
  }
  for (const toml::node& element : *array) {
    const toml::array* numbers = element.as_array();
    std::vector<double>& row = rows.emplace_back();
    for (std::size_t i = 0; numbers != nullptr && i < numbers->size(); ++i) {
      const toml::node& number = (*numbers)[i];
      const std::optional<double> value = number.value<double>();
      if (!number.is_number() || !value || !std::isfinite(*value)) {
        wrong_type(number, key, "rows of finite numbers");
        return {};
      }
      row.push_back(*value);
    }
    if (numbers == nullptr || row.size() != rows.front().size()) {
      wrong_type(element, key, "rows of " + std::to_string(rows.front().size()) + " numbers each");
      return {};
    }
  }
  return rows;
}

std::vector<std::int64_t> TomlTable::integers(std::string_view key) {
  std::vector<std::int64_t> values;
  const toml::node* node = find(key);
  if (node == nullptr) {
    return values;
  }
  const toml::array* array = node->as_array();
  if (array == nullptr) {
    wrong_type(*node, key, "an array of whole numbers");
    return values;
  }
  for (const toml::node& element : *array) {
    if (!element.is_integer()) {
      wrong_type(element, key, "an array of whole numbers");
      return {};
    }
    values.push_back(element.as_integer()->get());
  }
  return values;
}

std::vector<std::string> TomlTable::texts(std::string_view key) {
  std::vector<std::string> values;
  const toml::node* node = find(key);
  if (node == nullptr) {
    return values;
  }
  if (node->is_string()) {
    return {node->as_string()->get()};
  }
  const toml::array* array = node->as_array();
  if (array == nullptr || array->empty()) {
    wrong_type(*node, key, "an array of texts");
    return values;
  }
  for (const toml::node& element : *array) {
    if (!element.is_string()) {
      wrong_type(element, key, "an array of texts");
      return {};
    }
    values.push_back(element.as_string()->get());
  }
  return values;
}

int TomlTable::choice(std::string_view key, const std::vector<std::string_view>& choices, std::optional<int> fallback) {
  if (find(key) == nullptr) {
    if (!fallback) {
      missing(key);
    }
    return fallback.value_or(0);
  }
  const std::string value = text(key);
  const auto found = std::ranges::find(choices, std::string_view(value));
  if (found != choices.end()) {
    return static_cast<int>(found - choices.begin());
  }
  if (!value.empty() || find(key)->is_string()) {
    std::string note = "is '" + value + "'";
    note += did_you_mean(value, choices) + " Known:";
    for (const std::string_view known : choices) {
      note += " " + std::string(known);
    }
    fault(RCode::kBadValue, key, note);
  }
  return fallback.value_or(0);
}

std::optional<TomlTable> TomlTable::table(std::string_view key) {
  const toml::node* node = find(key);
  if (node == nullptr) {
    return std::nullopt;
  }
  if (!node->is_table()) {
    wrong_type(*node, key, "a table");
    return std::nullopt;
  }
  std::vector<const toml::table*> layers;
  for (const toml::table* layer : layers_) {
    if (const toml::node* found = layer->get(key); found != nullptr && found->is_table()) {
      layers.push_back(found->as_table());
    }
  }
  return TomlTable(std::move(layers), "[" + std::string(key) + "]", *faults_);
}

std::vector<TomlTable> TomlTable::tables(std::string_view key) {
  std::vector<TomlTable> all;
  const toml::node* node = find(key);
  if (node == nullptr) {
    return all;
  }
  if (node->is_table()) {
    all.push_back(*table(key));
    return all;
  }
  const toml::array* array = node->as_array();
  if (array == nullptr) {
    wrong_type(*node, key, "a table or an array of tables");
    return all;
  }
  for (const toml::node& element : *array) {
    if (!element.is_table()) {
      wrong_type(element, key, "an array of tables");
      return {};
    }
    all.emplace_back(std::vector{element.as_table()}, "[[" + std::string(key) + "]] " + std::to_string(all.size() + 1),
                     *faults_);
  }
  return all;
}

void TomlTable::finish() {
  const std::vector<std::string_view> known(known_.begin(), known_.end());
  for (const toml::table* layer : layers_) {
    for (const auto& [key, node] : *layer) {
      if (known_.contains(key.str())) {
        continue;
      }
      const std::string name = "'" + std::string(key.str()) + "'" + (what_.empty() ? "" : " in " + what_);
      const bool other_unit = stem(nearest(key.str(), known)) == stem(key.str());
      faults_->add(fail(RCode::kUnknownKey, place(node) + ": " + name + did_you_mean(key.str(), known) +
                                                (other_unit ? " The unit is part of the name." : "")));
      return;
    }
  }
}

}  // namespace raysteer::proto::document
