// value: what a command takes. One list that parsing, --help, completion and the man page are made from.
#pragma once

#include <initializer_list>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace raysteer::host::cli {

/// One argument or option and the variable it fills. The variable's value at declaration is the default.
struct Option {
  /// An optional text tells one that is empty from none.
  using Target =
      std::variant<bool*, int*, double*, std::string*, std::optional<std::string>*, std::vector<std::string>*>;

  std::string name;   ///< "--calibration", "-v,--verbose"; for an argument its word in the help: "SESSION"
  std::string value;  ///< what stands for the value: "FILE", "DIR", "N"; empty for a flag
  std::string help;   ///< one line, no full stop
  Target target;
  bool positional = false;
  bool is_required = false;
  bool is_common = false;          ///< given to every command by the framework
  std::vector<std::string> words;  ///< when not empty, only these values

  Option& required() {
    is_required = true;
    return *this;
  }
  Option& choices(std::initializer_list<std::string> allowed) {
    words = allowed;
    return *this;
  }
  /// "--verbose" of "-v,--verbose"
  std::string_view long_name() const {
    const std::size_t comma = name.find(',');
    return comma == std::string::npos ? std::string_view(name) : std::string_view(name).substr(comma + 1);
  }
};

/// Options in the order of --help. References returned stay good until the next call.
class Options {
 public:
  /// A word without dashes, in the order declared: `argument("SESSION", session_, "session file or its folder")`.
  Option& argument(std::string name, Option::Target target, std::string help);
  /// `option("--calibration", "FILE", file_, "calibration to scan with")`.
  Option& option(std::string name, std::string value, Option::Target target, std::string help);
  Option& flag(std::string name, bool& target, std::string help);

  const std::vector<Option>& all() const { return all_; }
  std::vector<Option>& all() { return all_; }

 private:
  std::vector<Option> all_;
};

}  // namespace raysteer::host::cli
