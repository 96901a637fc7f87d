#include "host/cli/find_command.hpp"

#include <algorithm>
#include <string_view>

#include "hal/base/nearest.hpp"

namespace raysteer::host::cli {
namespace {

std::string_view first_word(std::string_view path) { return path.substr(0, path.find(' ')); }
std::string_view last_word(std::string_view path) {
  const std::size_t space = path.rfind(' ');
  return space == std::string_view::npos ? path : path.substr(space + 1);
}

const CommandRow* by_path(const CommandTable& table, std::string_view path) {
  const auto row = std::ranges::find(table.commands, path, &CommandRow::path);
  return row == table.commands.end() ? nullptr : &*row;
}

Error no_such_command(const CommandTable& table, const std::string& word) {
  // "raysteer check" means "raysteer session check".
  for (const CommandRow& row : table.commands) {
    if (last_word(row.path) == word) {
      return fail(RCode::kUsage, "no command '" + word + "'; did you mean '" + std::string(row.path) + "'?");
    }
  }
  std::vector<std::string_view> known;
  for (const CommandRow& row : table.commands) {
    known.push_back(first_word(row.path));
  }
  return fail(RCode::kUsage, "no command '" + word + "'" + did_you_mean(word, known));
}

Error no_such_command_in(const CommandTable& table, const GroupRow& group, const std::string& word) {
  std::vector<std::string_view> known;
  std::string list;
  for (const CommandRow& row : table.commands) {
    if (row.path.starts_with(std::string(group.name) + " ")) {
      known.push_back(last_word(row.path));
      list += (list.empty() ? "" : ", ") + std::string(last_word(row.path));
    }
  }
  std::string hint = did_you_mean(word, known);
  if (hint.empty()) {
    hint = "; there are: " + list;
  }
  return fail(RCode::kUsage, "no command '" + std::string(group.name) + " " + word + "'" + hint);
}

}  // namespace

Result<Found> find_command(const CommandTable& table, const std::vector<std::string>& words) {
  Found found;
  auto word = words.begin();
  while (word != words.end() && word->starts_with('-')) {
    found.rest.push_back(*word++);
  }
  if (word == words.end()) {
    return found;
  }
  found.command = by_path(table, *word);
  if (found.command == nullptr) {
    const auto group = std::ranges::find(table.groups, std::string_view(*word), &GroupRow::name);
    if (group == table.groups.end()) {
      return no_such_command(table, *word);
    }
    ++word;
    while (word != words.end() && word->starts_with('-')) {
      found.rest.push_back(*word++);
    }
    if (word == words.end()) {
      found.group = &*group;
      return found;
    }
    found.command = by_path(table, std::string(group->name) + " " + *word);
    if (found.command == nullptr) {
      return no_such_command_in(table, *group, *word);
    }
  }
  found.rest.insert(found.rest.end(), word + 1, words.end());
  return found;
}

}  // namespace raysteer::host::cli
