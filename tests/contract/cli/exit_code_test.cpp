#include "host/cli/exit_code.hpp"

#include <gtest/gtest.h>

#include <fstream>

#include "tests/contract/cli/program.hpp"

namespace raysteer::host::cli {
namespace {

using support::Finished;
using support::ScratchFolder;

TEST(ExitCode, is_0_when_done) {
  const Finished done = raysteer({"explain", "R0110"});
  EXPECT_EQ(done.exit_code, 0);
  EXPECT_TRUE(done.out.starts_with("R0110 (frame-missing): a frame file is missing\n")) << done.out;
  EXPECT_EQ(done.err, "");
}

TEST(ExitCode, is_1_when_input_is_bad) {
  const ScratchFolder folder;
  std::ofstream(folder / "result.json") << "{\"format_version\": 1}";
  const Finished done = raysteer({"report", folder.path().string()});
  EXPECT_EQ(done.exit_code, 1);
  EXPECT_TRUE(done.err.starts_with("error[R0107]: a value is not usable: ")) << done.err;
  EXPECT_NE(done.err.find("\ncause: "), std::string::npos);
  EXPECT_NE(done.err.find("\nremedy: "), std::string::npos);
  EXPECT_EQ(done.out, "");
}

TEST(ExitCode, is_2_when_the_command_line_is_not_understood) {
  for (const std::vector<std::string>& words : std::vector<std::vector<std::string>>{
           {"expain"},
           {"session", "chekc"},
           {"explain", "--lst"},
           {"explain", "R0110", "more"},
           {"explain"},
           {"target", "print", "--columns", "nine", "--rows", "6", "--square-mm", "20"},
           {"target", "print", "--columns", "9", "--rows", "6"},
           {"target", "print", "--columns", "9", "--rows", "6", "--square-mm", "nan"},
           {"completion", "tcsh"},
           {},
           {"session"},
           {"--json"}}) {
    EXPECT_EQ(raysteer(words).exit_code, 2) << (words.empty() ? "" : words.front());
  }
}

TEST(ExitCode, is_3_when_something_is_not_there) {
  EXPECT_EQ(raysteer({"report", "/no/such/folder"}).exit_code, 3);
  EXPECT_EQ(raysteer({"explain", "R9999"}).exit_code, 3);
  EXPECT_EQ(raysteer({"session", "check", "/no/such/session.toml"}).exit_code, 3);
}

TEST(ExitCode, is_4_when_refused) {
  const ScratchFolder folder;
  std::ofstream(folder / "thesis.txt") << "years of work";
  const Finished done = raysteer({"session", "render", "--out", folder.path().string()});
  EXPECT_EQ(done.exit_code, 4);
  EXPECT_NE(done.err.find("error[R0502]"), std::string::npos) << done.err;
  EXPECT_NE(done.err.find("thesis.txt"), std::string::npos);
  EXPECT_EQ(support::read_all(folder / "thesis.txt"), "years of work");
}

TEST(ExitCode, is_one_number_for_every_error) {
  for (const RCode rcode : all_rcodes()) {
    const int code = static_cast<int>(exit_code(rcode));
    EXPECT_GE(code, 1);
    EXPECT_LE(code, 9);
    EXPECT_NE(exit_code(rcode), ExitCode::kVerdictRedo) << "5 is no error, but a verdict";
  }
}

TEST(ExitCode, is_documented) {
  const std::string text = support::read_all(support::source_root() / "docs" / "cli.md");
  for (const ExitCodeRow& row : all_exit_codes()) {
    EXPECT_NE(text.find("| " + std::to_string(static_cast<int>(row.code)) + " | " + std::string(row.meaning) + " |"),
              std::string::npos)
        << row.meaning;
  }
}

TEST(Usage, names_the_nearest_word) {
  EXPECT_NE(raysteer({"expain"}).err.find("did you mean 'explain'?"), std::string::npos);
  EXPECT_NE(raysteer({"check"}).err.find("did you mean 'session check'?"), std::string::npos);
  EXPECT_NE(raysteer({"session", "chekc"}).err.find("did you mean 'check'?"), std::string::npos);
  EXPECT_NE(raysteer({"scan", "x.toml", "--calibartion", "c.toml"}).err.find("did you mean '--calibration'?"),
            std::string::npos);
  EXPECT_NE(raysteer({"explain", "frame-mising"}).err.find("did you mean 'frame-missing'?"), std::string::npos);
}

TEST(Usage, fails_as_json_when_asked) {
  for (const std::vector<std::string>& words : std::vector<std::vector<std::string>>{
           {"expain", "--json"}, {"--json", "report", "/no/such"}, {"report", "--json"}}) {
    const Finished done = raysteer(words);
    EXPECT_NE(done.exit_code, 0);
    EXPECT_EQ(done.err, "");
    const nlohmann::json object = parse_one(done.out);
    ASSERT_TRUE(object.is_object()) << done.out;
    EXPECT_EQ(object.at("error").at("code").get<std::string>().size(), 5U);
    EXPECT_FALSE(object.at("error").at("message").get<std::string>().empty());
    EXPECT_FALSE(object.at("error").at("remedy").get<std::string>().empty());
  }
}

TEST(StandardOutput, that_is_full_is_an_error) {
  const std::string program = (support::program_folder() / "raysteer").string();
  const Finished done = support::run_program({"/bin/sh", "-c", program + " explain --list > /dev/full"});
  EXPECT_EQ(done.exit_code, 1);
  EXPECT_NE(done.err.find("error[R0115]: the disk is full: standard output"), std::string::npos) << done.err;
}

TEST(StandardOutput, whose_reader_left_is_none) {
  const std::string program = (support::program_folder() / "raysteer").string();
  const Finished done =
      support::run_program({"/bin/bash", "-c", program + " explain --list --json | true; exit ${PIPESTATUS[0]}"});
  EXPECT_EQ(done.exit_code, 0);
  EXPECT_EQ(done.err, "");
}

TEST(Color, shows_only_where_it_is_wanted) {
  EXPECT_EQ(raysteer({"explain", "R9999"}).err.find('\033'), std::string::npos) << "not in a file";
  EXPECT_NE(raysteer({"explain", "R9999", "--color=always"}).err.find("\033[1;31merror[R0504]:\033[0m"),
            std::string::npos);
}

}  // namespace
}  // namespace raysteer::host::cli
