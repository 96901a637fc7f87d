// Bad calibration sessions from end to end, through the program.
#include <opencv2/aruco.hpp>

#include "tests/contract/cli/bad_input.hpp"

namespace raysteer::bad_input {
namespace {

TEST_F(BadInput, a_camera_nudged_half_way_through_a_calibration_is_named) {
  Stage stage = cameras_stage(support::small_pretend_rig(), support::kPretendSeed, 12);
  for (std::size_t view = stage.looks.size() / 2; view < stage.looks.size(); ++view) {
    calib::synth::Sensor& right = stage.looks[view].sensors[1];
    right.T_camera_rig = nudge(0.01) * right.T_camera_rig;
  }
  expect_refused(calibrate_cameras(render(stage)), RCode::kCameraMovedDuringCapture);
}

TEST_F(BadInput, a_target_of_another_size_is_refused) {
  const fs::path session = render(cameras_stage(support::small_pretend_rig(), support::kPretendSeed, 4));
  edit_session(session, "columns = 9", "columns = 8");
  edit_session(session, "rows = 6", "rows = 5");
  expect_refused(calibrate_cameras(session), RCode::kWrongTarget);
}

TEST_F(BadInput, a_target_without_scale_is_refused) {
  const fs::path session = copy(cameras_session());
  edit_session(session, "square_m = 0.03\n", "");
  expect_refused(calibrate_cameras(session), RCode::kTargetScaleMissing);
}

TEST_F(BadInput, too_few_views_are_refused) {
  const fs::path session = render(cameras_stage(support::small_pretend_rig(), support::kPretendSeed, 2));
  expect_refused(calibrate_cameras(session), RCode::kTooFewViews);
}

TEST_F(BadInput, views_in_parallel_planes_are_refused) {
  Stage stage = cameras_stage(support::small_pretend_rig(), support::kPretendSeed, 12);
  for (std::size_t view = 0; view < stage.looks.size(); ++view) {
    calib::model::Pose& pose = stage.looks[view].scene.plates.front().T_rig_plate;
    pose = {};  // always frontal; only place and distance change
    pose.t = {-0.13 + 0.01 * static_cast<double>(view % 4), -0.08 + 0.01 * static_cast<double>(view / 4),
              0.7 + 0.02 * static_cast<double>(view)};
  }
  expect_refused(calibrate_cameras(render(stage)), RCode::kCoplanarViews);
}

TEST_F(BadInput, one_view_of_another_target_is_left_out_by_name) {
  Stage stage = cameras_stage(support::small_pretend_rig(), support::kPretendSeed, 12);
  TargetSpec other = stage.target;
  other.square_m = 0.027;
  stage.looks[5].scene.plates.front().print = std::make_shared<const calib::synth::Print>(other);
  const fs::path session = render(stage);
  const Outcome outcome = calibrate_cameras(session);
  // The eleven others are a calibration; the odd one is named, and never fitted.
  EXPECT_NE(outcome.printed.find("view 'view_05' was left out"), std::string::npos) << outcome.printed;
  EXPECT_NE(outcome.json.value("verdict", ""), "good") << outcome.printed;
  EXPECT_EQ(outcome.printed.find("view 'view_04' was left out"), std::string::npos) << outcome.printed;
}

TEST_F(BadInput, a_mirrored_target_is_refused) {
  Stage stage = cameras_stage(support::small_pretend_rig(), support::kPretendSeed, 6);
  TargetSpec& target = stage.target;
  target.kind = TargetKind::kCharuco;
  target.columns = 7;
  target.rows = 5;
  target.square_m = 0.042;
  target.marker_m = 0.03;
  target.dictionary = "4X4_50";
  target.layout = CharucoLayout::kCurrent;
  calib::synth::MarkerCells cells{6, {}};
  const auto dictionary = cv::aruco::getPredefinedDictionary(cv::aruco::DICT_4X4_50);
  for (int id = 0; id < target.columns * target.rows / 2; ++id) {
    cv::Mat drawn;
    cv::aruco::drawMarker(dictionary, id, cells.side, drawn, 1);
    std::transform(drawn.begin<std::uint8_t>(), drawn.end<std::uint8_t>(), std::back_inserter(cells.cells),
                   [](std::uint8_t grey) { return grey > 0 ? std::uint8_t{1} : std::uint8_t{0}; });
  }
  const auto print = std::make_shared<const calib::synth::Print>(target, cells);
  for (calib::synth::StagedLook& look : stage.looks) {
    look.scene.plates.front() = target_plate(look.scene.plates.front().T_rig_plate, print, 0.02);
  }
  const fs::path session = render(stage);
  const Outcome upright = calibrate_cameras(session);
  EXPECT_NE(upright.error_code(), to_string(RCode::kMirroredTarget)) << upright.printed;
  fs::remove_all(results());
  rewrite_frames(session, [](const Image<std::uint8_t>& image) {
    Image<std::uint8_t> mirrored = image.clone();
    for (int y = 0; y < mirrored.height(); ++y) {
      std::reverse(mirrored.row(y), mirrored.row(y) + mirrored.width());
    }
    return mirrored;
  });
  expect_refused(calibrate_cameras(session), RCode::kMirroredTarget);
}

TEST_F(BadInput, a_projector_session_without_a_lit_target_is_refused) {
  const fs::path session = copy(projector_session());
  rewrite_frames(session,
                 [](const Image<std::uint8_t>& image) { return Image<std::uint8_t>(image.width(), image.height()); });
  expect_refused(calibrate_projector(session), RCode::kFramesBlack);
}

}  // namespace
}  // namespace raysteer::bad_input
