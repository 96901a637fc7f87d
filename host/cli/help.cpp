#include "host/cli/help.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <utility>
#include <vector>

#include "host/cli/parse.hpp"

namespace raysteer::host::cli {
namespace {

using Line = std::pair<std::string, std::string>;

// Two columns; the left one is as wide as its widest word.
std::string columns(const std::vector<Line>& lines) {
  std::size_t width = 0;
  for (const Line& line : lines) {
    width = std::max(width, line.first.size());
  }
  std::string text;
  for (const Line& line : lines) {
    text += fmt::format("  {:<{}}  {}\n", line.first, width, line.second);
  }
  return text;
}

std::string left_column(const Option& option) {
  if (option.positional) {
    return option.name;
  }
  std::string text = option.name;
  if (const std::size_t comma = text.find(','); comma != std::string::npos) {
    text.insert(comma + 1, " ");
  }
  return option.value.empty() ? text : text + " " + option.value;
}

std::string options_text(const Options& options) {
  std::vector<Line> arguments, own, common;
  for (const Option& option : options.all()) {
    std::string help = option.help;
    if (option.is_required && !option.positional) {
      help += " (required)";
    }
    (option.positional ? arguments : option.is_common ? common : own).emplace_back(left_column(option), help);
  }
  std::string text;
  const auto section = [&text](const char* title, const std::vector<Line>& lines) {
    if (!lines.empty()) {
      text += fmt::format("\n{}:\n{}", title, columns(lines));
    }
  };
  section("arguments", arguments);
  section("options", own);
  section("common options", common);
  return text;
}

std::string example_text(std::string_view example) {
  std::string text = "\nexample:\n";
  while (!example.empty()) {
    const std::size_t end = example.find('\n');
    text += fmt::format("  {}\n", example.substr(0, end));
    example.remove_prefix(end == std::string_view::npos ? example.size() : end + 1);
  }
  return text;
}

}  // namespace

std::unique_ptr<Declared> declare(Command& command) {
  auto declared = std::make_unique<Declared>();
  command.declare(declared->options);
  declare_common(command.manual(), declared->common, declared->help, declared->options);
  return declared;
}

std::string help_of_program(const CommandTable& table) {
  std::vector<Line> lines;
  for (const CommandRow& row : table.commands) {
    lines.emplace_back(row.path, row.make()->manual().summary);
  }
  return "raysteer - from frames of a projector and cameras to a calibration and a scan\n"
         "\nusage: raysteer COMMAND [options]\n\ncommands:\n" +
         columns(lines) + "\noptions:\n" +
         columns({{"-h, --help", "print this help; 'raysteer COMMAND --help' says more"},
                  {"--version", "print the version"}}) +
         "\nEvery result can be had as JSON (--json); exit codes are listed by 'raysteer help --man'.\n" +
         example_text("raysteer explain R0110");
}

std::string help_of_group(const CommandTable& table, const GroupRow& group) {
  std::vector<Line> lines;
  std::string example;
  for (const CommandRow& row : table.commands) {
    if (row.path.starts_with(std::string(group.name) + " ")) {
      const std::unique_ptr<Command> command = row.make();
      lines.emplace_back(row.path, command->manual().summary);
      if (example.empty()) {
        example = command->manual().example;
      }
    }
  }
  return fmt::format("raysteer {} - {}\n\nusage: raysteer {} COMMAND [options]\n\ncommands:\n{}{}", group.name,
                     group.summary, group.name, columns(lines), example_text(example));
}

std::string usage_of_command(std::string_view path, const Options& options) {
  std::string text = fmt::format("raysteer {} [options]", path);
  for (const Option& option : options.all()) {
    if (option.positional) {
      const bool many = std::holds_alternative<std::vector<std::string>*>(option.target);
      const std::string word = option.name + (many ? "..." : "");
      text += option.is_required ? " " + word : " [" + word + "]";
    }
  }
  for (const Option& option : options.all()) {
    if (!option.positional && option.is_required) {
      text += fmt::format(" {} {}", option.long_name(), option.value);
    }
  }
  return text;
}

std::string help_of_command(std::string_view path, const Manual& manual, const Options& options) {
  std::string text =
      fmt::format("raysteer {} - {}\n\nusage: {}\n", path, manual.summary, usage_of_command(path, options));
  if (!manual.description.empty()) {
    text += fmt::format("\n{}\n", manual.description);
  }
  return text + options_text(options) + example_text(manual.example);
}

}  // namespace raysteer::host::cli
