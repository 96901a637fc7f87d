// Light that one eye saw counts where it meets the known plane, and a look of which too little does is left out.
#include "host/rig/known_plane.hpp"

#include <gtest/gtest.h>

#include <utility>
#include <vector>

#include "host/rig/thin_out.hpp"

namespace raysteer::host::rig {
namespace {

/// Two eyes that look along z, and looks that one of them saw: `ahead` points of each in its middle.
class OnKnownPlane : public testing::Test {
 protected:
  OnKnownPlane() {
    const calib::model::Camera lens{
        .width = 612, .height = 512, .fx = 350, .fy = 350, .cx = 305.5, .cy = 255.5, .k = {}};
    gathered.observations.cameras.devices = {{.name = "left", .camera = lens, .T_device_rig = {}},
                                             {.name = "right", .camera = lens, .T_device_rig = {}}};
    gathered.observations.cameras.devices[1].T_device_rig.t = {-0.5, 0, 0};
  }

  /// `high` more points are in the uppermost rows, where rays of the tilted plane below meet it at no useful angle.
  OneEyedLook add(const std::string& name, std::size_t ahead, std::size_t high) {
    OneEyedLook look{.index = gathered.observations.looks.size(), .seen = {}};
    for (std::size_t i = 0; i < ahead + high; ++i) {
      look.seen.x.emplace_back(10.0 * static_cast<double>(i), 0);
      look.seen.q.emplace_back(200 + 5 * static_cast<double>(i), i < ahead ? 400 : 10);
      look.seen.cov_q.push_back(4e-4 * Eigen::Matrix2d::Identity());
    }
    gathered.observations.looks.push_back({.name = name, .command_rad = {}, .feedback_rad = {}, .points = {}});
    return look;
  }

  /// 1 m below the eyes, along what they look at: what is above the horizon never meets it.
  static calib::steer::KnownPlane floor() {
    calib::steer::KnownPlane plane;
    plane.T_rig_plane.q = Eigen::AngleAxisd(1.5707963267948966, Eigen::Vector3d::UnitX());
    plane.T_rig_plane.t = {0, 1, 0};
    plane.covariance = 1e-8 * Eigen::Matrix<double, 6, 6>::Identity();
    return plane;
  }

  Gathered gathered;
};

TEST_F(OnKnownPlane, a_look_that_mostly_misses_it_is_left_out_and_the_others_keep_their_points) {
  std::vector<OneEyedLook> looks;
  looks.push_back(add("hit", 30, 10));
  looks.push_back(add("missed", 0, 30));
  add("both eyes", 0, 0);
  looks.push_back(add("barely missed", kFewestPoints - 1, 30));
  looks.push_back(add("barely hit", kFewestPoints, 30));
  put_on_plane(gathered, looks, floor());

  ASSERT_EQ(gathered.observations.looks.size(), 3U);
  EXPECT_EQ(gathered.observations.looks[0].name, "hit");
  EXPECT_EQ(gathered.observations.looks[0].points.size(), 30U);
  EXPECT_EQ(gathered.observations.looks[1].name, "both eyes");
  EXPECT_EQ(gathered.observations.looks[2].name, "barely hit");
  EXPECT_EQ(gathered.observations.looks[2].points.size(), kFewestPoints);
  EXPECT_EQ(gathered.one_eyed, (std::vector<std::string>{"hit", "barely hit"}));
  ASSERT_EQ(gathered.missed.size(), 2U);
  for (const MissedLook& missed : gathered.missed) {
    EXPECT_EQ(missed.error.rcode, RCode::kTooFewMatches) << missed.name;
  }
}

}  // namespace
}  // namespace raysteer::host::rig
