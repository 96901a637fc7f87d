// bound to one thread: a TOML table read key by key, so that a key nobody asked for is an error.
//
// A table may have layers: the same table in the file itself and in the files it includes; the first that has a key
// wins. Getters never fail: they note the fault and give the fallback, so that reading code stays a list of keys.
#pragma once

#include <cstdint>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

// No exceptions: a syntax error comes back as a value. No assertions either: toml++ 3.3 asserts (and with NDEBUG lets
// the compiler assume) that a key follows '[', which "[@]" from outside makes untrue; the code behind the assertion
// reports it properly. NDEBUG is hidden because it turns TOML_ASSERT into that assumption.
#define TOML_EXCEPTIONS 0
#define TOML_ASSERT(expression) static_assert(true)
#pragma push_macro("NDEBUG")
#undef NDEBUG
#include <toml++/toml.h>
#pragma pop_macro("NDEBUG")

#include "hal/base/result.hpp"

namespace raysteer::proto::session {

/// The faults found while reading. Unknown keys outrank the rest: a misspelt key usually makes a missing one, too.
class Faults {
 public:
  void add(Error error);
  Status status() const;
  bool any() const { return unknown_ || other_; }

 private:
  std::optional<Error> unknown_;
  std::optional<Error> other_;
};

template <class Number>
struct Range {
  Number least;
  Number most;
};

class TomlTable {
 public:
  /// `what` names the table in messages: "[[camera]] 2". At least one layer; all outlive this.
  TomlTable(std::vector<const toml::table*> layers, std::string what, Faults& faults);

  // Without a fallback the key is required. Faults: kMissingKey, kBadValue (wrong type, out of range).
  std::string text(std::string_view key, std::optional<std::string> fallback = {});
  std::int64_t integer(std::string_view key, Range<std::int64_t> range, std::optional<std::int64_t> fallback = {});
  /// Any finite number, with or without decimal point. `hint` is added to the message of a value out of range.
  double number(std::string_view key, Range<double> range, std::optional<double> fallback = {},
                std::string_view hint = {});
  bool flag(std::string_view key, bool fallback);
  std::optional<std::int64_t> maybe_integer(std::string_view key, Range<std::int64_t> range);
  std::vector<double> numbers(std::string_view key);
  /// An array of arrays of finite numbers, rows of equal length.
  std::vector<std::vector<double>> matrix(std::string_view key);
  std::vector<std::int64_t> integers(std::string_view key);
  /// An array of text, or one text alone.
  std::vector<std::string> texts(std::string_view key);
  /// One of `choices`; the fault suggests the nearest. Gives its place in the list.
  int choice(std::string_view key, const std::vector<std::string_view>& choices, std::optional<int> fallback = {});
  std::optional<TomlTable> table(std::string_view key);
  /// An array of tables, or one table alone.
  std::vector<TomlTable> tables(std::string_view key);

  bool has(std::string_view key) const;
  /// Notes a fault of ours about a key of this table (or about the table, when it is not there), with file and line.
  void fault(RCode rcode, std::string_view key, const std::string& note);
  /// Every key was asked for? Otherwise kUnknownKey with the nearest known one. To be called last.
  void finish();

 private:
  const toml::node* find(std::string_view key);
  void wrong_type(const toml::node& node, std::string_view key, std::string_view expected);
  void missing(std::string_view key);
  std::string key_name(std::string_view key) const;

  std::vector<const toml::table*> layers_;
  std::string what_;
  Faults* faults_;
  std::set<std::string, std::less<>> known_;
};

/// "demo.toml:12"
std::string place(const toml::node& node);

}  // namespace raysteer::proto::session
