#include "calib/datum/tie.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <random>

#include "tests/support/datum_room.hpp"
#include "tests/support/seed.hpp"

namespace raysteer::calib::datum {
namespace {

using support::datum_room;
using support::DatumRoom;

/// The left increment that takes the tie's pose to the true one.
Eigen::Matrix<double, 6, 1> error_of(const Tie& tie, const DatumRoom& room) {
  const Eigen::AngleAxisd turn(room.T_room_rig.q * tie.T_room_rig.q.conjugate());
  Eigen::Matrix<double, 6, 1> error;
  error << turn.angle() * turn.axis(), room.T_room_rig.t - tie.T_room_rig.t;
  return error;
}

int between(std::mt19937_64& random, int least, int most) {
  return std::uniform_int_distribution<int>(least, most)(random);
}

std::string name(const DatumRoom& room, std::size_t i) { return "'" + room.survey.datums[i].name + "'"; }

// Of 300 rigs, a true 95 % holds 270 to 298 in 9,999 of 10,000 runs (binomial); the chi-square's mean is then 1 within
// 0.13.
TEST(Tie, states_an_uncertainty_that_holds) {
  std::mt19937_64 random(support::seed());
  constexpr int kRigs = 300;
  int held = 0;
  double chi = 0, rms = 0, scales = 0;
  for (int i = 0; i < kRigs; ++i) {
    const DatumRoom room = datum_room(random, between(random, 4, 9));
    const auto got = tie_to_room(room.solved, room.survey, {room.look(random)});
    ASSERT_TRUE(got) << got.error().message();
    const auto error = error_of(*got, room);
    const double one = error.dot(got->cov.ldlt().solve(error));
    held += one < 12.592 ? 1 : 0;  // 95 % of chi-square with 6 degrees of freedom
    chi += one / 6 / kRigs;
    rms += got->whitened_rms * got->whitened_rms / kRigs;
    ASSERT_TRUE(got->scale);
    scales += std::pow((got->scale->value - 1) / got->scale->sigma, 2) / kRigs;
    EXPECT_EQ(got->dof, 3 * static_cast<int>(room.p_room.size()) - 6);
  }
  std::printf("held %d of %d, chi-square %.3f, misses %.3f, scale %.3f\n", held, kRigs, chi, rms, scales);
  EXPECT_GE(held, 270);
  EXPECT_LE(held, 298);
  EXPECT_NEAR(chi, 1, 0.15);
  EXPECT_NEAR(rms, 1, 0.15);
  EXPECT_NEAR(scales, 1, 0.35);
}

TEST(Tie, knows_how_its_error_goes_with_the_cameras) {
  std::mt19937_64 random(support::seed());
  // The true error of the pose along what the cameras' errors foretell of it, against that foretelling.
  double along = 0, foretold = 0;
  for (int i = 0; i < 60; ++i) {
    const DatumRoom room = datum_room(random, 6);
    const auto got = tie_to_room(room.solved, room.survey, {room.look(random)});
    ASSERT_TRUE(got);
    const auto error = error_of(*got, room);
    const Eigen::Matrix<double, 6, 1> expected =
        got->cov_cameras * room.solved.covariance.ldlt().solve(room.camera_errors);
    const Eigen::Matrix<double, 6, 1> weighted = got->cov.ldlt().solve(expected);
    along += error.dot(weighted);
    foretold += expected.dot(weighted);
  }
  EXPECT_NEAR(along / foretold, 1, 0.25);
}

TEST(Tie, of_several_looks_is_no_worse_than_of_one) {
  std::mt19937_64 random(support::seed());
  const DatumRoom room = datum_room(random, 6);
  std::vector<View> views;
  for (int i = 0; i < 8; ++i) {
    views.push_back(room.look(random, "look " + std::to_string(i)));
  }
  const auto one = tie_to_room(room.solved, room.survey, {views[0]});
  const auto all = tie_to_room(room.solved, room.survey, views);
  ASSERT_TRUE(one && all);
  EXPECT_LT(all->cov.trace(), one->cov.trace());
  EXPECT_LT(error_of(*all, room).dot(all->cov.ldlt().solve(error_of(*all, room))), 28);  // 1 in 10,000
}

// Upwards and downwards, four datums on a floor cannot tell which one moved; on the floor they can.
TEST(Tie, names_a_datum_moved_by_ten_millimetres) {
  std::mt19937_64 random(support::seed());
  std::normal_distribution<double> normal;
  constexpr int kRooms = 200;
  int named = 0, alone = 0;
  for (int i = 0; i < kRooms; ++i) {
    DatumRoom room = datum_room(random, between(random, 4, 8));
    const std::size_t count = room.p_room.size();
    const std::size_t moved = random() % count;
    Eigen::Vector3d way(normal(random), normal(random), count > 5 ? normal(random) : 0);
    room.p_room[moved] += 0.01 * way.normalized();
    const auto got = tie_to_room(room.solved, room.survey, {room.look(random)});
    ASSERT_FALSE(got);
    ASSERT_EQ(got.error().rcode, RCode::kDatumMoved) << got.error().message();
    named += got.error().note.starts_with(name(room, moved) + " by ") ? 1 : 0;
    alone += got.error().note.find(", or ") == std::string::npos ? 1 : 0;
  }
  std::printf("named %d of %d, %d without an alternative\n", named, kRooms, alone);
  EXPECT_GE(named, kRooms * 99 / 100);
  EXPECT_GE(alone, kRooms * 8 / 10);
}

TEST(Tie, says_by_how_much_a_datum_moved_and_goes_on_without_it) {
  std::mt19937_64 random(support::seed());
  DatumRoom room = datum_room(random, 6);
  room.p_room[2].x() += 0.02;
  const auto refused = tie_to_room(room.solved, room.survey, {room.look(random)});
  ASSERT_FALSE(refused);
  const double by = std::stod(refused.error().note.substr(refused.error().note.find(" by ") + 4));
  EXPECT_NEAR(by, 20, 3);
  const auto without =
      tie_to_room(room.solved, room.survey, {room.look(random)}, {.leave_out = {room.survey.datums[2].name}});
  ASSERT_TRUE(without) << without.error().message();
  EXPECT_EQ(without->misses.size(), 5U);
}

TEST(Tie, says_when_four_datums_cannot_tell_which_was_lifted) {
  std::mt19937_64 random(support::seed());
  DatumRoom room = datum_room(random, 4);
  room.p_room[1].z() += 0.04;
  const auto got = tie_to_room(room.solved, room.survey, {room.look(random)});
  ASSERT_FALSE(got);
  EXPECT_EQ(got.error().rcode, RCode::kDatumMoved);
  EXPECT_NE(got.error().note.find(name(room, 1)), std::string::npos) << got.error().note;
  EXPECT_NE(got.error().note.find("cannot tell which"), std::string::npos) << got.error().note;
}

TEST(Tie, names_two_datums_that_moved) {
  std::mt19937_64 random(support::seed());
  for (int i = 0; i < 20; ++i) {
    DatumRoom room = datum_room(random, 8);
    room.p_room[1].x() += 0.03;
    room.p_room[4].y() -= 0.02;
    const auto got = tie_to_room(room.solved, room.survey, {room.look(random)});
    ASSERT_FALSE(got);
    EXPECT_EQ(got.error().rcode, RCode::kDatumMoved);
    EXPECT_NE(got.error().note.find(name(room, 1)), std::string::npos) << got.error().note;
    EXPECT_NE(got.error().note.find(name(room, 4)), std::string::npos) << got.error().note;
  }
}

TEST(Tie, always_names_two_datums_exchanged_in_the_survey) {
  std::mt19937_64 random(support::seed());
  for (int i = 0; i < 60; ++i) {
    DatumRoom room = datum_room(random, between(random, 4, 9));
    const auto view = room.look(random);
    const std::size_t a = random() % room.p_room.size();
    const std::size_t b = (a + 1 + random() % (room.p_room.size() - 1)) % room.p_room.size();
    std::swap(room.survey.datums[a].code, room.survey.datums[b].code);
    const auto got = tie_to_room(room.solved, room.survey, {view});
    ASSERT_FALSE(got);
    ASSERT_EQ(got.error().rcode, RCode::kDatumsExchanged) << got.error().message();
    EXPECT_NE(got.error().note.find(name(room, a)), std::string::npos) << got.error().note;
    EXPECT_NE(got.error().note.find(name(room, b)), std::string::npos) << got.error().note;
  }
}

// Mirrored, four datums in a rectangle look the same from below the floor; nobody hangs a rig there.
TEST(Tie, does_not_take_an_exchange_for_a_rig_below_the_floor) {
  std::mt19937_64 random(support::seed());
  DatumRoom room = datum_room(random, 4);
  for (std::size_t i = 0; i < 4; ++i) {
    const Eigen::Vector3d corner = room.T_room_rig.t + Eigen::Vector3d(i % 2 == 0 ? -1 : 1, i < 2 ? -1.5 : 1.5, -3.5);
    room.p_room[i] = corner;
    room.survey.datums[i].position_m = {corner.x(), corner.y(), corner.z()};
  }
  const auto view = room.look(random);
  EXPECT_TRUE(tie_to_room(room.solved, room.survey, {view}));
  std::swap(room.survey.datums[0].code, room.survey.datums[1].code);
  std::swap(room.survey.datums[2].code, room.survey.datums[3].code);
  const auto got = tie_to_room(room.solved, room.survey, {view});
  ASSERT_FALSE(got);
  EXPECT_EQ(got.error().rcode, RCode::kDatumsExchanged) << got.error().message();
}

TEST(Tie, names_a_scale_that_is_wrong_by_one_percent) {
  std::mt19937_64 random(support::seed());
  for (int i = 0; i < 50; ++i) {
    DatumRoom room = datum_room(random, between(random, 4, 9));
    const auto view = room.look(random);
    const double scale = i % 2 == 0 ? 1.01 : 0.99;
    room.solved.devices[1].T_device_rig.t *= scale;  // as a board of squares said to be larger makes it
    const auto got = tie_to_room(room.solved, room.survey, {view});
    ASSERT_FALSE(got);
    ASSERT_EQ(got.error().rcode, RCode::kScaleWrong) << got.error().message();
    // The solved eyes' own scale is off by 0.03 %, one standard deviation.
    EXPECT_NEAR(std::stod(got.error().note.substr(got.error().note.find("measured ") + 9)), 1000 * scale, 1.5)
        << got.error().note;
  }
}

TEST(Tie, leaves_a_scale_alone_that_is_off_by_one_per_mille) {
  std::mt19937_64 random(support::seed());
  DatumRoom room = datum_room(random, 8);
  const auto view = room.look(random);
  room.solved.devices[1].T_device_rig.t *= 1.001;
  const auto got = tie_to_room(room.solved, room.survey, {view});
  ASSERT_TRUE(got) << got.error().message();
  ASSERT_TRUE(got->scale);
  EXPECT_NEAR(got->scale->value, 1.001, 4 * got->scale->sigma);
}

TEST(Tie, checks_known_lengths_that_calibration_never_used) {
  std::mt19937_64 random(support::seed());
  DatumRoom room = datum_room(random, 5);
  const double length = (room.p_room[0] - room.p_room[2]).norm();
  room.survey.lengths = {{.from = "datum 1", .to = "datum 3", .length_m = length, .sigma_mm = 0.2}};
  const auto view = room.look(random);
  const auto got = tie_to_room(room.solved, room.survey, {view});
  ASSERT_TRUE(got) << got.error().message();
  ASSERT_EQ(got->lengths.size(), 1U);
  EXPECT_NEAR(got->lengths[0].measured_m, length, 4 * got->lengths[0].sigma_m);
  EXPECT_TRUE(got->scale->by_lengths);
  room.survey.lengths[0].length_m *= 1.01;
  const auto wrong = tie_to_room(room.solved, room.survey, {view});
  ASSERT_FALSE(wrong);
  EXPECT_EQ(wrong.error().rcode, RCode::kScaleWrong);
  EXPECT_NE(wrong.error().note.find("from 'datum 1' to 'datum 3'"), std::string::npos);
}

TEST(Tie, with_fewer_than_three_datums_or_three_in_a_line_says_what_that_means) {
  std::mt19937_64 random(support::seed());
  DatumRoom room = datum_room(random, 4);
  View view = room.look(random);
  view.eyes[0].resize(2);
  auto got = tie_to_room(room.solved, room.survey, {view});
  ASSERT_FALSE(got);
  EXPECT_EQ(got.error().rcode, RCode::kDatumsMissing);
  EXPECT_NE(got.error().note.find("2 of 4"), std::string::npos) << got.error().note;
  EXPECT_NE(got.error().note.find("consistent with itself, not tied to the room"), std::string::npos);
  EXPECT_EQ(tie_to_room(room.solved, room.survey, {}).error().rcode, RCode::kDatumsMissing);
  for (std::size_t i = 0; i < 3; ++i) {
    room.p_room[i] = room.T_room_rig.t + Eigen::Vector3d(static_cast<double>(i) - 1, 0.4, -3.5);
    room.survey.datums[i].position_m = {room.p_room[i].x(), room.p_room[i].y(), room.p_room[i].z()};
  }
  view = room.look(random);
  view.eyes[1].pop_back();
  got = tie_to_room(room.solved, room.survey, {view});
  ASSERT_FALSE(got);
  EXPECT_EQ(got.error().rcode, RCode::kDatumsMissing);
  EXPECT_NE(got.error().note.find("one line"), std::string::npos) << got.error().note;
}

TEST(Tie, lists_what_was_not_seen_and_what_nobody_surveyed) {
  std::mt19937_64 random(support::seed());
  DatumRoom room = datum_room(random, 6);
  View view = room.look(random);
  room.survey.datums.erase(room.survey.datums.begin());
  view.eyes[1].erase(view.eyes[1].begin() + 3);
  const auto got = tie_to_room(room.solved, room.survey, {view});
  ASSERT_TRUE(got) << got.error().message();
  EXPECT_EQ(got->not_seen, std::vector<std::string>{"datum 4"});
  EXPECT_EQ(got->not_surveyed, std::vector<unsigned>{datum_codes()[0]});
}

TEST(Tie, notices_a_rig_bumped_and_a_datum_kicked_half_way) {
  std::mt19937_64 random(support::seed());
  DatumRoom room = datum_room(random, 6);
  std::vector<View> views{room.look(random, "1"), room.look(random, "2"), room.look(random, "3")};
  DatumRoom bumped = room;
  bumped.T_room_rig.t.x() += 0.004;
  std::vector<View> half = views;
  half.push_back(bumped.look(random, "4"));
  auto got = tie_to_room(room.solved, room.survey, half);
  ASSERT_FALSE(got);
  EXPECT_EQ(got.error().rcode, RCode::kRigMoved);
  EXPECT_NE(got.error().note.find("look '4'"), std::string::npos) << got.error().note;
  DatumRoom kicked = room;
  kicked.p_room[3].y() += 0.01;
  views.push_back(kicked.look(random, "4"));
  got = tie_to_room(room.solved, room.survey, views);
  ASSERT_FALSE(got);
  EXPECT_EQ(got.error().rcode, RCode::kDatumMoved);
  EXPECT_TRUE(got.error().note.starts_with("'datum 4'")) << got.error().note;
}

TEST(Tie, refuses_cameras_places_and_surveys_that_are_none) {
  std::mt19937_64 random(support::seed());
  const DatumRoom room = datum_room(random, 4);
  const View view = room.look(random);
  model::Rig cameras = room.solved;
  cameras.devices.pop_back();
  EXPECT_EQ(tie_to_room(cameras, room.survey, {view}).error().rcode, RCode::kCameraCount);
  cameras = room.solved;
  cameras.covariance.resize(3, 3);
  EXPECT_EQ(tie_to_room(cameras, room.survey, {view}).error().rcode, RCode::kBadCalibrationFile);
  cameras.covariance = room.solved.covariance;
  cameras.covariance(0, 0) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(tie_to_room(cameras, room.survey, {view}).error().rcode, RCode::kNotFinite);
  View bad = view;
  bad.eyes[0][1].q.x() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(tie_to_room(room.solved, room.survey, {bad}).error().rcode, RCode::kNotFinite);
  proto::survey::Survey survey = room.survey;
  survey.datums[1].code = survey.datums[0].code;
  EXPECT_EQ(tie_to_room(room.solved, survey, {view}).error().rcode, RCode::kSurveyUnusable);
  cameras = room.solved;
  cameras.covariance.resize(0, 0);  // exact
  const Result<Measured> exact = measure(cameras, {view});
  ASSERT_TRUE(exact);
  EXPECT_EQ(exact->cov_cameras.cols(), 0);
}

// A datum of 0.1 m radius seen at 45 degrees: middles of ellipses and of discs are half a pixel apart.
TEST(Tie, knows_that_an_ellipse_is_not_centred_on_its_disc) {
  std::mt19937_64 random(support::seed());
  DatumRoom room = datum_room(random, 8);
  room.pixel_sigma = 0.005;
  for (std::size_t i = 0; i < 8; ++i) {
    room.survey.datums[i].radius_m = 0.1;
    room.survey.datums[i].normal = {i % 2 == 0 ? 0.7071067811865476 : -0.7071067811865476, 0, 0.7071067811865476};
    room.survey.datums[i].position_m = {room.p_room[i].x(), room.p_room[i].y(), room.p_room[i].z()};
    room.survey.datums[i].sigma_mm = 0.1;
  }
  room.true_rig = room.solved;
  room.solved.covariance *= 1e-6;
  const View view = room.look(random);
  const auto knowing = tie_to_room(room.solved, room.survey, {view});
  ASSERT_TRUE(knowing) << knowing.error().message();
  EXPECT_LT(knowing->whitened_rms, 1.5);
  for (auto& datum : room.survey.datums) {
    datum.normal = {0, 0, 1};
  }
  const auto ignorant = tie_to_room(room.solved, room.survey, {view});
  EXPECT_TRUE(!ignorant || ignorant->whitened_rms > 1.5);
}

TEST(SurveyFrom, gives_a_survey_that_the_rig_ties_itself_to) {
  std::mt19937_64 random(support::seed());
  for (int i = 0; i < 20; ++i) {
    const DatumRoom room = datum_room(random, 5);
    const auto survey = survey_from(room.solved, {room.look(random)});
    ASSERT_TRUE(survey) << survey.error().message();
    EXPECT_TRUE(survey->by_rig);
    EXPECT_NEAR(survey->datums[0].position_m[0], 0, 1e-9);
    EXPECT_NEAR(survey->datums[1].position_m[1], 0, 1e-9);
    EXPECT_NEAR(survey->datums[0].radius_m, 0.03, 0.001);
    for (std::size_t a = 0; a < 5; ++a) {
      for (std::size_t b = 0; b < a; ++b) {
        const auto& pa = survey->datums[a].position_m;
        const auto& pb = survey->datums[b].position_m;
        EXPECT_NEAR(std::hypot(pa[0] - pb[0], pa[1] - pb[1], pa[2] - pb[2]), (room.p_room[a] - room.p_room[b]).norm(),
                    5e-3 * std::hypot(survey->datums[a].sigma_mm, survey->datums[b].sigma_mm));
      }
    }
    const auto again = tie_to_room(room.solved, *survey, {room.look(random)});
    ASSERT_TRUE(again) << again.error().message();
    EXPECT_FALSE(again->scale);
    EXPECT_GT(again->T_room_rig.t.z(), 3);
  }
}

TEST(SurveyFrom, needs_three_datums) {
  std::mt19937_64 random(support::seed());
  const DatumRoom room = datum_room(random, 4);
  View view = room.look(random);
  view.eyes[0].resize(2);
  EXPECT_EQ(survey_from(room.solved, {view}).error().rcode, RCode::kDatumsMissing);
}

}  // namespace
}  // namespace raysteer::calib::datum
