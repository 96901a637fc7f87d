// A capture from the pretend rig is a session like any other, and the same seed gives the same bytes.
#include <map>

#include "tests/contract/sim/sim_program.hpp"

namespace raysteer::sim {
namespace {

std::map<std::string, std::string> all_files(const fs::path& folder) {
  std::map<std::string, std::string> files;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    if (entry.is_regular_file()) {
      files[fs::relative(entry.path(), folder).string()] = support::read_all(entry.path());
    }
  }
  return files;
}

TEST_F(SimProgram, captures_a_session_that_its_own_check_accepts) {
  const support::Finished captured = capture({"--fault", "left.drop*2"});
  ASSERT_EQ(captured.exit_code, 0) << captured.out << captured.err;
  const nlohmann::json json = nlohmann::json::parse(captured.out, nullptr, false);
  EXPECT_GE(json.value("retaken", 0), 1) << captured.out;
  EXPECT_TRUE(fs::exists(out() / "truth.json"));
  const support::Finished checked = raysteer({"session", "check", (out() / "session.toml").string(), "--json"});
  EXPECT_EQ(checked.exit_code, 0) << checked.out;
}

TEST_F(SimProgram, same_seed_gives_the_same_bytes_with_one_thread_and_with_two) {
  ASSERT_EQ(capture({"--threads", "1"}).exit_code, 0);
  const auto one = all_files(out());
  fs::rename(out(), work() / "one");
  ASSERT_EQ(capture({"--threads", "2"}).exit_code, 0);
  EXPECT_GT(one.size(), 40U);
  EXPECT_TRUE(one == all_files(out()));
}

TEST_F(SimProgram, another_seed_is_another_rig) {
  ASSERT_EQ(capture({"--seed", "1"}).exit_code, 0);
  const auto one = all_files(out());
  fs::rename(out(), work() / "one");
  ASSERT_EQ(capture({"--seed", "2"}).exit_code, 0);
  EXPECT_NE(one.at("truth.json"), all_files(out()).at("truth.json"));
}

TEST_F(SimProgram, lists_every_fault_word_and_takes_a_picture_of_its_room) {
  const support::Finished listed = raysteer({"sim", "--faults", "--json"});
  ASSERT_EQ(listed.exit_code, 0) << listed.out;
  EXPECT_NE(listed.out.find("left.drop"), std::string::npos);
  const fs::path picture = work() / "room.png";
  const support::Finished taken = raysteer({"sim", "--board", "mock-small", "--picture", picture.string(), "--json"});
  ASSERT_EQ(taken.exit_code, 0) << taken.out << taken.err;
  EXPECT_EQ(support::read_all(picture).substr(1, 3), "PNG");
}

}  // namespace
}  // namespace raysteer::sim
