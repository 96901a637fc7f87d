// What a rendered rig must not be solved from, spoilt in its files as it goes wrong in a hall, and what is said
// instead.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <string>
#include <vector>

#include "tests/support/technician.hpp"

namespace raysteer {
namespace {

namespace fs = std::filesystem;
using support::Technician;

std::string replaced(std::string text, const std::string& what, const std::string& by) {
  const auto at = text.find(what);
  EXPECT_NE(at, std::string::npos) << what;
  return at == std::string::npos ? text : text.replace(at, what.size(), by);
}

class RenderedFaults : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    rig_ = new Technician("mock-small");
    rig_->calibrate();
  }
  static void TearDownTestSuite() { delete rig_; }

  static std::string file(const std::string& path) { return support::read_all(support::source_root() / path); }

  /// The error's code and message; nothing else may come out.
  static nlohmann::json refusal(const std::string& looks, const std::string& cameras, const std::string& board,
                                const std::string& survey) {
    const auto said =
        rig_->run({"calibrate", "rig", looks, "--cameras", cameras, "--board", board, "--survey", survey}, 1);
    return said.value("error", nlohmann::json::object());
  }
  static std::string survey() { return Technician::data("steered/data/survey.toml"); }

  static Technician* rig_;
};

Technician* RenderedFaults::rig_ = nullptr;

TEST_F(RenderedFaults, an_axis_that_turns_the_other_way_is_named) {
  rig_->write("reversed.toml", replaced(file("boards/mock-small.toml"), "axis = [0, 1, 0]", "axis = [0, -1, 0]"));
  const auto error = refusal(rig_->made("looks"), rig_->made("cameras"), rig_->in("reversed.toml"), survey());
  EXPECT_EQ(error.at("code"), "R0903") << error;
  EXPECT_NE(error.at("message").get<std::string>().find("axis 1 is reversed"), std::string::npos) << error;
}

TEST_F(RenderedFaults, a_board_of_wrong_scale_is_found_by_the_datums) {
  fs::copy(rig_->made("cameras-session"), rig_->in("wrong-session"), fs::copy_options::recursive);
  rig_->write("wrong-session/session.toml", replaced(support::read_all(rig_->made("cameras-session/session.toml")),
                                                     "square_m = 0.055", "square_m = 0.056"));
  rig_->run({"calibrate", "cameras", rig_->in("wrong-session"), "--out", rig_->in("wrong-cameras")});
  const auto error = refusal(rig_->made("looks"), rig_->in("wrong-cameras"), "mock-small", survey());
  EXPECT_EQ(error.at("code"), "R0910") << error;
}

TEST_F(RenderedFaults, a_datum_that_was_moved_is_named) {
  rig_->write("moved.toml",
              replaced(file("tests/rig/steered/data/survey.toml"), "[0.2, 1.6, 0.0005]", "[0.23, 1.6, 0.0005]"));
  const auto error = refusal(rig_->made("looks"), rig_->made("cameras"), "mock-small", rig_->in("moved.toml"));
  EXPECT_EQ(error.at("code"), "R0914") << error;
  EXPECT_NE(error.at("message").get<std::string>().find("d1"), std::string::npos) << error;
}

TEST_F(RenderedFaults, a_mirror_that_was_knocked_half_way_is_not_averaged_away) {
  rig_->capture(Technician::room(), rig_->made("plan/looks.toml"), rig_->in("knocked"),
                {"--fault", "mirror.bump=5e-3@20s"});
  const auto error = refusal(rig_->in("knocked"), rig_->made("cameras"), "mock-small", survey());
  EXPECT_EQ(error.at("code"), "R0905") << error;
}

/// A plan's looks from number `first` on.
std::string later_looks(const std::string& plan, std::size_t first) {
  std::string text = plan.substr(0, plan.find("\n[[look]]"));
  std::size_t at = plan.find("\n[[look]]");
  for (std::size_t k = 0; k < first; ++k) {
    at = plan.find("\n[[look]]", at + 1);
  }
  return text + plan.substr(at);
}

// By 10 mm along the floor, as between two looks of one capture: half-way through it, and before its last look.
TEST_F(RenderedFaults, a_rig_that_was_pushed_between_two_looks_is_not_averaged_away) {
  rig_->write("pushed.toml", replaced(support::read_all(Technician::room()), "[0, 0, 3.5]", "[0.01, 0, 3.5]"));
  rig_->write("later.toml", later_looks(support::read_all(rig_->made("plan/looks.toml")), 7));
  rig_->capture(rig_->in("pushed.toml"), rig_->in("later.toml"), rig_->in("after"));
  std::vector<std::string> after;
  for (const auto& look : fs::directory_iterator(rig_->in("after/left"))) {
    after.push_back(look.path().filename());
  }
  ASSERT_EQ(after.size(), 6U);
  const std::string last = "look-10";
  ASSERT_NE(std::ranges::find(after, last), after.end());
  for (const auto& moved : {after, std::vector{last}}) {
    const std::string session = rig_->in("pushed-" + std::to_string(moved.size()));
    fs::copy(rig_->made("looks"), session, fs::copy_options::recursive);
    for (const std::string& look : moved) {
      for (const std::string eye : {"/left/", "/right/"}) {
        ASSERT_GT(fs::remove_all(session + eye + look), 0U);
        fs::copy(rig_->in("after") + eye + look, session + eye + look);
      }
    }
    const auto error = refusal(session, rig_->made("cameras"), "mock-small", survey());
    EXPECT_EQ(error.at("code"), "R0905") << error;
  }
}

}  // namespace
}  // namespace raysteer
