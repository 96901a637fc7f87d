#include "host/cli/complete.hpp"

#include <algorithm>
#include <set>
#include <string_view>

#include "host/cli/find_command.hpp"
#include "host/cli/help.hpp"

namespace raysteer::host::cli {
namespace {

using Lines = std::vector<std::string>;

void offer(Lines& lines, const std::string& typed, std::string_view word, std::string_view meaning) {
  if (word.starts_with(typed)) {
    lines.push_back(std::string(word) + "\t" + std::string(meaning));
  }
}

Lines command_words(const CommandTable& table, const std::string& typed) {
  Lines lines;
  std::set<std::string_view> groups;
  for (const CommandRow& row : table.commands) {
    const std::size_t space = row.path.find(' ');
    if (space == std::string_view::npos) {
      offer(lines, typed, row.path, row.make()->manual().summary);
    } else if (groups.insert(row.path.substr(0, space)).second) {
      const auto group = std::ranges::find(table.groups, row.path.substr(0, space), &GroupRow::name);
      offer(lines, typed, row.path.substr(0, space), group == table.groups.end() ? "" : group->summary);
    }
  }
  if (typed.starts_with('-')) {
    offer(lines, typed, "--help", "print the help");
    offer(lines, typed, "--version", "print the version");
  }
  return lines;
}

Lines group_words(const CommandTable& table, const GroupRow& group, const std::string& typed) {
  Lines lines;
  const std::string prefix = std::string(group.name) + " ";
  for (const CommandRow& row : table.commands) {
    if (row.path.starts_with(prefix)) {
      offer(lines, typed, row.path.substr(prefix.size()), row.make()->manual().summary);
    }
  }
  return lines;
}

// The value of an option or an argument.
Lines values(const Option& option, const std::string& typed) {
  if (!option.words.empty()) {
    Lines lines;
    for (const std::string& word : option.words) {
      offer(lines, typed, word, option.help);
    }
    return lines;
  }
  if (option.value == "DIR") {
    return {":dirs"};
  }
  return option.value == "FILE" || option.value == "SESSION" ? Lines{":files"} : Lines{};
}

Lines option_words(const Options& options, const std::string& typed) {
  Lines lines;
  for (const Option& option : options.all()) {
    if (!option.positional) {
      offer(lines, typed, option.long_name(), option.help);
    }
  }
  return lines;
}

const Option* named(const Options& options, const std::string& word) {
  for (const Option& option : options.all()) {
    const std::string_view name = option.name;
    if (!option.positional && (option.long_name() == word || name.substr(0, name.find(',')) == word)) {
      return &option;
    }
  }
  return nullptr;
}

}  // namespace

std::vector<std::string> complete(const CommandTable& table, const std::vector<std::string>& words) {
  const std::string typed = words.empty() ? std::string() : words.back();
  const std::vector<std::string> before(words.begin(), words.empty() ? words.end() : words.end() - 1);
  const Result<Found> found = find_command(table, before);
  if (!found) {
    return {};
  }
  if (found->command == nullptr) {
    return found->group != nullptr ? group_words(table, *found->group, typed) : command_words(table, typed);
  }
  const std::unique_ptr<Command> command = found->command->make();
  const std::unique_ptr<Declared> declared = declare(*command);
  const Options& options = declared->options;
  if (!before.empty()) {
    const Option* last = named(options, before.back());
    if (last != nullptr && !last->value.empty()) {
      return values(*last, typed);
    }
  }
  if (typed.starts_with('-')) {
    return option_words(options, typed);
  }
  // Which argument is next: count the words that are neither options nor their values.
  std::size_t next = 0;
  for (std::size_t i = 0; i < found->rest.size(); ++i) {
    const Option* option = named(options, found->rest[i]);
    if (option != nullptr) {
      i += option->value.empty() ? 0 : 1;
    } else if (!found->rest[i].starts_with('-')) {
      ++next;
    }
  }
  for (const Option& option : options.all()) {
    const bool takes_more = std::holds_alternative<std::vector<std::string>*>(option.target);
    if (option.positional && (next-- == 0 || takes_more)) {
      return values(option, typed);
    }
  }
  return option_words(options, typed);
}

}  // namespace raysteer::host::cli
