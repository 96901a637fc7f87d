// Bad input from end to end, through the program: each fault is refused with its own code, and nothing stays behind.
#include <optional>

#include "tests/contract/cli/bad_input.hpp"

namespace raysteer::bad_input {
namespace {

// What is good must pass, or the refusals below would mean nothing.

TEST_F(BadInput, good_sessions_are_accepted) {
  EXPECT_EQ(check(scan_session()).exit_code, 0);
  const Outcome scanned = scan(scan_session());
  EXPECT_EQ(scanned.exit_code, 0) << scanned.printed;
  EXPECT_EQ(scanned.json.value("verdict", ""), "good") << scanned.printed;
  EXPECT_LT(scanned.json.value("/truth/surface_rms_m"_json_pointer, 1.0), 0.001);
}

// Frames

TEST_F(BadInput, a_missing_frame_is_named) {
  const fs::path session = copy(scan_session());
  fs::remove(frame(session, 7));
  const Outcome outcome = scan(session);
  expect_refused(outcome, RCode::kFrameMissing);
  EXPECT_NE(outcome.printed.find("look_0_07.png"), std::string::npos) << outcome.printed;
}

TEST_F(BadInput, a_truncated_frame_is_refused) {
  const fs::path session = copy(scan_session());
  const std::string bytes = support::read_all(frame(session, 20));
  write_text(frame(session, 20), bytes.substr(0, bytes.size() / 2));
  expect_refused(scan(session), RCode::kFileTruncated);
}

TEST_F(BadInput, a_frame_of_another_size_is_refused) {
  const fs::path session = copy(scan_session());
  write_png(frame(session, 20), Image<std::uint8_t>(160, 128));
  expect_refused(scan(session), RCode::kFrameSize);
}

TEST_F(BadInput, a_16_bit_set_marked_8_bit_is_refused) {
  const fs::path session = copy(scan_session());
  rewrite_frames(session, [](const Image<std::uint8_t>& image) {
    Image<std::uint16_t> deep(image.width(), image.height());
    std::transform(image.data(), image.data() + image.size(), deep.data(),
                   [](std::uint8_t dn) { return static_cast<std::uint16_t>(dn * 257); });
    return deep;
  });
  expect_refused(scan(session), RCode::kFrameDepth);
}

TEST_F(BadInput, frames_in_the_wrong_order_are_refused) {
  const fs::path session = copy(scan_session());
  // Two bits exchange their places, pattern and inverse together.
  swap_files(frame(session, 4), frame(session, 8));
  swap_files(frame(session, 5), frame(session, 9));
  expect_refused(scan(session), RCode::kFramesOutOfOrder);
}

TEST_F(BadInput, a_doubled_frame_is_refused) {
  const fs::path session = copy(scan_session());
  fs::remove(frame(session, 10));
  fs::copy(frame(session, 8), frame(session, 10));
  expect_refused(scan(session), RCode::kFramesDoubled);
}

TEST_F(BadInput, a_missed_trigger_is_refused) {
  const fs::path session = copy(scan_session());
  // One frame came twice and the rest moved on by one.
  for (int index = scan_sequence().frames() - 1; index > 9; --index) {
    fs::rename(frame(session, index - 1), frame(session, index));
  }
  fs::copy(frame(session, 8), frame(session, 9));
  expect_refused(scan(session), RCode::kFramesOutOfOrder);
}

TEST_F(BadInput, inverse_before_pattern_is_refused) {
  const fs::path session = copy(scan_session());
  const PatternSequence sequence = scan_sequence();
  for (const std::size_t block : {0U, 2U}) {
    for (int k = 0; k < sequence.blocks[block].bits; ++k) {
      const int index = first_frame(sequence, block) + 2 * k;
      for (const char* camera : {"left", "right"}) {
        swap_files(frame(session, index, camera), frame(session, index + 1, camera));
      }
    }
  }
  expect_refused(scan(session), RCode::kInverseSwapped);
}

TEST_F(BadInput, black_frames_are_refused) {
  const fs::path session = copy(scan_session());
  rewrite_frames(session, [](const Image<std::uint8_t>& image) {
    Image<std::uint8_t> dark(image.width(), image.height());
    dark.fill(2);
    return dark;
  });
  expect_refused(scan(session), RCode::kFramesBlack);
}

TEST_F(BadInput, saturated_frames_are_refused) {
  const fs::path session = copy(scan_session());
  rewrite_frames(session, [](const Image<std::uint8_t>& image) {
    Image<std::uint8_t> bright = image.clone();
    for (std::uint8_t& dn : std::span(bright.data(), bright.size())) {
      dn = static_cast<std::uint8_t>(std::min(255, 8 * dn));
    }
    return bright;
  });
  expect_refused(scan(session), RCode::kFramesSaturated);
}

TEST_F(BadInput, a_scene_that_moves_between_frames_is_refused) {
  const fs::path session = copy(scan_session());
  Stage moved = scan_stage(support::small_pretend_rig(), support::kPretendSeed);
  moved.name = "moved";
  for (calib::synth::Sensor& sensor : moved.looks.front().sensors) {
    sensor.T_camera_rig = nudge(0.01) * sensor.T_camera_rig;  // 4 camera px
  }
  const fs::path other = render(moved);
  for (int index = scan_sequence().frames() / 2; index < scan_sequence().frames(); ++index) {
    for (const char* camera : {"left", "right"}) {
      fs::rename(frame(other, index, camera), frame(session, index, camera));
    }
  }
  expect_refused(scan(session), RCode::kSceneMoved);
}

// Rigs that move

TEST_F(BadInput, a_pair_nudged_between_calibration_and_scan_is_no_good_scan) {
  Stage stage = scan_stage(support::small_pretend_rig(), support::kPretendSeed);
  stage.name = "nudged";
  calib::synth::Sensor& right = stage.looks.front().sensors[1];
  right.T_camera_rig = nudge(0.003) * right.T_camera_rig;
  const Outcome outcome = scan(render(stage));
  const double moved_rad = outcome.json.value("pose_moved_rad", 0.0);
  EXPECT_NE(outcome.exit_code, 0) << outcome.printed;
  EXPECT_EQ(outcome.json.value("verdict", ""), "redo") << outcome.printed;
  EXPECT_NEAR(moved_rad, 0.003, 0.0003);
  EXPECT_NE(outcome.printed.find("moved by"), std::string::npos) << outcome.printed;
}

TEST_F(BadInput, a_pair_nudged_far_between_calibration_and_scan_is_refused) {
  Stage stage = scan_stage(support::small_pretend_rig(), support::kPretendSeed);
  stage.name = "nudged";
  calib::synth::Sensor& right = stage.looks.front().sensors[1];
  right.T_camera_rig = nudge(0.03) * right.T_camera_rig;
  expect_refused(scan(render(stage)), RCode::kPoseMoved);
}

// Text

TEST_F(BadInput, an_unknown_key_is_refused_with_the_nearest_known_one) {
  const fs::path session = copy(scan_session());
  edit_session(session, "period_px", "periode_px");
  const Outcome outcome = scan(session);
  expect_refused(outcome, RCode::kUnknownKey);
  EXPECT_NE(outcome.printed.find("'period_px'"), std::string::npos) << outcome.printed;
}

TEST_F(BadInput, file_names_that_leave_the_session_are_refused) {
  const fs::path session = copy(scan_session());
  edit_session(session, "\"\\{camera\\}/", "\"../scan/{camera}/");
  expect_refused(scan(session), RCode::kPathOutside);
}

TEST_F(BadInput, links_that_leave_the_session_are_refused) {
  const fs::path session = copy(scan_session());
  fs::remove_all(session / "left");
  fs::create_directory_symlink(scan_session() / "left", session / "left");
  expect_refused(scan(session), RCode::kPathOutside);
}

TEST_F(BadInput, circular_includes_are_refused) {
  const fs::path session = copy(scan_session());
  edit_session(session, "format = 1\n", "format = 1\ninclude = [\"rig.toml\"]\n");
  write_text(session / "rig.toml", "include = [\"session.toml\"]\n");
  expect_refused(scan(session), RCode::kCircularInclude);
}

TEST_F(BadInput, a_calibration_with_nan_is_refused) {
  const fs::path file = true_calibration();
  const std::string text = support::read_all(file);
  write_text(file, std::regex_replace(text, std::regex("focal_px = .[0-9.e+-]+"), "focal_px = [nan",
                                      std::regex_constants::format_first_only));
  ASSERT_NE(support::read_all(file), text);
  expect_refused(scan_with(scan_session(), file), RCode::kNotFinite);
}

TEST_F(BadInput, a_calibration_of_other_cameras_is_refused) {
  Stage stage = scan_stage(calib::synth::pretend_rig(support::kPretendSeed, 0.4), support::kPretendSeed);
  stage.name = "other";
  expect_refused(scan(render(stage)), RCode::kCalibrationMismatch);
}

// Disks

/// What a shell says to run a program with `results` on a disk of 64 KiB that nobody else sees; nothing where the
/// system does not let us. The folder's content is listed into `listing`, since the disk goes with the program.
std::optional<std::string> on_a_tiny_disk(const fs::path& results, const fs::path& listing) {
  if (std::system("unshare -rm true 2>/dev/null") != 0) {
    return std::nullopt;
  }
  return "unshare -rm sh -c 'mount -t tmpfs -o size=64k tmpfs " + results.string() + " && \"$@\"; code=$?; ls -A " +
         results.string() + " > " + listing.string() + "; exit $code' sh";
}

TEST_F(BadInput, a_full_disk_leaves_nothing_half_written) {
  fs::create_directories(results());
  const fs::path listing = work() / "listing";
  const auto tiny = on_a_tiny_disk(results(), listing);
  if (!tiny) {
    GTEST_SKIP() << "no private disks here (unshare -rm)";
  }
  expect_refused(scan(scan_session(), *tiny), RCode::kDiskFull);
  EXPECT_EQ(support::read_all(listing), "");
}

TEST_F(BadInput, a_file_that_may_not_grow_leaves_nothing_half_written_and_keeps_earlier_results) {
  // 64 blocks of 512 bytes: result.json would fit, the cloud does not.
  const std::string limit = "ulimit -f 64;";
  expect_refused(scan(scan_session(), limit), RCode::kWriteFailed);
  ASSERT_EQ(scan(scan_session()).exit_code, 0);
  const std::string before = support::read_all(results() / "out" / "result.json");
  ASSERT_FALSE(before.empty());
  EXPECT_EQ(scan(scan_session(), limit).error_code(), to_string(RCode::kWriteFailed));
  EXPECT_EQ(support::read_all(results() / "out" / "result.json"), before);
  EXPECT_EQ(std::distance(fs::directory_iterator(results()), {}), 1) << "a temporary folder was left behind";
}

}  // namespace
}  // namespace raysteer::bad_input
