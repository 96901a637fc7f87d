#include "host/cli/options.hpp"

#include <utility>

namespace raysteer::host::cli {

Option& Options::argument(std::string name, Option::Target target, std::string help) {
  Option& added = all_.emplace_back();
  added.name = name;
  added.value = std::move(name);
  added.help = std::move(help);
  added.target = target;
  added.positional = true;
  added.is_required = true;
  return added;
}

Option& Options::option(std::string name, std::string value, Option::Target target, std::string help) {
  Option& added = all_.emplace_back();
  added.name = std::move(name);
  added.value = std::move(value);
  added.help = std::move(help);
  added.target = target;
  return added;
}

Option& Options::flag(std::string name, bool& target, std::string help) {
  return option(std::move(name), "", &target, std::move(help));
}

}  // namespace raysteer::host::cli
