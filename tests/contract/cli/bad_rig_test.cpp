// Bad input of the steered rig's commands, through the program: each is refused with its own code, and nothing is left.
#include <fstream>
#include <iterator>
#include <string>

#include "calib/model/steered_parameters.hpp"
#include "host/exchange/rig_file.hpp"
#include "host/rig/drawing.hpp"
#include "host/rig/read_files.hpp"
#include "tests/contract/cli/bad_input.hpp"

namespace raysteer::bad_input {
namespace {

class BadRig : public BadInput {
 protected:
  /// The board's drawing as if it had been calibrated, 3.5 m above a floor.
  static calib::steer::Solution drawn(const std::string& board_name) {
    const auto board = host::rig::read_board((support::source_root() / "boards" / (board_name + ".toml")).string());
    EXPECT_TRUE(board) << board.error().message();
    calib::steer::Solution solution;
    solution.projector = host::rig::drawing_of(*board)->projector;
    solution.cameras = host::rig::cameras_of(*board);
    solution.repeatability_rad = 20e-6;
    const int cameras = solution.cameras.count(0) + solution.cameras.count(1);
    const int all = cameras + solution.projector_parameters();
    for (int k = 0; k < all; ++k) {
      solution.parameters.push_back("p" + std::to_string(k));
    }
    solution.covariance = 1e-10 * Eigen::MatrixXd::Identity(all, all);
    solution.cameras.covariance = solution.covariance.topLeftCorner(cameras, cameras);
    return solution;
  }

  fs::path rig(bool tied, const std::string& board = "mock-small") const {
    const calib::steer::Solution solution = drawn(board);
    const Eigen::Index n = solution.covariance.rows();
    std::optional<host::exchange::RoomTie> room;
    if (tied) {
      room = host::exchange::RoomTie{.T_rig_room = {Eigen::Quaterniond(0, 1, 0, 0), {0, 0, 3.5}},
                                     .covariance = 1e-10 * Eigen::MatrixXd::Identity(n + 6, n + 6),
                                     .datums = 6};
    }
    return write(tied ? "tied/rig.toml" : "untied/rig.toml",
                 host::exchange::to_toml(solution, room, {.session = "", .board = board, .verdict = "good"}))
        .parent_path();
  }

  fs::path write(const std::string& name, const std::string& text) const {
    const fs::path file = work() / name;
    fs::create_directories(file.parent_path());
    std::ofstream(file, std::ios::binary) << text;
    return file;
  }

  fs::path stations(
      const std::string& keys = "position_m = [0, 0, 0]\nsize_m = [0.5, 0.3125]\ntolerance_mm = 5\n") const {
    return write("stations.toml", "format = 1\nname = \"s\"\n\n[[station]]\nname = \"a\"\n" + keys);
  }

  Outcome run(std::vector<std::string> words) const {
    fs::create_directories(results());
    words.insert(words.end(), {"--out", (results() / "out").string(), "--json"});
    return run_raysteer(words);
  }
  Outcome bake(const fs::path& rig, const fs::path& stations) const {
    return run({"bake", "--rig", rig.string(), "--stations", stations.string()});
  }
  static std::string text_of(const fs::path& file) {
    std::ifstream stream(file);
    return {std::istreambuf_iterator<char>(stream), {}};
  }
};

TEST_F(BadRig, what_is_not_there_is_named) {
  const fs::path good = rig(true);
  for (const Outcome& outcome :
       {bake(work() / "none", stations()), bake(good, work() / "none.toml"),
        run({"verify", (work() / "none").string(), "--rig", good.string(), "--stations", stations().string()}),
        run({"calibrate", "rig", (work() / "none").string(), "--cameras", "none", "--board", "mock-small"}),
        run({"plan", "looks", "--board", "no-such-board"})}) {
    EXPECT_EQ(outcome.exit_code, 3) << outcome.printed;
    EXPECT_FALSE(outcome.error_code().empty());
    EXPECT_TRUE(fs::is_empty(results()));
  }
}

TEST_F(BadRig, a_rig_that_is_tied_to_no_room_has_no_stations) {
  expect_refused(bake(rig(false), stations()), RCode::kDatumsMissing);
}

TEST_F(BadRig, stations_beyond_reach_and_in_other_units_are_refused) {
  const fs::path good = rig(true);
  const std::string rest = "size_m = [0.5, 0.3125]\ntolerance_mm = 5\n";
  expect_refused(bake(good, stations("position_m = [40, 0, 0]\n" + rest)), RCode::kStationOutOfReach);
  expect_refused(bake(good, stations("position_m = [0, 0, 9]\n" + rest)), RCode::kStationOutOfReach);  // behind
  expect_refused(bake(good, stations("position_m = [900, -1200, 0]\n" + rest)), RCode::kBadValue);     // millimetres
  expect_refused(bake(good, stations("position_mm = [900, 0, 0]\n" + rest)), RCode::kUnknownKey);
  expect_refused(bake(good, stations("position_m = [nan, 0, 0]\n" + rest)), RCode::kBadValue);
  expect_refused(bake(good, stations("position_m = [0, 0, 0]\nsize_m = [500, 312.5]\ntolerance_mm = 5\n")),
                 RCode::kBadValue);
  expect_refused(bake(good, stations("position_m = [0, 0, 0]\n" + rest + "content = \"../x.png\"\n")),
                 RCode::kPathOutside);
}

TEST_F(BadRig, a_rig_file_that_was_spoiled_is_refused) {
  const fs::path good = rig(true);
  const std::string text = text_of(good / "rig.toml");
  const auto spoiled = [&](const std::string& all) { return bake(write("spoiled/rig.toml", all), stations()); };
  std::string edited = text;
  edited.replace(edited.find("datums = 6"), 10, "datums = 9");
  expect_refused(spoiled(edited), RCode::kBadCalibrationFile);  // its id
  expect_refused(spoiled(text.substr(0, text.size() / 2)), RCode::kTomlSyntax);
  expect_refused(spoiled("format = \"raysteer-calibration\"\nformat_version = 1\n"), RCode::kBadCalibrationFile);
  expect_refused(spoiled(""), RCode::kBadCalibrationFile);
}

TEST_F(BadRig, plans_that_cannot_be_are_refused) {
  expect_refused(run({"plan", "looks", "--board", "mock-small", "--looks", "4"}), RCode::kTooFewLooks);
  for (const char* distance : {"-1", "0", "nan", "3500"}) {
    const Outcome outcome = run({"plan", "looks", "--board", "mock-small", "--distance", distance});
    EXPECT_NE(outcome.exit_code, 0) << distance;
    EXPECT_FALSE(outcome.error_code().empty()) << distance << ": " << outcome.printed;
    EXPECT_TRUE(fs::is_empty(results()));
  }
}

TEST_F(BadRig, a_session_that_looks_at_nothing_of_it_is_refused) {
  // A session of a fixed projector: two cameras, coded, but no mirror.
  const Outcome verified =
      run({"verify", scan_session().string(), "--rig", rig(true).string(), "--stations", stations().string()});
  EXPECT_GT(verified.exit_code, 0);
  EXPECT_FALSE(verified.error_code().empty()) << verified.printed;
  EXPECT_TRUE(fs::is_empty(results()));
  const Outcome calibrated = run(
      {"calibrate", "rig", scan_session().string(), "--cameras", true_calibration().string(), "--board", "mock-small"});
  EXPECT_GT(calibrated.exit_code, 0);
  EXPECT_FALSE(calibrated.error_code().empty()) << calibrated.printed;
  EXPECT_TRUE(fs::is_empty(results()));
}

TEST_F(BadRig, a_calibration_of_more_than_the_two_cameras_is_refused_before_a_board_is_looked_for) {
  // Left, right, and the projector: one device more than the session has cameras.
  expect_refused(run({"calibrate", "rig", cameras_session().string(), "--cameras", true_calibration().string(),
                      "--board", "mock-small", "--plane", "view_00"}),
                 RCode::kCalibrationMismatch);
}

TEST_F(BadRig, cameras_that_a_board_file_draws_otherwise_are_looked_for_in_that_file) {
  const Outcome outcome =
      run({"calibrate", "rig", cameras_session().string(), "--cameras", "drawn", "--board", "mock-small-head"});
  expect_refused(outcome, RCode::kCalibrationMismatch);
  EXPECT_NE(outcome.printed.find("'mock-small-head'"), std::string::npos) << outcome.printed;
  EXPECT_EQ(outcome.printed.find("calibrate cameras"), std::string::npos) << outcome.printed;
}

// The session is one that could be opened: nothing else is wrong.
TEST_F(BadRig, lengths_that_are_none_are_told_before_the_session_is_opened) {
  const auto with = [&](const std::string& cameras, const std::vector<std::string>& more) {
    std::vector<std::string> words{"calibrate", "rig",       scan_session().string(), "--cameras", cameras,
                                   "--board",   "mock-small"};
    words.insert(words.end(), more.begin(), more.end());
    const Outcome outcome = run(words);
    EXPECT_EQ(outcome.exit_code, 2) << more[1];
    expect_refused(outcome, RCode::kUsage);
  };
  for (const char* length : {"3-7", "3=2.5", "3-3=2.5", "a-7=2", "3-7=0", "3-7=nan", "3-7=0x1p3", ""}) {
    with("drawn", {"--length", length});
  }
  for (const char* baseline : {"0", "-0.5", "half", "nan", "0.5 m", ""}) {
    with("drawn", {"--baseline", baseline});
  }
  with("drawn", {"--baseline", "0.5", "--length", "3-7=2.5"});
  with("cameras", {"--baseline", "0.5"});
  with("cameras", {"--length", "3-7=2.5"});
}

TEST_F(BadRig, reports_compare_rigs_with_rigs) {
  const fs::path good = rig(true);
  const Outcome tables = run({"bake", "--rig", good.string(), "--stations", stations().string()});
  ASSERT_LE(tables.exit_code, 5) << tables.printed;
  const std::string out = (results() / "out").string();
  EXPECT_EQ(run_raysteer({"report", out, "--json"}).exit_code, 0);
  const Outcome compared = run_raysteer({"report", out, "--previous", good.string(), "--json"});
  EXPECT_EQ(compared.error_code(), to_string(RCode::kBadValue)) << compared.printed;
  EXPECT_EQ(run_raysteer({"report", out, "--stations", stations().string(), "--json"}).error_code(),
            to_string(RCode::kBadValue));
}

}  // namespace
}  // namespace raysteer::bad_input
