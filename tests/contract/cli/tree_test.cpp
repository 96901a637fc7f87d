// Walks the whole command tree: what is promised of every command.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <set>
#include <sstream>

#include "host/cli/complete.hpp"
#include "host/cli/find_command.hpp"
#include "host/cli/help.hpp"
#include "host/cli/manual.hpp"
#include "host/cli/parse.hpp"
#include "tests/contract/cli/program.hpp"

namespace raysteer::host::cli {
namespace {

namespace fs = std::filesystem;

std::vector<std::string> words_of(const std::string& line) {
  std::istringstream stream(line);
  std::vector<std::string> words;
  for (std::string word; stream >> word;) {
    words.push_back(word);
  }
  return words;
}

std::string with_dashes(std::string_view path) {
  std::string name(path);
  std::ranges::replace(name, ' ', '-');
  return name;
}

bool offers(const std::vector<std::string>& typed, const std::string& word) {
  return std::ranges::any_of(complete(all_commands(), typed),
                             [&](const std::string& line) { return line.substr(0, line.find('\t')) == word; });
}

class EveryCommand : public ::testing::TestWithParam<CommandRow> {
 protected:
  EveryCommand() : command(GetParam().make()), declared(declare(*command)), manual(command->manual()) {}
  std::unique_ptr<Command> command;
  std::unique_ptr<Declared> declared;
  Manual manual;
};

TEST_P(EveryCommand, has_help_that_ends_with_an_example) {
  EXPECT_FALSE(manual.summary.empty());
  EXPECT_FALSE(manual.summary.ends_with("."));
  std::vector<std::string> words = words_of(std::string(GetParam().path));
  words.emplace_back("--help");
  const support::Finished done = raysteer(words);
  EXPECT_EQ(done.exit_code, 0);
  EXPECT_EQ(done.out, help_of_command(GetParam().path, manual, declared->options));
  EXPECT_GT(done.out.find("\nexample:\n"), done.out.find("\ncommon options:\n"));
  for (const Option& option : declared->options.all()) {
    EXPECT_FALSE(option.help.empty()) << option.name;
    EXPECT_FALSE(option.help.ends_with(".")) << option.name;
  }
}

TEST_P(EveryCommand, has_examples_that_are_understood) {
  std::istringstream lines{std::string(manual.example)};
  bool own = false;
  for (std::string line; std::getline(lines, line);) {
    const std::size_t start = line.find("raysteer ");
    ASSERT_NE(start, std::string::npos) << line;
    const std::vector<std::string> words =
        words_of(line.substr(start + 9, line.find_first_of("|)", start) - start - 9));
    const Result<Found> found = find_command(all_commands(), words);
    ASSERT_TRUE(found) << line;
    ASSERT_NE(found->command, nullptr) << line;
    const std::unique_ptr<Command> named = found->command->make();
    const std::unique_ptr<Declared> options = declare(*named);
    const Status parsed = parse(options->options, options->help, found->rest);
    EXPECT_TRUE(parsed) << line << ": " << (parsed ? "" : parsed.error().note);
    own = own || found->command->path == GetParam().path;
  }
  EXPECT_TRUE(own) << "no example shows the command itself";
}

TEST_P(EveryCommand, speaks_json_by_a_documented_schema) {
  static const std::set<std::string_view> kTextOnly{"help", "completion"};
  EXPECT_EQ(manual.has_json, !kTextOnly.contains(GetParam().path));
  const fs::path schema = support::source_root() / "docs" / "json" / (with_dashes(GetParam().path) + ".schema.json");
  EXPECT_EQ(fs::exists(schema), manual.has_json) << schema;
  if (manual.has_json) {
    EXPECT_TRUE(parse_one(support::read_all(schema)).is_object()) << schema;
  }
}

TEST_P(EveryCommand, completes_its_name_and_its_options) {
  std::vector<std::string> typed = words_of(std::string(GetParam().path));
  const std::string last = typed.back();
  typed.back() = last.substr(0, last.size() / 2);
  EXPECT_TRUE(offers(typed, last));
  typed.back() = last;
  for (const Option& option : declared->options.all()) {
    if (!option.positional) {
      typed.emplace_back("--");
      EXPECT_TRUE(offers(typed, std::string(option.long_name()))) << option.name;
      typed.back() = option.long_name();
      typed.emplace_back("");
      for (const std::string& word : option.words) {
        EXPECT_TRUE(offers(typed, word)) << option.name << " " << word;
      }
      typed.resize(typed.size() - 2);
    }
  }
}

TEST_P(EveryCommand, is_in_the_manual_and_in_the_documents) {
  const std::string man = raysteer({"help", "--man"}).out;
  EXPECT_NE(man.find(".SS raysteer " + std::string(GetParam().path)), std::string::npos);
  const std::string text = support::read_all(support::source_root() / "docs" / "cli.md");
  EXPECT_NE(text.find("`raysteer " + std::string(GetParam().path)), std::string::npos) << "docs/cli.md lacks it";
}

TEST_P(EveryCommand, belongs_to_a_group_with_a_summary) {
  const std::size_t space = GetParam().path.find(' ');
  if (space != std::string_view::npos) {
    EXPECT_NE(std::ranges::find(all_commands().groups, GetParam().path.substr(0, space), &GroupRow::name),
              all_commands().groups.end());
  }
}

INSTANTIATE_TEST_SUITE_P(Tree, EveryCommand,
                         ::testing::ValuesIn(all_commands().commands.begin(), all_commands().commands.end()),
                         [](const auto& row) {
                           std::string name = with_dashes(row.param.path);
                           std::ranges::replace(name, '-', '_');
                           return name;
                         });

TEST(Completion, leaves_files_and_folders_to_the_shell) {
  EXPECT_EQ(complete(all_commands(), {"scan", ""}), std::vector<std::string>{":files"});
  EXPECT_EQ(complete(all_commands(), {"scan", "--out", ""}), std::vector<std::string>{":dirs"});
  EXPECT_EQ(complete(all_commands(), {"report", "--json", "x"}), std::vector<std::string>{":dirs"});
  EXPECT_TRUE(complete(all_commands(), {"nonsense", ""}).empty());
}

TEST(Completion, works_in_bash) {
  const std::string program = (support::program_folder() / "raysteer").string();
  const support::Finished done = support::run_program(
      {"bash", "-c",
       "PATH=\"$(dirname " + program +
           "):$PATH\"; eval \"$(raysteer completion bash)\"; COMP_WORDS=(raysteer target pr); "
           "COMP_CWORD=2; _raysteer; printf '%s ' \"${COMPREPLY[@]}\"; COMP_WORDS=(raysteer explain --li); _raysteer; "
           "printf '%s' \"${COMPREPLY[@]}\""});
  EXPECT_EQ(done.out, "print --list") << done.err;
}

// It has no date, so that the package's bytes do not depend on the day.
TEST(ManualPage, is_clean_to_mandoc) {
  if (support::run_program({"sh", "-c", "command -v mandoc"}).exit_code != 0) {
    GTEST_SKIP() << "mandoc is not installed";
  }
  const std::string program = (support::program_folder() / "raysteer").string();
  const support::Finished done =
      support::run_program({"sh", "-c", program + " help --man | mandoc -T lint -W warning | grep -v 'missing date'"});
  EXPECT_EQ(done.out + done.err, "");
}

TEST(Documents, list_every_error_as_the_table_has_it) {
  EXPECT_EQ(support::read_all(support::source_root() / "docs" / "errors.md"), errors_markdown())
      << "run: build/release/bin/raysteer explain --markdown > docs/errors.md";
}

TEST(Program, says_its_version) {
  EXPECT_TRUE(raysteer({"--version"}).out.starts_with("raysteer 0."));
  EXPECT_EQ(raysteer({"--help"}).out, help_of_program(all_commands()));
}

}  // namespace
}  // namespace raysteer::host::cli
